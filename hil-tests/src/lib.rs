//! What of Reflex runs on the host: replays, closed-loop flights, scores.
//!
//! Four crates below this one know nothing of the autopilot: [`emulated_board`] runs a
//! firmware's ELF on an emulated processor, [`chip_models`] are its sensors,
//! [`recorded_flights`] reads logs, and [`flight_dynamics`] simulates a drone. Here the
//! autopilot meets them:
//!
//! - [`replay`]: a recorded flight on the emulated board; [`scoring`] judges what happened
//! - [`campaign`]: hundreds of hours of closed-loop flights, compared and reported
//! - [`closed_loop`]: a simulated drone in wind instead of a recorded flight
//! - [`faults`]: what can break in a flight, by script
//! - `native`: the same flights without the emulator, a hundred times as fast
//! - [`scenarios`]: flights in which something breaks, and what is expected of them
//! - `flight_log`: flights written down, for Foxglove, PlotJuggler, PX4's tools
//! - [`costs`]: instructions, memory and locks of the firmware, against limits
//! - [`profile`]: where the instructions of a flight go, by part, function and task
//! - [`sweep`]: many of those over a grid of settings, drawn with [`plot`]
//! - [`tune`]: what other settings would change on somebody's own flights, and which of them pays
//! - [`fuzz`]: inputs that nobody meant, for all that reads
//! - [`picture`]: control logics drawn as graphs
//! - [`firmware`]: builds and measures the ELF, with the [`toolchain`] it needs
//! - [`ground_station`]: what is sent to a drone
//! - [`commands`]: the command line of `cargo hil`

pub mod campaign;
mod clock;
pub mod closed_loop;
pub mod commands;
pub mod costs;
pub mod faults;
pub mod firmware;
mod flight_log;
pub mod fuzz;
pub mod ground_station;
mod interval;
mod json;
pub mod logics;
mod magnetometer;
mod mountings;
mod native;
mod output_file;
mod page;
mod parallel;
pub mod picture;
pub mod plot;
pub mod profile;
pub mod progress;
mod record;
pub mod refusal;
pub mod replay;
pub mod scenarios;
pub mod scoring;
pub mod sweep;
pub mod toolchain;
pub mod tune;

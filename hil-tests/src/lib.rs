//! Everything of Reflex that runs on the host: emulated board, flights, scores.
//!
//! - [`board`]: the firmware's ELF on an emulated processor, behind a small interface
//! - [`chips`]: the sensors, written from their datasheets
//! - [`flights`]: recorded flights, as stimulus, setpoints and link frames
//! - [`replay`]: puts the three together; [`scoring`] judges what happened
//! - [`campaign`]: hundreds of hours of closed-loop flights, compared and reported
//! - [`closed_loop`]: a simulated drone in wind instead of a recorded flight
//! - [`native`]: the same flights without the emulator, a hundred times as fast
//! - [`costs`]: instructions, memory and locks of the firmware, against limits
//! - [`sweep`]: many of those over a grid of settings, drawn with [`plot`]
//! - [`picture`]: control logics drawn as graphs
//! - [`firmware`]: builds and measures the ELF, with the [`toolchain`] it needs
//! - [`commands`]: the command line of `cargo hil`

pub mod airframes;
pub mod board;
pub mod campaign;
pub mod chips;
mod clock;
pub mod closed_loop;
pub mod commands;
pub mod costs;
pub mod firmware;
pub mod flights;
pub mod logics;
pub mod native;
pub mod picture;
pub mod plot;
pub mod progress;
#[cfg(test)]
mod recordings;
pub mod refusal;
pub mod replay;
pub mod replay_options;
pub mod scoring;
#[cfg(test)]
mod statistics;
pub mod sweep;
pub mod toolchain;

//! Register-level models of the flight sensors, written from their datasheets.
//!
//! The firmware under test talks to these models byte by byte, through the
//! emulated buses, and must find in them what it would find in the chips: data
//! at the programmed rate with a free-running oscillator, quantisation and
//! clipping, filters, threshold generators, latches and status bits. They know
//! neither the emulator nor the drivers.
//!
//! **Time.** Virtual time comes in as nanoseconds and only moves forward.
//! A model is advanced lazily: every entry takes `now_ns` and first produces
//! all samples due until then. The samples depend on the seed, the signal and
//! the configuration alone, never on how often a chip is asked.
//! [`Chip::next_event`] names the next instant at which the interrupt pin can
//! change, so that a board can be there in time.
//!
//! **Terms.** *Stimulus*: the true motion and field at the chip, in the chip's
//! own axes ([`Stimulus`]). *Code*: what a register holds.

pub mod bus;
pub mod filter;
pub mod lsm303agr;
pub mod mpu6050;
pub mod noise;
pub mod options;
pub mod oscillator;
mod own_clock;
pub mod register_file;
mod shared;
pub mod stimulus;
pub mod testing;

pub use bus::{Chip, I2cChip, SpiChip};
pub use mpu6050::Mpu6050;
pub use options::{Axes, ChipOptions, Present, ZeroRate};
pub use own_clock::{Die, OwnClock};
pub use shared::SharedChips;
pub use stimulus::{Sensor, Stimulus, StimulusSource};

/// The dies with a clock of their own, in the order of the firmware's inputs: both tiers play them.
pub const DIES: [Die; 2] = [lsm303agr::ACCELEROMETER, lsm303agr::MAGNETOMETER];

/// A value for each die, in the order of [`DIES`].
pub type OfDies<T> = [T; DIES.len()];

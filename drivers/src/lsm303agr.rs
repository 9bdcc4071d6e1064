//! LSM303AGR: threshold interrupts of both halves, with read-back.
//!
//! The crate `lsm303agr` sets rates, modes and full scale; it never sets the bit that lets the
//! accelerometer answer on SPI, nor the magnetometer's temperature compensation, has no threshold, high-pass, latch or offset call, and hides its
//! registers. Use both in this order:
//!
//! 1. [`ThreeWire::enable`] around the accelerometer's `SpiDevice`,
//! 2. the crate's `new_with_spi(three_wire, magnetometer)` and its set-up calls, then `destroy()`,
//! 3. [`Accelerometer::new`] and [`Magnetometer::new`] on what `destroy()` returned.
//!
//! [`halves`] does all of that for an owner of both halves: set-up, routing of the pins, fetches,
//! re-arming, heartbeats, and set-up anew of what was lost.
//!
//! Register names and bits follow ST's `lsm303agr-pid` (`lsm303agr_reg.h`), LSBs its comments and
//! the datasheet DocID027765.
//!
//! A silent limit of the chip: its high-pass filter forgets. A change slower than the corner never
//! reaches the threshold and needs the failsafe run.

mod accelerometer;
mod codes;
mod full_scale;
pub mod halves;
mod magnetometer;
mod port;
mod sample;
mod setup;
mod three_wire;

pub use crate::registers::lsm303agr as register;
pub use accelerometer::Accelerometer;
pub use codes::{AccelThreshold, MagThreshold, ThresholdDuration};
pub use full_scale::AccelFullScale;
pub use magnetometer::Magnetometer;
pub use sample::{AccelCounts, MAG_STEP, MagCounts, MagOffset, Status};
pub use setup::{
    AccelDataRate, AccelInterrupt, AccelMode, AccelOutput, AccelPin, Axes, HighPass,
    HighPassCorner, HighPassMode, MagCompare, MagInterrupt, MagPin,
};
pub use three_wire::ThreeWire;

/// WHO_AM_I_A of the accelerometer.
pub const ACCELEROMETER_IDENTITY: u8 = 0x33;
/// WHO_AM_I_M of the magnetometer.
pub const MAGNETOMETER_IDENTITY: u8 = 0x40;

//! The LSM303AGR accelerometer and magnetometer on SPI.
//!
//! The package holds two dies that share nothing but pins: each has its own
//! chip select, oscillator, registers and interrupt pin. They are modelled
//! apart: [`Accelerometer`], [`Magnetometer`].
//!
//! Sources: ST's datasheet DocID027765 and application note AN4825, and the
//! register descriptions that ST publishes with its driver. See `spi` for what
//! three-wire SPI means on this board.

mod accelerometer;
mod accelerometer_registers;
mod accelerometer_sampling;
mod generator;
mod magnetometer;
mod magnetometer_registers;
mod magnetometer_threshold;
mod output;
mod spi;
#[cfg(test)]
mod tests;

pub use accelerometer::Accelerometer;
pub use magnetometer::Magnetometer;

use super::own_clock::Die;

/// The accelerometer, as both tiers play it.
pub const ACCELEROMETER: Die = Die {
    name: "lsm303agr_accel",
    is_present: |present| present.accelerometer,
    model: |source, options| Box::new(Accelerometer::new(source, options)),
};

/// The magnetometer, as both tiers play it.
pub const MAGNETOMETER: Die = Die {
    name: "lsm303agr_mag",
    is_present: |present| present.magnetometer,
    model: |source, options| Box::new(Magnetometer::new(source, options)),
};

//! The LSM303AGR accelerometer and magnetometer on SPI.
//!
//! The package holds two dies that share nothing but pins: each has its own
//! chip select, oscillator, registers and interrupt pin. They are modelled
//! apart ([`Accelerometer`], [`Magnetometer`]) and joined here.
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

use std::sync::Arc;

pub use accelerometer::Accelerometer;
pub use magnetometer::Magnetometer;

use super::bus::SpiChip;
use super::options::ChipOptions;
use super::own_clock::{Die, OwnClock};
use super::stimulus::StimulusSource;

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

/// One LSM303AGR: two SPI chips in a package.
pub struct Lsm303agr {
    /// The accelerometer die: chip select CS_XL, interrupt pin INT_1_XL.
    pub accel: Accelerometer,
    /// The magnetometer die: chip select CS_MAG, interrupt pin INT_MAG.
    pub mag: Magnetometer,
}

impl Lsm303agr {
    /// A chip just powered: both dies idle, until they are configured.
    pub fn new(source: Arc<dyn StimulusSource>, options: ChipOptions) -> Self {
        Self {
            accel: Accelerometer::new(Arc::clone(&source), options),
            mag: Magnetometer::new(source, options),
        }
    }

    /// Produces every sample and pin change of both dies due until `now_ns`.
    pub fn advance(&mut self, now_ns: u64) {
        self.accel.advance(now_ns);
        self.mag.advance(now_ns);
    }

    /// The next instant at which an interrupt pin can change, in ns.
    pub fn next_event(&self) -> u64 {
        self.accel.next_event().min(self.mag.next_event())
    }

    /// A supply dip at `now_ns`: both dies fall back to their reset values.
    pub fn brown_out(&mut self, now_ns: u64) {
        self.accel.brown_out(now_ns);
        self.mag.brown_out(now_ns);
    }
}

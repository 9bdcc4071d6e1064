//! What the sensors deliver: inputs, and samples in SI units.
//!
//! Counts and their scales are the drivers' own: nothing here knows a chip.

use crate::math::Vec3;
use crate::time::Instant;
use crate::units::{BodyRates, SpecificForce};

use reflex_drivers::orders::Sample;

pub use reflex_drivers::orders::Cause;
pub use reflex_settings::{Input, Inputs, Source, Unit};

/// Standard gravity in m/s2.
pub const GRAVITY: f32 = 9.806_65;

/// A sample of a chip with a clock of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipSample {
    /// Which input it is of.
    pub input: Input,
    /// Three axes of the body, in the unit of the input.
    pub axes: Vec3,
    /// Why it was fetched.
    pub cause: Cause,
}

impl ChipSample {
    /// An input's sample, as the chip's driver read it.
    #[must_use]
    pub fn of(input: Input, Sample { axes, cause }: Sample) -> Self {
        let axes = Vec3::from_array(axes);
        Self { input, axes, cause }
    }
}

/// What the inertial sensor measured at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImuReading {
    /// Angular rates, bias not removed.
    pub rates: BodyRates,
    /// Specific force.
    pub force: SpecificForce,
    /// Temperature of the die in degrees Celsius: its noise also shows that the sensor is alive.
    pub temperature: f32,
}

/// Rates and force as they are filtered and summed, with the stamp of their interrupt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuSample {
    /// When the data-ready interrupt arrived.
    pub at: Instant,
    /// Angular rates.
    pub rates: BodyRates,
    /// Specific force.
    pub force: SpecificForce,
}

//! What the sensors deliver: inputs, and samples in SI units.
//!
//! Counts and their scales are the drivers' own: nothing here knows a chip.

use crate::math::Vec3;
use crate::time::Instant;
use crate::units::{BodyRates, SpecificForce};

pub use reflex_settings::{Input, Inputs, Source, Unit};

/// Standard gravity in m/s2.
pub const GRAVITY: f32 = 9.806_65;

/// Why a sample of a chip that compares was fetched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[repr(u8)]
pub enum Cause {
    /// Its data-ready interrupt: every sample arrives.
    DataReady = 0,
    /// Its threshold interrupt: the chip compared, the change was past the threshold.
    Threshold = 1,
    /// A heartbeat read at the failsafe rate, independent of its interrupts.
    Heartbeat = 2,
    /// The chip's reference was set to this very sample.
    Rearm = 3,
}

impl Cause {
    /// The cause of a number, `None` past the last.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        [
            Self::DataReady,
            Self::Threshold,
            Self::Heartbeat,
            Self::Rearm,
        ]
        .get(usize::from(number))
        .copied()
    }
}

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

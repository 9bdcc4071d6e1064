//! What a user configured, as constants: `config/*.toml`, checked by the build.
//!
//! The target parses nothing. `build.rs` reads and checks the files, and stops the build with
//! one line that names file, line, key and range. On the host `describe` shows what holds.

use crate::sensors::{Input, Inputs};
use crate::settings::{
    Feedback, Limits, MotorProtocol, Mounting, Pairs, Policy, Reference, Settings, WarmUp,
};
use crate::time::{Duration, micros};
use reflex_settings::{Airframe, Motor};

/// What one input may ask for, from `config/reactive.toml`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct SensorInput {
    /// Nominal time between samples.
    pub period: Duration,
    /// Its period enters the hyperperiod, which waits for its sample.
    pub gates: bool,
    /// The changes that are told apart.
    pub changes: Changes,
}

/// Ends of the bins in which an input's changes are counted, in its own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Changes {
    /// Lower end.
    pub smallest: f32,
    /// Upper end.
    pub largest: f32,
}

impl Changes {
    /// The same changes in another unit.
    #[must_use]
    pub const fn times(self, factor: f32) -> Self {
        Self {
            smallest: self.smallest * factor,
            largest: self.largest * factor,
        }
    }
}

include!(concat!(env!("OUT_DIR"), "/config.rs"));

/// What limits settings beyond their ranges.
pub const LIMITS: Limits = Limits {
    hyperperiod: HYPERPERIOD,
    longest_warm_up: LONGEST_WARM_UP,
    imu_rate_hz: IMU_RATE,
};

/// The configuration that was built in, one constant and its meaning per line.
#[cfg(not(target_os = "none"))]
#[must_use]
pub fn describe() -> impl core::fmt::Display {
    Description
}

#[cfg(not(target_os = "none"))]
struct Description;

#[cfg(not(target_os = "none"))]
impl core::fmt::Display for Description {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for [name, value, meaning] in ENTRIES {
            writeln!(f, "{name} = {value}\n    {meaning}")?;
        }
        Ok(())
    }
}

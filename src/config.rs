//! What a user configured, as constants: `config/*.toml`, checked by the build.
//!
//! The target parses nothing. `build.rs` reads and checks the files, and stops the build with
//! one line that names file, line, key and range. On the host `describe` shows what holds.

use crate::settings::{MotorProtocol, Policy, Reference, Settings, WarmUp};
use crate::time::{Duration, micros};

/// What one sensor may ask for, from `config/reactive.toml`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct SensorInput {
    /// Nominal time between samples.
    pub period: Duration,
    /// Its period enters the hyperperiod, which waits for its sample.
    pub gates: bool,
    /// Its model may ask for a run.
    pub triggers: bool,
    /// Lower end of the bins in which its changes are counted, in its own unit.
    pub smallest_change: f32,
    /// Upper end of the bins in which its changes are counted, in its own unit.
    pub largest_change: f32,
}

include!(concat!(env!("OUT_DIR"), "/config.rs"));

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

//! Options for the unmodified firmware: a checksummed block of bytes.
//!
//! A replay (or a bootloader) writes the block to the symbol `REFLEX_SETTINGS` in memory that
//! start-up leaves alone. Absent or wrong in any way, the defaults built from `config/` hold,
//! so that a board that was just powered behaves as configured.

use crate::config;
use crate::sensors::{Input, Inputs};
use crate::time::{Duration, micros};

mod block;

pub use block::{BLOCK_LENGTH, BlockError};
pub use reflex_settings::gains;
pub use reflex_settings::{Feedback, MotorProtocol, Pairs, Policy, Reference, WarmUp};

/// Everything a replay may choose without a rebuild.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Settings {
    /// When control runs.
    pub policy: Policy,
    /// What a change is measured against.
    pub reference: Reference,
    /// Probability of a changed command above which a change calls for a run, within (0, 1).
    pub p_run: f32,
    /// How long control runs time-triggered to learn.
    pub warm_up: WarmUp,
    /// Time between runs while learning; at every hyperperiod where it is not longer than one.
    pub warm_up_period: Duration,
    /// The longest time between runs, longer than a hyperperiod, at most 1 s.
    pub failsafe: Duration,
    /// The change of a motor command that counts, as a share of full scale within (0, 0.5].
    pub quantum: f32,
    /// How a motor command becomes a pulse.
    pub motors: MotorProtocol,
    /// Inputs whose models may ask for a run.
    pub triggers: Inputs,
    /// Which pairs become labels in the warm-up.
    pub pairs: Pairs,
    /// Which runs become labels in reactive control.
    pub feedback: Feedback,
    /// Seed of the exploration runs.
    pub seed: u32,
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum SettingsError {
    /// `p_run` is not within (0, 1).
    PRun,
    /// `failsafe` is not longer than two hyperperiods, or longer than 1 s.
    Failsafe,
    /// `quantum` is not within (0, 0.5].
    Quantum,
    /// A periodic policy's period is shorter than a hyperperiod or longer than 1 s.
    Period,
    /// A fixed warm-up is longer than `T_boot`.
    WarmUp,
    /// Runs while learning are no time apart, or longer than 0.1 s.
    WarmUpPeriod,
    /// Neither the gyroscope nor what is derived from it may trigger.
    Triggers,
}

impl core::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let seconds = |span: Duration| span.ticks() as f64 / 1e6;
        match self {
            Self::PRun => f.write_str("p_run must lie between 0 and 1, both excluded"),
            Self::Failsafe => write!(
                f,
                "failsafe must be longer than two hyperperiods ({} s) and at most 1 s",
                seconds(config::HYPERPERIOD * 2)
            ),
            Self::Quantum => f.write_str("quantum must be above 0 and at most half of full scale"),
            Self::Period => write!(
                f,
                "the periodic rate must lie between 1 Hz and {} Hz",
                1.0 / seconds(config::HYPERPERIOD)
            ),
            Self::WarmUp => write!(
                f,
                "a fixed warm-up must not be longer than {} s",
                seconds(config::LONGEST_WARM_UP)
            ),
            Self::WarmUpPeriod => f.write_str("the rate while learning must be 10 Hz or more"),
            Self::Triggers => f.write_str("at least one of gyro, turned and command must trigger"),
        }
    }
}

impl core::error::Error for SettingsError {}

impl Default for Settings {
    fn default() -> Self {
        config::SETTINGS
    }
}

/// The longest interval that the failsafe and a period may have.
const SLOWEST: Duration = micros(1_000_000);

/// The longest time between runs while learning: there is little to learn from fewer.
const SLOWEST_WARM_UP: Duration = micros(100_000);

impl Settings {
    /// Checks every range.
    ///
    /// # Errors
    /// The first field that is out of its range, in the order of the fields.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let shortest = config::HYPERPERIOD;
        if let Policy::Periodic(period) = self.policy
            && !(shortest..=SLOWEST).contains(&period)
        {
            return Err(SettingsError::Period);
        }
        if !(self.p_run > 0.0 && self.p_run < 1.0) {
            return Err(SettingsError::PRun);
        }
        if let WarmUp::Fixed(length) = self.warm_up
            && length > config::LONGEST_WARM_UP
        {
            return Err(SettingsError::WarmUp);
        }
        if self.warm_up_period == micros(0) || self.warm_up_period > SLOWEST_WARM_UP {
            return Err(SettingsError::WarmUpPeriod);
        }
        if self.failsafe <= shortest * 2 || self.failsafe > SLOWEST {
            return Err(SettingsError::Failsafe);
        }
        if !(self.quantum > 0.0 && self.quantum <= 0.5) {
            return Err(SettingsError::Quantum);
        }
        let seen_at_every_sample = [Input::Gyro, Input::Turned, Input::Command];
        if !seen_at_every_sample
            .iter()
            .any(|input| self.triggers.contains(*input))
        {
            return Err(SettingsError::Triggers);
        }
        Ok(())
    }
}

//! What the scores depend on besides the flight itself.

use super::flight::Command;
use reflex::config::GEOMETRY;
use std::ops::RangeInclusive;

/// A flight with more saturated hyperperiods than this share is not scored.
pub const MOST_SATURATED: f64 = 0.2;

/// The constants of one scoring.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// The change of a motor command that counts, as a share of full scale, above 0.
    pub quantum: f32,
    /// The longest time between runs, in microseconds.
    pub failsafe_us: u64,
    /// Limits of an armed motor's command: one at or beyond either end is saturated, and so
    /// is a disarmed one.
    pub limits: RangeInclusive<f32>,
    /// Rates that the periodic policy accepts, in hertz.
    pub periodic_hz: RangeInclusive<f64>,
}

impl Default for Rules {
    /// One step of an 8-bit ESC, 0.1 s, from the armed motors' minimum to full, 1 to 1000 Hz.
    fn default() -> Self {
        Self {
            quantum: 1.0 / 255.0,
            failsafe_us: 100_000,
            limits: GEOMETRY.armed_minimum()..=1.0,
            periodic_hz: 1.0..=1000.0,
        }
    }
}

impl Rules {
    /// Whether some motor's command sits at a limit.
    #[must_use]
    pub fn saturates(&self, command: &Command) -> bool {
        command
            .iter()
            .any(|share| share <= self.limits.start() || share >= self.limits.end())
    }
}

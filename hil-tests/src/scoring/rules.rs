//! What the scores depend on besides the flight itself.

use super::flight_steps::Command;
use super::load::Cost;
use reflex::airframe::{Axes, Mixer};
use reflex::config::{GEOMETRY, SETTINGS};
use reflex::reactive::axes_of;
use reflex::time::seconds;
use std::ops::RangeInclusive;

/// A flight with more saturated hyperperiods than this share is not scored.
pub const MOST_SATURATED: f64 = 0.2;

/// The constants of one scoring.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// A run is judged by what it repays, where that is known, and not by what it moves.
    pub repays: bool,
    /// The change of a motor command that counts, as a share of full scale, above 0.
    pub quantum: f32,
    /// The longest time between runs, in microseconds.
    pub failsafe_us: u64,
    /// Limits of an armed motor's command: one at or beyond either end is saturated, and so
    /// is a disarmed one.
    pub limits: RangeInclusive<f32>,
    /// Rates that the periodic policy accepts, in hertz.
    pub periodic_hz: RangeInclusive<f64>,
    /// The axes about which a held command owes an impulse.
    pub axes: Axes,
    /// How long, in s, a quantum may be owed before a run is due.
    pub budget_s: f32,
    /// What control takes of the processor; `None` where nobody measured it.
    pub load: Option<LoadRules>,
}

/// What is known of the processor's load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadRules {
    /// Instructions in a second.
    pub core_hz: f64,
    /// What the policy takes.
    pub policy: Cost,
    /// What periodic control takes.
    pub periodic: Cost,
    /// Instructions that the policy spent on commands that it foresaw exactly.
    pub foresight: f64,
    /// Share of time in which the processor was busy; `None` where there was none.
    pub busy: Option<f64>,
}

impl Default for Rules {
    /// One step of an 8-bit ESC, 0.1 s, from the armed motors' minimum to full, 1 to 1000 Hz.
    fn default() -> Self {
        Self {
            repays: false,
            quantum: 1.0 / 255.0,
            failsafe_us: 100_000,
            limits: GEOMETRY.armed_minimum()..=1.0,
            periodic_hz: 1.0..=1000.0,
            axes: axes_of(&Mixer::default()),
            budget_s: seconds(SETTINGS.budget),
            load: None,
        }
    }
}

impl Rules {
    /// The impulse that calls for a run, in weighted shares of full scale times seconds.
    #[must_use]
    pub fn budget(&self) -> f32 {
        self.quantum * self.budget_s
    }

    /// Whether some motor's command sits at a limit.
    #[must_use]
    pub fn saturates(&self, command: &Command) -> bool {
        command
            .iter()
            .any(|share| share <= self.limits.start() || share >= self.limits.end())
    }
}

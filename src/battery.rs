//! The battery: smoothed voltage and current, and what they mean.
//!
//! A state is left upward only past a margin: a battery that recovers as thrust ends is as empty as
//! before. What reads less than any battery has is none, so that a board on a bench flies no
//! failsafe, and a wire that breaks in the air ends no flight.

use crate::config::{
    BATTERY_CRITICAL_V, BATTERY_LEAST_V, BATTERY_LOW_V, BATTERY_MARGIN_V, BATTERY_SMOOTHING,
};
use crate::time::{Instant, seconds, span};

/// What was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct BatteryReading {
    /// Voltage, V.
    pub volts: f32,
    /// Current, A; 0 where none is measured.
    pub amps: f32,
}

impl BatteryReading {
    /// True where nothing is infinite or not a number.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.volts.is_finite() && self.amps.is_finite()
    }
}

/// How full it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum BatteryState {
    /// None is measured.
    #[default]
    Unmeasured,
    /// It can fly on.
    Good,
    /// Time to land.
    Low,
    /// Nearly empty.
    Critical,
}

/// The battery as it was measured so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Battery {
    state: BatteryState,
    smoothed: BatteryReading,
    measured: Option<Instant>,
}

impl Battery {
    /// How full it is.
    #[must_use]
    pub fn state(&self) -> BatteryState {
        self.state
    }

    /// Voltage and current, smoothed.
    #[must_use]
    pub fn smoothed(&self) -> BatteryReading {
        self.smoothed
    }

    /// Takes a measurement of finite volts and amps; the new state where it differs.
    pub fn take(&mut self, at: Instant, volts: f32, amps: f32) -> Option<BatteryState> {
        let reading = BatteryReading { volts, amps };
        self.smoothed = match self.measured {
            // A battery that was just connected is as full as it seems.
            Some(before) if self.state != BatteryState::Unmeasured => {
                let gone = 1.0 - libm::expf(-seconds(span(before, at)) / SMOOTHING_S);
                let toward = |old: f32, new: f32| old + gone * (new - old);
                BatteryReading {
                    volts: toward(self.smoothed.volts, volts),
                    amps: toward(self.smoothed.amps, amps),
                }
            }
            _ => reading,
        };
        self.measured = Some(at);
        let state = self.found();
        let differs = state != self.state;
        self.state = state;
        differs.then_some(state)
    }

    fn found(&self) -> BatteryState {
        let volts = self.smoothed.volts;
        // What was left must be passed by a margin to be reached again.
        let below = |state: BatteryState, limit: f32| {
            let margin = if self.state >= state {
                BATTERY_MARGIN_V
            } else {
                0.0
            };
            volts < limit + margin
        };
        if volts < BATTERY_LEAST_V {
            BatteryState::Unmeasured
        } else if below(BatteryState::Critical, BATTERY_CRITICAL_V) {
            BatteryState::Critical
        } else if below(BatteryState::Low, BATTERY_LOW_V) {
            BatteryState::Low
        } else {
            BatteryState::Good
        }
    }
}

const SMOOTHING_S: f32 = seconds_of(BATTERY_SMOOTHING.ticks());

const fn seconds_of(micros: u64) -> f32 {
    micros as f32 * 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    /// The states of a battery that holds each voltage for a minute.
    fn states(volts: &[f32]) -> Vec<BatteryState> {
        let mut battery = Battery::default();
        let held = volts.iter().zip((0..).step_by(60)).map(|(volts, from)| {
            for second in from..from + 60 {
                battery.take(at_micros(second * 1_000_000), *volts, 5.0);
            }
            battery.state()
        });
        held.collect()
    }

    #[test]
    fn a_state_is_left_upward_past_a_margin_only() {
        use BatteryState::{Critical, Good, Low, Unmeasured};
        let (low, critical) = (BATTERY_LOW_V, BATTERY_CRITICAL_V);
        let (past, short) = (BATTERY_MARGIN_V + 0.01, BATTERY_MARGIN_V - 0.01);
        let table = [
            (0.0, Unmeasured),
            (low + 0.01, Good),
            (low - 0.01, Low),
            (low + short, Low),
            (low + past, Good),
            (critical - 0.01, Critical),
            (critical + short, Critical),
            (critical + past, Low),
            (BATTERY_LEAST_V - 0.01, Unmeasured),
            (critical - 0.01, Critical),
        ];
        assert_eq!(
            states(&table.map(|(volts, _)| volts)),
            table.map(|(_, state)| state)
        );
    }

    #[test]
    fn a_short_sag_is_smoothed_and_a_long_one_is_told_once() {
        let mut battery = Battery::default();
        let mut told = Vec::new();
        let mut hold = |from_ms: u64, to_ms: u64, volts: f32| {
            for ms in (from_ms..to_ms).step_by(100) {
                told.extend(battery.take(at_micros(ms * 1_000), volts, 0.0));
            }
        };
        hold(0, 1_000, BATTERY_LOW_V + 1.0);
        hold(1_000, 1_200, BATTERY_LOW_V - 1.0);
        hold(1_200, 20_000, BATTERY_LOW_V + 1.0);
        hold(20_000, 60_000, BATTERY_LOW_V - 0.1);
        assert_eq!(told, [BatteryState::Good, BatteryState::Low]);
    }
}

//! The battery: smoothed voltage and current, and what they mean.
//!
//! Limits are those of a cell. How many there are is set, or counted as the battery is connected: as few
//! as have no more than a full one.
//! A state is left upward only past a margin: a battery that recovers as thrust ends is as empty as
//! before. What reads less than any battery has is none, so that a board on a bench flies no
//! failsafe, and a wire that breaks in the air ends no flight.

use crate::config::{
    BATTERY_AMPS_PER_VOLT, BATTERY_CELLS, BATTERY_CRITICAL_V, BATTERY_FULL_V, BATTERY_LEAST_V,
    BATTERY_LOW_V, BATTERY_MARGIN_V, BATTERY_SMOOTHING, BATTERY_VOLTS_PER_VOLT,
};
use crate::time::{Instant, seconds, span};

/// Volts of a step of the converter: 12 bits of the supply.
const STEP_V: f32 = 3.3 / 4095.0;

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
    /// What steps of the converter say: of the voltage's divider, and of the current's shunt.
    #[must_use]
    pub fn of_steps(steps: [u16; 2]) -> Self {
        let [volts, amps] = steps.map(|steps| f32::from(steps) * STEP_V);
        Self {
            volts: volts * BATTERY_VOLTS_PER_VOLT,
            amps: amps * BATTERY_AMPS_PER_VOLT,
        }
    }

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
    cells: u8,
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
            _ => {
                self.cells = cells_of(volts);
                reading
            }
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
            volts < (limit + margin) * f32::from(self.cells)
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

/// Cells of a battery that was just connected.
fn cells_of(volts: f32) -> u8 {
    match BATTERY_CELLS {
        0 => (volts / BATTERY_FULL_V) as u8 + 1,
        cells => cells as u8,
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

    const CELLS: f32 = 3.0;
    const LOW_V: f32 = CELLS * BATTERY_LOW_V;
    const CRITICAL_V: f32 = CELLS * BATTERY_CRITICAL_V;
    const MARGIN_V: f32 = CELLS * BATTERY_MARGIN_V;

    #[test]
    fn cells_are_counted_as_a_battery_is_connected_and_limits_are_theirs() {
        // The fullest and the emptiest that is told from one with a cell less or more.
        for (cells, volts) in [
            (2, 8.6),
            (3, 9.0),
            (3, 12.9),
            (4, 13.1),
            (4, 17.2),
            (6, 25.2),
        ] {
            let mut battery = Battery::default();
            battery.take(at_micros(0), volts - 0.01, 0.0);
            let mut held = |minute: u64, cell_v: f32| {
                battery.take(at_micros(minute * 60_000_000), cell_v * cells as f32, 0.0);
                battery.state()
            };
            let states = [
                held(1, BATTERY_CRITICAL_V - 0.01),
                held(2, BATTERY_LOW_V - 0.01),
                held(3, BATTERY_LOW_V + BATTERY_MARGIN_V + 0.01),
            ];
            use BatteryState::{Critical, Good, Low};
            assert_eq!(states, [Critical, Low, Good], "{cells} cells, {volts} V");
        }
    }

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
        let (low, critical) = (LOW_V, CRITICAL_V);
        let (past, short) = (MARGIN_V + 0.01, MARGIN_V - 0.01);
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
        hold(0, 1_000, LOW_V + 1.0);
        hold(1_000, 1_200, LOW_V - 1.0);
        hold(1_200, 20_000, LOW_V + 1.0);
        hold(20_000, 60_000, LOW_V - 0.1);
        assert_eq!(told, [BatteryState::Good, BatteryState::Low]);
    }
}

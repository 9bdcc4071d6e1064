//! The battery: smoothed voltage and current, and what they mean.
//!
//! Limits are those of a cell. How many there are is set, or counted as the battery is connected: as few
//! as have no more than a full one.
//! A state is left upward only past a margin: a battery that recovers as thrust ends is as empty as
//! before. What reads less than any battery has is none, so that a board on a bench flies no
//! failsafe, and a wire that breaks in the air ends no flight.
//! Smoothing keeps a gust from being called an empty battery. A voltage that no thrust explains is told
//! sooner: a few readings in a row are enough.

use crate::config::{
    BATTERY_AMPS_PER_VOLT, BATTERY_CELLS, BATTERY_COLLAPSED_V, BATTERY_CRITICAL_V, BATTERY_FULL_V,
    BATTERY_LEAST_V, BATTERY_LOW_V, BATTERY_MARGIN_V, BATTERY_SMOOTHING, BATTERY_VOLTS_PER_VOLT,
};
use crate::math::min;
use crate::time::{Duration, Instant, micros, seconds, span};

/// Between two measurements.
pub const LOOK: Duration = micros(100_000);
/// So many in a row below a limit are no spike of the converter.
const LOOKS: u8 = 2;
/// So many below the limit of a low battery are no gust.
const LOOKS_LOW: u8 = 10;

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
    /// Readings in a row that are too low for any load, and for any battery.
    collapsed: u8,
    missing: u8,
    /// Readings in a row of a low battery.
    low: u8,
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

    /// True at the measurement that shows that the voltage collapsed.
    #[must_use]
    pub fn collapses(&self) -> bool {
        self.collapsed == LOOKS
    }

    /// Takes a measurement of finite volts and amps; the new state where it differs. Cells are counted
    /// while the drone stands: one that comes back under load looks like fewer.
    pub fn take(
        &mut self,
        at: Instant,
        reading: &BatteryReading,
        stands: bool,
    ) -> Option<BatteryState> {
        let since = self.measured.replace(at).map(|before| span(before, at));
        self.missing = counted(self.missing, reading.volts < BATTERY_LEAST_V);
        let is_known = self.state != BatteryState::Unmeasured;
        match since.filter(|_| is_known) {
            // A wire that breaks is no empty battery.
            Some(_) if (1..LOOKS).contains(&self.missing) => {}
            Some(since) if self.missing == 0 => self.smooth(reading, since),
            // A battery that was just connected is as full as it seems.
            _ => {
                if stands || self.cells == 0 {
                    self.cells = cells_of(reading.volts);
                }
                self.smoothed = *reading;
            }
        }
        self.heed_low(reading.volts);
        self.count_collapsed(reading.volts, is_known);
        let state = self.found();
        let differs = state != self.state;
        self.state = state;
        differs.then_some(state)
    }

    fn smooth(&mut self, reading: &BatteryReading, since: Duration) {
        let gone = 1.0 - libm::expf(-seconds(since) / SMOOTHING_S);
        let toward = |old: f32, new: f32| old + gone * (new - old);
        self.smoothed = BatteryReading {
            volts: toward(self.smoothed.volts, reading.volts),
            amps: toward(self.smoothed.amps, reading.amps),
        };
    }

    /// What lasted is low, however full the battery was before: a step takes long to be smoothed.
    fn heed_low(&mut self, volts: f32) {
        let limit = BATTERY_LOW_V * f32::from(self.cells);
        self.low = counted(self.low, (BATTERY_LEAST_V..limit).contains(&volts));
        if self.low >= LOOKS_LOW {
            self.smoothed.volts = min(self.smoothed.volts, limit - STEP_V);
        }
    }

    /// A collapse that was told lasts until the voltage is back by the margin.
    fn count_collapsed(&mut self, volts: f32, is_known: bool) {
        let told = self.collapsed >= LOOKS;
        let margin = if told { BATTERY_MARGIN_V } else { 0.0 };
        let below = volts < (BATTERY_COLLAPSED_V + margin) * f32::from(self.cells);
        self.collapsed = match below {
            true if told => LOOKS + 1,
            true if is_known => self.collapsed + 1,
            _ => 0,
        };
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

/// How many readings in a row something has held.
fn counted(readings: u8, holds: bool) -> u8 {
    if holds { readings.saturating_add(1) } else { 0 }
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
            battery.take(at_micros(0), &reading(volts - 0.01), true);
            let mut held = |minute: u64, cell_v: f32| {
                let reading = reading(cell_v * cells as f32);
                battery.take(at_micros(minute * 60_000_000), &reading, true);
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

    fn reading(volts: f32) -> BatteryReading {
        BatteryReading { volts, amps: 5.0 }
    }

    /// The states of a battery that holds each voltage for a minute.
    fn states(volts: &[f32]) -> Vec<BatteryState> {
        let mut battery = Battery::default();
        let held = volts.iter().zip((0..).step_by(60)).map(|(volts, from)| {
            for second in from..from + 60 {
                battery.take(at_micros(second * 1_000_000), &reading(*volts), true);
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
                told.extend(battery.take(at_micros(ms * 1_000), &reading(volts), false));
            }
        };
        hold(0, 1_000, LOW_V + 1.0);
        hold(1_000, 1_200, LOW_V - 1.0);
        hold(1_200, 20_000, LOW_V + 1.0);
        hold(20_000, 60_000, LOW_V - 0.1);
        assert_eq!(told, [BatteryState::Good, BatteryState::Low]);
    }

    /// Volts of all cells, one by one at each look; when a collapse is told, in ms, and the last state.
    fn flown(volts: impl IntoIterator<Item = f32>) -> (Vec<u64>, BatteryState) {
        let mut battery = Battery::default();
        let mut told = Vec::new();
        for (look, volts) in (0..).zip(volts) {
            let at = at_micros(look * LOOK.ticks());
            battery.take(at, &reading(volts), look == 0);
            if battery.collapses() {
                told.push(look * LOOK.ticks() / 1_000);
            }
        }
        (told, battery.state())
    }

    fn then(looks: usize, volts: f32) -> impl Iterator<Item = f32> {
        std::iter::repeat_n(volts, looks)
    }

    const COLLAPSED_V: f32 = CELLS * BATTERY_COLLAPSED_V - 0.1;

    #[test]
    fn a_collapse_is_told_at_once_and_again_only_where_the_voltage_was_back() {
        let low = [12.0, COLLAPSED_V, COLLAPSED_V];
        let hovers_at_limit = then(9, COLLAPSED_V + 0.15).chain(then(9, COLLAPSED_V));
        let back = then(9, 12.0).chain(then(9, COLLAPSED_V));
        let (told, _) = flown(low.into_iter().chain(hovers_at_limit).chain(back));
        assert_eq!(told, [200, 3_100]);
    }

    #[test]
    fn one_spike_of_the_converter_is_no_collapse_and_no_battery_that_is_gone() {
        for spike in [0.0, COLLAPSED_V] {
            let volts = [12.0, spike, 12.0, 12.0, spike, 12.0];
            assert_eq!(flown(volts), (vec![], BatteryState::Good), "{spike} V");
        }
    }

    #[test]
    fn full_thrust_of_a_battery_above_the_limits_is_no_collapse() {
        // A battery with a fifth of its charge that is worn: 50 mohm, 36 A.
        let gusts = (0..300).map(|look| 11.2 - 0.05 * if look % 30 < 10 { 12.0 } else { 36.0 });
        let (told, _) = flown(gusts);
        assert_eq!(told, [] as [u64; 0]);
    }

    #[test]
    fn what_lasts_for_a_second_is_low_and_what_is_shorter_is_a_gust() {
        for (looks, state) in [(9, BatteryState::Good), (10, BatteryState::Low)] {
            let sag = then(looks, LOW_V - 0.1);
            assert_eq!(flown([12.0].into_iter().chain(sag)).1, state, "{looks}");
        }
    }

    #[test]
    fn a_wire_that_breaks_is_told_and_is_no_empty_battery() {
        let broken = flown(then(5, 12.0).chain(then(9, 0.0)));
        assert_eq!(broken, (vec![600], BatteryState::Unmeasured));
    }

    #[test]
    fn a_battery_that_comes_back_in_the_air_has_the_cells_that_it_had() {
        // Under load it looks like two full cells.
        let (_, state) = flown(then(5, 12.0).chain(then(5, 0.0)).chain(then(5, 8.4)));
        assert_eq!(state, BatteryState::Critical);
    }
}

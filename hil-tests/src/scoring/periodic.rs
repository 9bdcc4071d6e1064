//! Periodic control with as many runs on the same flight: the one to beat.
//!
//! Two forms. The real one flies a periodic autopilot with its own control state, supplied by
//! the caller, at the rate that gives the same number of runs. The ideal one holds the
//! reference's commands at evenly spaced hyperperiods: what the timing alone is worth, to be
//! set beside the oracle and `rms_from_trigger_quanta`, which hold the reference's commands too.

use super::deviation::{Deviation, rate};
use super::flight::{Command, Flight, Scored};
use super::rules::Rules;
use schemars::JsonSchema;
use serde::Serialize;

/// What a periodic autopilot did in one hyperperiod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Command held at the hyperperiod's end, after any run in it.
    pub command: Command,
    /// Runs in the hyperperiod, those of the failsafe timer included.
    pub runs: u32,
}

/// Periodic control at equal runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct PeriodicEqual {
    /// Runs after warm-up: as near to the policy's as a rate gets.
    pub runs: u64,
    /// The rate that was set, for the ideal form the mean rate, in hertz; null over no time.
    pub rate_hz: Option<f64>,
    /// RMS deviation in configured quanta; null without a hyperperiod.
    pub rms_deviation_quanta: Option<f64>,
    /// Share of hyperperiods that ended stale.
    pub stale_fraction: Option<f64>,
}

/// Flights that the search for the rate may take.
const MOST_FLIGHTS: usize = 12;

/// The reference held at evenly spaced hyperperiods, `runs` of them.
pub(super) fn periodic_ideal(scored: &Scored<'_>, quantum: f32, runs: u64) -> PeriodicEqual {
    let whole = scored.steps.len() as u64;
    let runs = runs.min(whole);
    let mut held = scored.reference;
    let mut deviation = Deviation::default();
    let mut phase = 0;
    for step in scored.steps {
        phase += runs;
        if phase >= whole {
            phase -= whole;
            held = step.reference;
        }
        deviation.add(&held, &step.reference, quantum);
    }
    PeriodicEqual {
        runs,
        rate_hz: rate(runs, scored.length_s()),
        rms_deviation_quanta: deviation.rms_quanta(quantum),
        stale_fraction: deviation.stale_fraction(),
    }
}

/// Flies periodic control at the rate that gives `target` runs after warm-up.
///
/// `fly` gets a rate in hertz and returns what each hyperperiod of the whole flight held, the
/// warm-up's too. It is not called where nothing is scored.
///
/// # Panics
/// When `fly` returns another number of hyperperiods than the flight has.
pub(super) fn periodic_equal(
    flight: &Flight,
    rules: &Rules,
    target: u64,
    mut fly: impl FnMut(f64) -> Vec<Held>,
) -> PeriodicEqual {
    let scored = flight.scored();
    let mut search = RateSearch::new(rules, target, scored.length_s());
    let mut best: Option<PeriodicEqual> = None;
    let flights = if scored.steps.is_empty() {
        0
    } else {
        MOST_FLIGHTS
    };
    for _ in 0..flights {
        let held = fly(search.rate);
        assert_eq!(held.len(), flight.steps().len(), "one entry a hyperperiod");
        let found = measure(&scored, &held[scored.first..], rules.quantum, search.rate);
        let runs = found.runs;
        if best
            .as_ref()
            .is_none_or(|best| nearer(runs, best.runs, target))
        {
            best = Some(found);
        }
        if !search.advance(runs) {
            break;
        }
    }
    best.unwrap_or_default()
}

fn nearer(runs: u64, than: u64, target: u64) -> bool {
    runs.abs_diff(target) < than.abs_diff(target)
}

fn measure(scored: &Scored<'_>, held: &[Held], quantum: f32, rate_hz: f64) -> PeriodicEqual {
    let mut deviation = Deviation::default();
    for (step, held) in scored.steps.iter().zip(held) {
        deviation.add(&held.command, &step.reference, quantum);
    }
    PeriodicEqual {
        runs: held.iter().map(|held| u64::from(held.runs)).sum(),
        rate_hz: Some(rate_hz),
        rms_deviation_quanta: deviation.rms_quanta(quantum),
        stale_fraction: deviation.stale_fraction(),
    }
}

/// Finds the rate: in proportion while that stays within the bracket, else by halving it.
struct RateSearch {
    target: u64,
    rate: f64,
    low: f64,
    high: f64,
}

impl RateSearch {
    fn new(rules: &Rules, target: u64, length_s: f64) -> Self {
        let (low, high) = (*rules.periodic_hz.start(), *rules.periodic_hz.end());
        Self {
            target,
            rate: rate(target, length_s).unwrap_or(high).clamp(low, high),
            low,
            high,
        }
    }

    /// Takes in the runs that the present rate gave; false when no better rate is worth it.
    fn advance(&mut self, runs: u64) -> bool {
        // 0.2 % of the runs moves the deviation by about as much: below what is printed.
        if runs.abs_diff(self.target) <= self.target / 500 {
            return false;
        }
        if runs < self.target {
            self.low = self.rate;
        } else {
            self.high = self.rate;
        }
        let scaled = self.rate * self.target as f64 / runs.max(1) as f64;
        let next = if scaled > self.low && scaled < self.high {
            scaled
        } else {
            f64::midpoint(self.low, self.high)
        };
        let moved = (next - self.rate).abs() > 1e-6 * self.rate;
        self.rate = next;
        moved
    }
}

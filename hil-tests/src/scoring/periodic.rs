//! Periodic control with as many runs or as much work: the one to beat.
//!
//! Two forms. The real one flies a periodic autopilot with its own control state, supplied by
//! the caller, at the rate that gives the same number of runs, or the same load. The ideal one
//! holds the reference's commands at evenly spaced hyperperiods: what the timing alone is worth,
//! to be set beside the oracles and `rms_from_trigger_quanta`, which hold the reference's commands
//! too.
//!
//! Where periodic control happens to run is luck, so every form is the mean over [`PHASES`].

use super::deviation::{Deviation, Straying, Tally, rate};
use super::flight_steps::{Command, FlightSteps, Scored};
use super::load::Reach;
use super::rules::{LoadRules, Rules};
use schemars::JsonSchema;
use serde::Serialize;

/// Phases, evenly spread over a period, that periodic control is flown with.
///
/// On the recorded flights one phase alone lies up to 14 % off the mean over 32, eight phases lie
/// within 2 % of it: RMS deviation, plain and felt, at the runs of reactive control.
pub const PHASES: u32 = 8;

/// When periodic control runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Its rate in hertz.
    pub rate_hz: f64,
    /// Which part of a period passes from the end of the warm-up to the first run: above 0, to 1.
    pub phase: f64,
}

/// What a periodic autopilot did in one hyperperiod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Command held at the hyperperiod's end, after any run in it.
    pub command: Command,
    /// Runs in the hyperperiod, those of the failsafe timer included.
    pub runs: u32,
}

/// Periodic control: means over phases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Periodic {
    /// Runs after warm-up: as near to those wanted as a rate gets.
    pub runs: u64,
    /// The rate that was set, for the ideal form the mean rate, in hertz; null over no time.
    pub rate_hz: Option<f64>,
    /// How far it strayed.
    #[serde(flatten)]
    pub deviation: Deviation,
}

/// Periodic control that keeps the processor as busy as the policy does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EqualLoad {
    /// Share of time in which the policy kept the processor busy, measured on the emulated board
    /// in this replay; null in the native tier.
    pub policy_load_measured: Option<f64>,
    /// The same by `hil-tests/load.toml`, from the replay's samples and runs.
    pub policy_load_by_table: f64,
    /// Share of time in which periodic control keeps it busy, by the same table.
    pub load_by_table: f64,
    /// Whether it equals the policy's, of which the measured one counts before the table's.
    pub reach: Reach,
    /// How it did.
    #[serde(flatten)]
    pub periodic: Periodic,
}

/// Flights that the search for the rate may take.
const MOST_FLIGHTS: usize = 12;

/// Each phase, the whole period last.
fn phases() -> impl Iterator<Item = f64> {
    (1..=PHASES).map(|phase| f64::from(phase) / f64::from(PHASES))
}

impl Periodic {
    fn mean(all: &[Self]) -> Self {
        let count = all.len().max(1) as u64;
        let runs: u64 = all.iter().map(|one| one.runs).sum();
        let deviations: Vec<Deviation> = all.iter().map(|one| one.deviation).collect();
        Self {
            runs: (runs + count / 2) / count,
            rate_hz: all.first().and_then(|one| one.rate_hz),
            deviation: Deviation::mean(&deviations),
        }
    }
}

/// The reference held at evenly spaced hyperperiods, `runs` of them.
pub(super) fn periodic_ideal(scored: &Scored<'_>, quantum: f32, runs: u64) -> Periodic {
    let held: Vec<Periodic> = phases()
        .map(|phase| ideal(scored, quantum, runs, phase))
        .collect();
    Periodic::mean(&held)
}

/// The same with the first run after so much of a period.
pub(super) fn ideal(scored: &Scored<'_>, quantum: f32, runs: u64, phase: f64) -> Periodic {
    let whole = scored.steps.len() as u64;
    let runs = runs.min(whole);
    let mut held = scored.reference;
    let mut straying = Straying::new(quantum);
    straying.at(scored.ran_us, &held, &held);
    let mut tally = Tally::default();
    // In hyperperiods times runs, a period is the whole.
    let mut passed = ((1.0 - phase) * whole as f64) as u64;
    for step in scored.steps {
        passed += runs;
        if passed >= whole {
            passed -= whole;
            held = step.reference;
        }
        tally.add(&straying.at(step.at_us, &held, &step.reference));
    }
    Periodic {
        runs,
        rate_hz: rate(runs, scored.length_s()),
        deviation: tally.deviation(quantum),
    }
}

/// Periodic control on the flight that is scored.
///
/// `fly` gets a clock and returns what each hyperperiod of the whole flight held, the warm-up's
/// too. It is not called where nothing is scored.
pub(super) struct Flown<'f, F> {
    pub flight: &'f FlightSteps,
    pub rules: &'f Rules,
    pub fly: F,
}

impl EqualLoad {
    /// Share of time in which the policy kept the processor busy, as far as it is known.
    #[must_use]
    pub fn policy_load(&self) -> f64 {
        self.policy_load_measured
            .unwrap_or(self.policy_load_by_table)
    }
}

impl<F: FnMut(Clock) -> Vec<Held>> Flown<'_, F> {
    /// At the rate that gives `target` runs after warm-up.
    ///
    /// # Panics
    /// When `fly` returns another number of hyperperiods than the flight has.
    pub fn equal_runs(&mut self, target: u64) -> Periodic {
        let scored = self.flight.scored();
        if scored.steps.is_empty() {
            return Periodic::default();
        }
        let mut search = RateSearch::new(self.rules, target, scored.length_s());
        let mut best: Option<(f64, Periodic)> = None;
        for _ in 0..MOST_FLIGHTS {
            let rate_hz = search.rate;
            let found = self.once(Clock {
                rate_hz,
                phase: 1.0,
            });
            let runs = found.runs;
            if (best.as_ref()).is_none_or(|(_, best)| nearer(runs, best.runs, target)) {
                best = Some((rate_hz, found));
            }
            if !search.advance(runs) {
                break;
            }
        }
        best.map_or_else(Periodic::default, |(rate_hz, last)| {
            self.every_phase(rate_hz, Some(last))
        })
    }

    /// At the rate that takes as much of the processor as the policy did with so many runs.
    pub fn equal_load(&mut self, runs: u64, load: &LoadRules) -> Option<EqualLoad> {
        let scored = self.flight.scored();
        let length_s = scored.length_s();
        let samples_hz = rate(scored.steps.len() as u64, length_s)?;
        let by_table = load
            .policy
            .load(load.core_hz, samples_hz, rate(runs, length_s)?)
            + load.foresight / (load.core_hz * length_s);
        let policy_load = load.busy.unwrap_or(by_table);
        let wanted_hz = (load.periodic).runs_hz(load.core_hz, samples_hz, policy_load);
        let (rate_hz, reach) = Reach::of(wanted_hz, &self.rules.periodic_hz);
        let periodic = self.every_phase(rate_hz, None);
        let runs_hz = rate(periodic.runs, length_s)?;
        Some(EqualLoad {
            policy_load_measured: load.busy,
            policy_load_by_table: by_table,
            load_by_table: load.periodic.load(load.core_hz, samples_hz, runs_hz),
            reach,
            periodic,
        })
    }

    /// The mean over all phases, of which the last may have been flown.
    fn every_phase(&mut self, rate_hz: f64, last: Option<Periodic>) -> Periodic {
        let flights = PHASES as usize - usize::from(last.is_some());
        let flown = phases().take(flights);
        let flown = flown.map(|phase| self.once(Clock { rate_hz, phase }));
        Periodic::mean(&flown.chain(last).collect::<Vec<_>>())
    }

    fn once(&mut self, clock: Clock) -> Periodic {
        let held = (self.fly)(clock);
        let steps = self.flight.steps();
        assert_eq!(held.len(), steps.len(), "one entry a hyperperiod");
        let quantum = self.rules.quantum;
        let first = self.flight.scored().first;
        let (mut straying, mut tally) = (Straying::new(quantum), Tally::default());
        let mut runs = 0;
        for (place, (step, held)) in steps.iter().zip(&held).enumerate() {
            let strayed = straying.at(step.at_us, &held.command, &step.reference);
            if place >= first {
                tally.add(&strayed);
                runs += u64::from(held.runs);
            }
        }
        Periodic {
            runs,
            rate_hz: Some(clock.rate_hz),
            deviation: tally.deviation(quantum),
        }
    }
}

fn nearer(runs: u64, than: u64, target: u64) -> bool {
    runs.abs_diff(target) < than.abs_diff(target)
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

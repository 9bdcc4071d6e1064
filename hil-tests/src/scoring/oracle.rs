//! The oracles: greedy rules over the reference, with hindsight.
//!
//! One runs exactly when the reference differs by its dead-band or more from the value held, the
//! other when the impulse that the held value owes passes its budget: the trigger rules that the
//! firmware knows, of a command that it need not predict. Both run at least every `T_failsafe`: a
//! run falls due at the last hyperperiod that keeps the interval within it. They start from the
//! warm-up's last hyperperiod, as if they had run there. They hold the reference's own commands,
//! so nothing of their deviation comes from diverged control state: strong yardsticks, though not
//! proven minima.

use super::deviation::{Deviation, Straying, Tally, differs};
use super::flight_steps::{Command, Scored, seconds};
use super::rules::Rules;
use reflex::airframe::Axes;
use schemars::JsonSchema;
use serde::Serialize;

/// The oracle with the configured quantum: how few runs would have kept every command fresh.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Oracle {
    /// Runs after warm-up.
    pub runs: u64,
    /// How far it strayed; it is never stale, by how it runs.
    #[serde(flatten)]
    pub deviation: Deviation,
}

/// The oracle with a dead-band that makes it run as often as the policy.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OracleEqual {
    /// Runs after warm-up: as near to the policy's as a dead-band gets.
    pub runs: u64,
    /// The dead-band, in configured quanta.
    pub dead_band_quanta: f64,
    /// How far it strayed.
    #[serde(flatten)]
    pub deviation: Deviation,
}

/// The oracle of the impulse rule.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ImpulseOracle {
    /// Runs after warm-up.
    pub runs: u64,
    /// The impulse that calls for a run, in configured quanta times milliseconds.
    pub budget_quanta_ms: f64,
    /// How far it strayed.
    #[serde(flatten)]
    pub deviation: Deviation,
}

/// What an oracle runs for, more of which makes it run less.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bound {
    /// Some motor is off by so much (share of full scale) or more.
    DeadBand(f32),
    /// Some axis owes more than this (weighted share times seconds).
    Budget(f32),
}

/// The reference after warm-up, packed for many passes.
pub(super) struct Track {
    start: Command,
    ran_us: u64,
    failsafe_us: u64,
    quantum: f32,
    axes: Axes,
    points: Vec<Point>,
}

struct Point {
    reference: Command,
    end_us: u64,
    /// End of the next hyperperiod: the next chance to keep the deadline.
    next_us: u64,
}

/// What no difference and no impulse within `T_failsafe` reaches: only the failsafe runs are left.
const WIDEST: f32 = 2.0;

impl Bound {
    fn size(self) -> f32 {
        match self {
            Self::DeadBand(size) | Self::Budget(size) => size,
        }
    }
}

impl Track {
    pub fn new(scored: &Scored<'_>, rules: &Rules) -> Self {
        let ends = scored.steps.iter().map(|step| step.at_us);
        // No hyperperiod follows the last one: a deadline that falls on it must be met there.
        let after_last = ends.clone().next_back().map(|end| end + 1);
        let nexts = ends.skip(1).chain(after_last);
        Self {
            start: scored.reference,
            ran_us: scored.ran_us,
            failsafe_us: rules.failsafe_us,
            quantum: rules.quantum,
            axes: rules.axes,
            points: scored
                .steps
                .iter()
                .zip(nexts)
                .map(|(step, next_us)| Point {
                    reference: step.reference,
                    end_us: step.at_us,
                    next_us,
                })
                .collect(),
        }
    }

    /// Holds greedily; `each` sees instant, what is held, and the reference. Returns the runs.
    pub fn hold(&self, bound: Bound, mut each: impl FnMut(u64, &Command, &Command)) -> u64 {
        let mut held = self.start;
        let mut ran_us = self.ran_us;
        let mut last_us = self.ran_us;
        let mut owed = [0.0; Axes::COUNT];
        let mut runs = 0;
        for point in &self.points {
            let due = point.next_us.saturating_sub(ran_us) > self.failsafe_us;
            let calls = match bound {
                Bound::DeadBand(width) => differs(&point.reference, &held, width),
                Bound::Budget(budget) => {
                    // Nothing is owed for longer, as across a span that is not scored.
                    let since_us = last_us.max(point.end_us.saturating_sub(self.failsafe_us));
                    let time_s = seconds(since_us, point.end_us) as f32;
                    let off = self.axes.between(&held, &point.reference);
                    for (owed, off) in owed.iter_mut().zip(off) {
                        *owed += off * time_s;
                    }
                    owed.iter().any(|owed| owed.is_nan() || owed.abs() > budget)
                }
            };
            last_us = point.end_us;
            if due || calls {
                held = point.reference;
                ran_us = point.end_us;
                owed = [0.0; Axes::COUNT];
                runs += 1;
            }
            each(point.end_us, &held, &point.reference);
        }
        runs
    }

    fn runs(&self, bound: Bound) -> u64 {
        self.hold(bound, |_, _, _| {})
    }

    fn deviation(&self, bound: Bound) -> (u64, Deviation) {
        let mut straying = Straying::new(self.quantum);
        let mut tally = Tally::default();
        // It starts fresh, as if it had run.
        straying.at(self.ran_us, &self.start, &self.start);
        let runs = self.hold(bound, |at_us, held, reference| {
            tally.add(&straying.at(at_us, held, reference));
        });
        (runs, tally.deviation(self.quantum))
    }

    /// The bound whose runs are nearest to `target`; of two as near, the wider.
    ///
    /// Bisection over the bit patterns of non-negative floats, which are in their order, ends
    /// at two neighbouring floats. Greedy runs need not fall steadily as the bound widens,
    /// so what is found is a crossing of the target, nearly always the only one.
    fn bound_for(&self, target: u64, bound: fn(f32) -> Bound) -> Bound {
        let (mut narrow, mut wide) = (0, WIDEST.to_bits());
        let (mut narrow_runs, mut wide_runs) = (self.runs(bound(0.0)), self.runs(bound(WIDEST)));
        if target >= narrow_runs {
            return bound(0.0);
        }
        if target <= wide_runs {
            return bound(WIDEST);
        }
        while wide - narrow > 1 {
            let middle = narrow + (wide - narrow) / 2;
            let runs = self.runs(bound(f32::from_bits(middle)));
            if runs > target {
                (narrow, narrow_runs) = (middle, runs);
            } else {
                (wide, wide_runs) = (middle, runs);
            }
            if runs == target {
                break;
            }
        }
        let narrow_is_nearer = narrow_runs.abs_diff(target) < wide_runs.abs_diff(target);
        bound(f32::from_bits(if narrow_is_nearer { narrow } else { wide }))
    }

    /// The oracle at the configured quantum.
    pub fn oracle(&self) -> Oracle {
        let (runs, deviation) = self.deviation(Bound::DeadBand(self.quantum));
        Oracle { runs, deviation }
    }

    /// The oracle with as many runs as the policy made.
    pub fn oracle_equal(&self, target: u64) -> OracleEqual {
        let bound = self.bound_for(target, Bound::DeadBand);
        let (runs, deviation) = self.deviation(bound);
        OracleEqual {
            runs,
            dead_band_quanta: f64::from(bound.size()) / f64::from(self.quantum),
            deviation,
        }
    }

    /// The oracle of the impulse rule with this budget.
    pub fn impulse(&self, budget: f32) -> ImpulseOracle {
        self.impulse_within(Bound::Budget(budget))
    }

    /// The same with as many runs as the policy made.
    pub fn impulse_equal(&self, target: u64) -> ImpulseOracle {
        self.impulse_within(self.bound_for(target, Bound::Budget))
    }

    fn impulse_within(&self, bound: Bound) -> ImpulseOracle {
        let (runs, deviation) = self.deviation(bound);
        ImpulseOracle {
            runs,
            budget_quanta_ms: 1e3 * f64::from(bound.size()) / f64::from(self.quantum),
            deviation,
        }
    }
}

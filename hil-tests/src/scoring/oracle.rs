//! The oracle: a greedy dead-band over the reference.
//!
//! It runs exactly when the reference differs by its dead-band or more from the value held,
//! and at least every `T_failsafe`: a run falls due at the last hyperperiod that keeps the
//! interval within it. It starts from the warm-up's last hyperperiod, as if it had run there.
//! It holds the reference's own commands, so nothing of its deviation comes from diverged
//! control state: a strong yardstick, though not a proven minimum.

use super::deviation::{Deviation, differs};
use super::flight::{Command, Scored};
use super::rules::Rules;
use schemars::JsonSchema;
use serde::Serialize;

/// The oracle with the configured quantum: how few runs would have kept every command fresh.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Oracle {
    /// Runs after warm-up.
    pub runs: u64,
    /// RMS deviation in configured quanta; null without a hyperperiod.
    pub rms_deviation_quanta: Option<f64>,
    /// Share of hyperperiods that ended stale: none, by how it runs; null without any.
    pub stale_fraction: Option<f64>,
}

/// The oracle with a dead-band that makes it run as often as the policy.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OracleEqual {
    /// Runs after warm-up: as near to the policy's as a dead-band gets.
    pub runs: u64,
    /// The dead-band, in configured quanta.
    pub dead_band_quanta: f64,
    /// RMS deviation in configured quanta; null without a hyperperiod.
    pub rms_deviation_quanta: Option<f64>,
    /// Share of hyperperiods that ended stale by the configured quantum.
    pub stale_fraction: Option<f64>,
}

/// The reference after warm-up, packed for many passes.
pub(super) struct Track {
    start: Command,
    ran_us: u64,
    failsafe_us: u64,
    points: Vec<Point>,
}

struct Point {
    reference: Command,
    end_us: u64,
    /// End of the next hyperperiod: the next chance to keep the deadline.
    next_us: u64,
}

/// A dead-band wider than full scale: only the failsafe runs are left.
const WIDEST: f32 = 2.0;

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

    /// Holds greedily; `each` sees what is held and the reference. Returns the runs.
    pub fn hold(&self, dead_band: f32, mut each: impl FnMut(&Command, &Command)) -> u64 {
        let mut held = self.start;
        let mut ran_us = self.ran_us;
        let mut runs = 0;
        for point in &self.points {
            let due = point.next_us.saturating_sub(ran_us) > self.failsafe_us;
            if due || differs(&point.reference, &held, dead_band) {
                held = point.reference;
                ran_us = point.end_us;
                runs += 1;
            }
            each(&held, &point.reference);
        }
        runs
    }

    fn runs(&self, dead_band: f32) -> u64 {
        self.hold(dead_band, |_, _| {})
    }

    fn deviation(&self, dead_band: f32, quantum: f32) -> (u64, Deviation) {
        let mut deviation = Deviation::default();
        let runs = self.hold(dead_band, |held, reference| {
            deviation.add(held, reference, quantum);
        });
        (runs, deviation)
    }

    /// The dead-band whose runs are nearest to `target`; of two as near, the wider.
    ///
    /// Bisection over the bit patterns of non-negative floats, which are in their order, ends
    /// at two neighbouring floats. Greedy runs need not fall steadily as the dead-band widens,
    /// so what is found is a crossing of the target, nearly always the only one.
    pub fn dead_band_for(&self, target: u64) -> f32 {
        let (mut narrow, mut wide) = (0, WIDEST.to_bits());
        let (mut narrow_runs, mut wide_runs) = (self.runs(0.0), self.runs(WIDEST));
        if target >= narrow_runs {
            return 0.0;
        }
        if target <= wide_runs {
            return WIDEST;
        }
        while wide - narrow > 1 {
            let middle = narrow + (wide - narrow) / 2;
            let runs = self.runs(f32::from_bits(middle));
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
        f32::from_bits(if narrow_is_nearer { narrow } else { wide })
    }
}

/// The oracle at the configured quantum.
pub(super) fn oracle(track: &Track, quantum: f32) -> Oracle {
    let (runs, deviation) = track.deviation(quantum, quantum);
    Oracle {
        runs,
        rms_deviation_quanta: deviation.rms_quanta(quantum),
        stale_fraction: deviation.stale_fraction(),
    }
}

/// The oracle with as many runs as the policy made.
pub(super) fn oracle_equal(track: &Track, quantum: f32, target: u64) -> OracleEqual {
    let dead_band = track.dead_band_for(target);
    let (runs, deviation) = track.deviation(dead_band, quantum);
    OracleEqual {
        runs,
        dead_band_quanta: f64::from(dead_band) / f64::from(quantum),
        rms_deviation_quanta: deviation.rms_quanta(quantum),
        stale_fraction: deviation.stale_fraction(),
    }
}

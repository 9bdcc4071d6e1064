//! What a trial changed: paired differences, and how sure they are.
//!
//! Ratios are compared by their logarithm. Three logs or more count as one value each: what is asked is
//! how the next flight would be. Fewer give their windows of ten seconds, which says how even an effect
//! is along these flights, and nothing of others.

use schemars::JsonSchema;
use serde::Serialize;

use super::flown::Flown;
use crate::interval::Interval;
use crate::scoring::{Score, Window};

/// Logs that stand for flights that nobody logged.
const FEWEST_LOGS: usize = 3;
/// Shorter windows are no values, in s.
const SHORTEST_WINDOW_S: f64 = 5.0;
/// How often any of all intervals may miss its mean.
const MISSED: f64 = 0.05;

/// What effects are paired by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PairedBy {
    /// Each log is a value.
    Log,
    /// Each window of ten seconds is.
    Window,
}

/// A change in %, and how far the true one may be from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Effect {
    /// Mean change, %.
    pub percent: f64,
    /// Lower end of its interval, %; null for a single pair.
    pub from_percent: Option<f64>,
    /// Upper end, %; null for a single pair.
    pub to_percent: Option<f64>,
    /// Pairs behind it.
    pub pairs: usize,
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    /// Runs per second.
    Runs,
    /// RMS deviation as the motors feel it, in shares of full scale.
    Strayed,
    /// Share of the processor, by the table of loads.
    Load,
}

/// How sure each interval is, so that all of so many together hold with 95 % (Bonferroni).
pub(super) fn confidence(intervals: usize) -> f64 {
    1.0 - MISSED / intervals.max(1) as f64
}

/// What pairs are made of, for so many scored logs.
pub(super) fn paired_by(logs: usize) -> PairedBy {
    match logs {
        FEWEST_LOGS.. => PairedBy::Log,
        _ => PairedBy::Window,
    }
}

impl Measure {
    /// The effect of a trial, by its place; `None` without a pair that can be compared.
    pub(super) fn effect(
        self,
        flown: &[Flown],
        trial: usize,
        quantum: [f64; 2],
        confidence: f64,
    ) -> Option<Effect> {
        let scored = flown.iter().filter(|log| log.is_scored());
        let scored: Vec<&Flown> = scored.collect();
        let pairs = scored.iter().filter_map(|log| {
            let tried = log.trials.get(trial)?;
            Some((&log.configured, tried))
        });
        let ratio = |before: Option<f64>, after: Option<f64>| {
            let ratio = (after? * quantum[1]) / (before? * quantum[0]);
            (ratio > 0.0 && ratio.is_finite()).then(|| ratio.ln())
        };
        let ratios: Vec<f64> = match paired_by(scored.len()) {
            PairedBy::Log => pairs
                .filter_map(|(before, after)| ratio(self.of_flight(before), self.of_flight(after)))
                .collect(),
            PairedBy::Window => pairs
                .flat_map(|(before, after)| before.windows.iter().zip(&after.windows))
                .filter(|(before, after)| is_full(before) && is_full(after))
                .filter_map(|(before, after)| ratio(self.of_window(before), self.of_window(after)))
                .collect(),
        };
        Some(Effect::of(&Interval::at(confidence, &ratios)?))
    }

    fn of_flight(self, score: &Score) -> Option<f64> {
        match self {
            Self::Runs => score.section.control.rate_hz,
            Self::Strayed => score.section.actuators.deviation.rms_felt_quanta,
            Self::Load => Some(score.periodic_equal_load.as_ref()?.policy_load()),
        }
    }

    fn of_window(self, window: &Window) -> Option<f64> {
        match self {
            Self::Runs => window.section.control.rate_hz,
            Self::Strayed => window.section.actuators.deviation.rms_felt_quanta,
            Self::Load => None,
        }
    }
}

fn is_full(window: &Window) -> bool {
    window.length_s >= SHORTEST_WINDOW_S
}

impl Effect {
    /// From the mean of logarithms.
    fn of(interval: &Interval) -> Self {
        let percent = |logarithm: f64| 100.0 * logarithm.exp_m1();
        let ends = interval.half_width.map(|_| interval.ends().map(percent));
        Self {
            percent: percent(interval.mean),
            from_percent: ends.map(|[from, _]| from),
            to_percent: ends.map(|[_, to]| to),
            pairs: interval.count,
        }
    }

    /// The mean of the logarithms.
    pub(super) fn logarithm(&self) -> f64 {
        (self.percent / 100.0).ln_1p()
    }

    /// The largest change that the interval holds; none where a single pair gives no interval.
    pub(super) fn at_most(&self) -> Option<f64> {
        self.to_percent
    }
}

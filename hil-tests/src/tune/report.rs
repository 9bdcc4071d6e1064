//! The result of a tuning: flights as configured, effects of values, what pays.

use anyhow::Result;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::TuneOptions;
use super::curves::{self, Learned};
use super::effect::{PairedBy, confidence, paired_by};
use super::flown::Flown;
use super::proposal::{self, Proposal};
use super::trials::Trial;
use super::tried::Tried;
use crate::replay::logs::Skipped;
use crate::replay::options_in_effect;

/// The report, one JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TuneReport {
    /// Every option in effect, as in a replay's report.
    pub options: Value,
    /// Every log as it is configured.
    pub logs: Vec<Configured>,
    /// What effects are paired by: logs, or windows of ten seconds where logs are fewer than three.
    pub paired_by: PairedBy,
    /// How sure each interval is, so that all together hold with 95 %.
    pub confidence: f64,
    /// What each value would change.
    pub values: Vec<Tried>,
    /// The change that pays most; null where none surely pays.
    pub proposal: Option<Proposal>,
    /// The cheapest way to fewer runs, and the cheapest to less straying, where values surely lead there.
    pub trades: Vec<Trade>,
    /// What each input learned in the longest scored log.
    pub inputs: Vec<Learned>,
    /// Files that were left out.
    pub skipped: Vec<Skipped>,
}

/// A log flown as configured.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Configured {
    /// Its path.
    pub log: String,
    /// Length of what is scored, s.
    pub scored_s: f64,
    /// False for a flight of which nothing can be said: motors at their limits, or no end of the warm-up.
    pub scored: bool,
    /// Runs per second.
    pub runs_per_s: Option<f64>,
    /// RMS deviation from control at every sample as the motors feel it, quanta.
    pub strayed_quanta: Option<f64>,
    /// The same of periodic control at as many runs.
    pub periodic_strayed_quanta: Option<f64>,
    /// Share of the processor, by the table of loads; null for a logic that nobody measured.
    pub load: Option<f64>,
}

/// What a user may want of a value that does not simply pay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wish {
    /// Runs are to fall.
    FewerRuns,
    /// Straying is to fall.
    LessStraying,
}

/// The value that surely grants a wish, and raises the other measure least for what it grants.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Trade {
    /// What it grants.
    pub wish: Wish,
    /// The value, as `table.key`.
    pub value: String,
    /// The tried one, in TOML.
    pub to: String,
    /// Change of the runs per second, %.
    pub runs_percent: f64,
    /// Change of the RMS deviation as the motors feel it, %.
    pub strayed_percent: f64,
}

impl Configured {
    fn of(flown: &Flown) -> Self {
        let score = &flown.configured;
        let load = score.periodic_equal_load.as_ref();
        Self {
            log: flown.log.clone(),
            scored_s: flown.scored_s(),
            scored: flown.is_scored(),
            runs_per_s: score.section.control.rate_hz,
            strayed_quanta: score.section.actuators.deviation.rms_felt_quanta,
            periodic_strayed_quanta: score.periodic_equal.deviation.rms_felt_quanta,
            load: load.map(|load| load.policy_load()),
        }
    }
}

impl TuneReport {
    pub(super) fn new(
        options: &TuneOptions,
        trials: &[Trial],
        flown: Vec<Flown>,
        skipped: Vec<Skipped>,
    ) -> Result<Self> {
        let replay = &options.replay;
        let rotate = replay.reading.rotate.to_string();
        let scored = flown.iter().filter(|log| log.is_scored());
        let longest = scored
            .clone()
            .max_by(|one, other| one.scored_s().total_cmp(&other.scored_s()));
        // Runs and deviation of each trial.
        let confidence = confidence(2 * trials.len());
        let values: Vec<Tried> = trials
            .iter()
            .enumerate()
            .map(|(place, trial)| Tried::of(&flown, place, trial, &replay.settings, confidence))
            .collect();
        Ok(Self {
            options: serde_json::to_value(options_in_effect(replay, rotate))?,
            paired_by: paired_by(scored.count()),
            confidence,
            proposal: proposal::of(&values)?,
            trades: trades(&values),
            values,
            inputs: longest.map_or_else(Vec::new, |log| curves::of(&log.learned, &replay.settings)),
            logs: flown.iter().map(Configured::of).collect(),
            skipped,
        })
    }

    /// Logs that are scored.
    #[must_use]
    pub fn scored_logs(&self) -> usize {
        self.logs.iter().filter(|log| log.scored).count()
    }
}

/// A trade for each wish that some value surely grants.
fn trades(values: &[Tried]) -> Vec<Trade> {
    let of = |wish: Wish| {
        let granting = values.iter().filter(|tried| tried.lost_logs == 0);
        let granting = granting.filter_map(|tried| {
            let (runs, strayed) = (tried.runs?, tried.strayed?);
            let (granted, other) = match wish {
                Wish::FewerRuns => (runs, strayed),
                Wish::LessStraying => (strayed, runs),
            };
            let price = other.logarithm() / -granted.logarithm();
            granted.at_most().is_some_and(|most| most < 0.0).then(|| {
                let trade = Trade {
                    wish,
                    value: tried.path(),
                    to: tried.to.clone(),
                    runs_percent: runs.percent,
                    strayed_percent: strayed.percent,
                };
                (price, trade)
            })
        });
        let cheapest = granting.min_by(|(one, _), (other, _)| one.total_cmp(other));
        cheapest.map(|(_, trade)| trade)
    };
    [Wish::FewerRuns, Wish::LessStraying]
        .into_iter()
        .filter_map(of)
        .collect()
}

//! The result of a tuning: the flights as configured, the effect of each value, what pays.

use anyhow::Result;
use reflex::settings::Settings;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::curves::{self, Learned};
use super::effect::{Effect, Measure, PairedBy, confidence, paired_by};
use super::proposal::{self, Proposal};
use super::trials::Trial;
use super::{Flight, TuneOptions};
use crate::replay::logs::Skipped;
use crate::replay::options_in_effect;
use crate::scoring::Score;

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

/// A value that was tried, and what it changed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tried {
    /// The table in `config/reactive.toml`.
    pub section: String,
    /// The key in it.
    pub key: String,
    /// The configured value, in TOML.
    pub from: String,
    /// The tried one.
    pub to: String,
    /// Change of the runs per second.
    pub runs: Option<Effect>,
    /// Change of the RMS deviation as the motors feel it.
    pub strayed: Option<Effect>,
    /// Change of the processor's load; null where effects are paired by window.
    pub load: Option<Effect>,
    /// Logs that are scored as configured, and no more with this value.
    pub lost_logs: usize,
    /// It surely lowers runs or deviation, and raises neither by more than 2 %.
    pub pays: bool,
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

/// One log, flown as configured and in every trial.
pub(super) struct Flown {
    pub(super) log: String,
    pub(super) configured: Score,
    learned: Vec<crate::replay::native::Learned>,
    pub(super) trials: Vec<Score>,
}

/// By how much, in %, a value that pays may raise what it does not lower.
const TOLERATED: f64 = 2.0;

impl Flown {
    /// From the flights of a log, the configured one first; `None` of none.
    pub(super) fn new(log: &str, flights: Vec<Flight>) -> Option<Self> {
        let mut flights = flights.into_iter();
        let configured = flights.next()?;
        Some(Self {
            log: log.to_owned(),
            configured: configured.score,
            learned: configured.learned,
            trials: flights.map(|flight| flight.score).collect(),
        })
    }

    /// Whether the flight as configured says anything.
    pub(super) fn is_scored(&self) -> bool {
        self.configured.scored
    }

    fn scored_s(&self) -> f64 {
        self.configured.duration_s - self.configured.warm_up_s
    }

    fn configured(&self) -> Configured {
        let score = &self.configured;
        let load = score.periodic_equal_load.as_ref();
        Configured {
            log: self.log.clone(),
            scored_s: self.scored_s(),
            scored: self.is_scored(),
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
            .map(|(place, trial)| tried(&flown, place, trial, &replay.settings, confidence))
            .collect();
        Ok(Self {
            options: serde_json::to_value(options_in_effect(replay, rotate))?,
            paired_by: paired_by(scored.count()),
            confidence,
            proposal: proposal::of(&values)?,
            trades: trades(&values),
            values,
            inputs: longest.map_or_else(Vec::new, |log| curves::of(&log.learned, &replay.settings)),
            logs: flown.iter().map(Flown::configured).collect(),
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

fn tried(
    flown: &[Flown],
    place: usize,
    trial: &Trial,
    configured: &Settings,
    confidence: f64,
) -> Tried {
    let quanta = [configured, &trial.settings].map(|settings| f64::from(settings.quantum));
    let effect = |measure: Measure, units| measure.effect(flown, place, units, confidence);
    let runs = effect(Measure::Runs, [1.0; 2]);
    let strayed = effect(Measure::Strayed, quanta);
    let is_lost = |log: &&Flown| {
        let tried = log.trials.get(place);
        log.is_scored() && !tried.is_some_and(|score| score.scored)
    };
    let lost_logs = flown.iter().filter(is_lost).count();
    let pays = |lower: Option<Effect>, other: Option<Effect>| {
        let at_most = |effect: Option<Effect>| effect.and_then(|effect| effect.at_most());
        at_most(lower).is_some_and(|most| most < 0.0)
            && at_most(other).is_some_and(|most| most <= TOLERATED)
    };
    Tried {
        section: trial.section.clone(),
        key: trial.key.to_owned(),
        from: trial.from.clone(),
        to: trial.to.clone(),
        runs,
        strayed,
        load: effect(Measure::Load, [1.0; 2]),
        lost_logs,
        pays: lost_logs == 0 && (pays(runs, strayed) || pays(strayed, runs)),
    }
}

impl Tried {
    /// True where it surely changes runs or straying.
    pub(super) fn is_sure(&self) -> bool {
        let effects = [self.runs, self.strayed].into_iter().flatten();
        effects
            .filter_map(|effect| effect.from_percent.zip(effect.to_percent))
            .any(|(from, to)| from > 0.0 || to < 0.0)
    }

    /// Its place in the configuration.
    #[must_use]
    pub fn path(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }
}

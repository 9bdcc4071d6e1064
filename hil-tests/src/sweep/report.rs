//! The result of a sweep: scores, medians over logs, and what was left out.

use anyhow::Result;
use reflex::settings::Settings;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

use super::SweepOptions;
use super::grid::{Grid, Parameter};
use super::outcome::Outcome;
use crate::replay::logs::{Log, Skipped};
use crate::replay::options_in_effect;
use crate::scoring::Score;

/// The report, one JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SweepReport {
    /// Every option in effect, as in a replay's report; a swept one is the list of its values.
    pub options: Value,
    /// Every log at every point, logs in the order of their names.
    pub points: Vec<SweepPoint>,
    /// Medians at every point over the logs that are scored there.
    pub medians: Vec<Median>,
    /// Files that were left out.
    pub skipped: Vec<Skipped>,
    /// What was swept.
    #[serde(skip)]
    pub(super) grid: Grid,
    /// The quantum, as a share of full scale, that tables and figures count deviations in:
    /// one for all points, though the quantum may be swept.
    #[serde(skip)]
    pub(super) unit: f64,
    /// What holds at every point.
    #[serde(skip)]
    pub(super) base: Settings,
}

/// One log flown with one point's settings.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SweepPoint {
    /// The log's path.
    pub log: String,
    /// Where in the grid.
    #[serde(flatten)]
    pub at: At,
    /// Its score; deviations are in this point's quanta.
    #[serde(flatten)]
    pub score: Score,
}

/// The settings that a sweep can vary.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct At {
    /// Probability of a changed command that calls for a run.
    pub p_run: f64,
    /// The longest time between runs, s.
    pub failsafe_s: f64,
    /// The change of a motor command that counts, as a share of full scale.
    pub quantum: f64,
}

/// The medians of one point.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Median {
    /// Where in the grid.
    #[serde(flatten)]
    pub at: At,
    /// Logs that are scored there.
    pub logs: usize,
    /// The medians over them; deviations are in this point's quanta.
    #[serde(flatten)]
    pub outcome: Outcome,
}

impl At {
    fn of(settings: &Settings) -> Self {
        Self {
            p_run: Parameter::PRun.value(settings),
            failsafe_s: Parameter::Failsafe.value(settings),
            quantum: Parameter::Quantum.value(settings),
        }
    }

    /// The value of one parameter.
    #[must_use]
    pub fn value(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::PRun => self.p_run,
            Parameter::Failsafe => self.failsafe_s,
            Parameter::Quantum => self.quantum,
        }
    }
}

impl SweepPoint {
    pub(super) fn new(log: &Log, settings: &Settings, score: Score) -> Self {
        Self {
            log: log.name.clone(),
            at: At::of(settings),
            score,
        }
    }

    /// The few numbers that are compared.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        Outcome::of(&self.score)
    }
}

impl SweepReport {
    pub(super) fn new(
        options: &SweepOptions,
        points: Vec<SweepPoint>,
        skipped: Vec<Skipped>,
    ) -> Result<Self> {
        let base = options.replay.settings;
        let medians = options.grid.settings(base);
        let medians = medians.iter().map(|settings| median(&points, settings));
        Ok(Self {
            options: effective(options)?,
            medians: medians.collect(),
            points,
            skipped,
            grid: options.grid.clone(),
            unit: At::of(&base).quantum,
            base,
        })
    }

    /// The logs with their points, in order.
    pub(super) fn by_log(&self) -> impl Iterator<Item = &[SweepPoint]> {
        self.points.chunk_by(|one, next| one.log == next.log)
    }
}

fn median(points: &[SweepPoint], settings: &Settings) -> Median {
    let at = At::of(settings);
    let here = points
        .iter()
        .filter(|point| point.at == at && point.score.scored);
    let outcomes: Vec<Outcome> = here.map(SweepPoint::outcome).collect();
    Median {
        at,
        logs: outcomes.len(),
        outcome: Outcome::median(&outcomes),
    }
}

/// The options with their names in a replay's report.
fn effective(options: &SweepOptions) -> Result<Value> {
    let replay = &options.replay;
    let mut all =
        serde_json::to_value(options_in_effect(replay, replay.reading.rotate.to_string()))?;
    for axis in options.grid.axes() {
        all[axis.parameter().key()] = json!(axis.values());
    }
    Ok(all)
}

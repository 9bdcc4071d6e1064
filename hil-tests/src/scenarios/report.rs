//! What came of scenarios, as JSON and as a table.

use std::fmt::Write;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Scenario;
use crate::closed_loop::{FaultReport, Outcome};

/// Longest time between two runs while armed, ms: a failsafe period, a hyperperiod, and the time of a task.
const LONGEST_GAP_MS: f64 = 102.0;

/// All scenarios, flown with one logic and seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scenarios {
    /// Control logic that flew.
    pub logic: String,
    /// Seed of wind and noise.
    pub seed: u32,
    /// What came of each.
    pub scenarios: Vec<ScenarioReport>,
}

/// What came of one scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScenarioReport {
    /// Its name.
    pub name: String,
    /// What broke.
    pub fault: String,
    /// When the firmware noticed, ms behind the fault; null where it did not.
    pub detected_ms: Option<f64>,
    /// What it noticed.
    pub detected_by: Option<String>,
    /// The flight state at the end.
    pub mode: String,
    /// How it ended.
    pub outcome: Outcome,
    /// Largest tilt from level, degrees.
    pub tilt_deg: f64,
    /// All that is expected happened, no command was out of range, and control ran often enough.
    pub passed: bool,
    /// What did not happen as expected.
    pub missed: Vec<String>,
    /// Why a scenario that does not pass is known not to.
    pub weakness: Option<String>,
}

impl ScenarioReport {
    pub(super) fn of(scenario: &Scenario, came: FaultReport) -> Self {
        let missed = missed(scenario, &came);
        Self {
            name: scenario.name().to_owned(),
            fault: scenario.fault(),
            detected_ms: came.detected_ms,
            detected_by: came.detected_by,
            mode: came.states.last().cloned().unwrap_or_default(),
            outcome: came.outcome,
            tilt_deg: came.largest_tilt_deg,
            passed: missed.is_empty(),
            missed,
            weakness: scenario.written.weakness.clone(),
        }
    }

    fn verdict(&self) -> &'static str {
        match (self.passed, &self.weakness) {
            (true, None) => "passed",
            (false, None) => "FAILED",
            (false, Some(_)) => "known weakness",
            (true, Some(_)) => "MENDED",
        }
    }
}

fn missed(scenario: &Scenario, came: &FaultReport) -> Vec<String> {
    let expected = &scenario.written;
    let mut missed = Vec::new();
    let mut expect = |happened: bool, line: String| {
        if !happened {
            missed.push(line);
        }
    };
    if let Some(within) = expected.detected_ms {
        let in_time = came.detected_ms.is_some_and(|ms| ms <= within);
        expect(in_time, format!("not detected within {within} ms"));
    }
    if let Some(state) = &expected.state {
        expect(came.states.contains(state), format!("never {state}"));
    }
    let words: Vec<&str> = expected
        .outcome
        .iter()
        .map(|outcome| outcome.word())
        .collect();
    let ends = expected.outcome.contains(&came.outcome);
    expect(ends, format!("not {}", words.join(" or ")));
    if let Some(most) = expected.tilt_deg {
        expect(
            came.largest_tilt_deg <= most,
            format!("tilted beyond {most} degrees"),
        );
    }
    expect(
        came.bad_commands == 0,
        format!("{} bad commands", came.bad_commands),
    );
    let gap = came.longest_gap_ms;
    expect(gap <= LONGEST_GAP_MS, format!("{gap:.0} ms without a run"));
    missed
}

impl Scenarios {
    /// Scenarios that do not end as their files say: those that fail, and known weaknesses that are none any more.
    #[must_use]
    pub fn surprises(&self) -> Vec<&str> {
        let surprising = |report: &&ScenarioReport| report.passed == report.weakness.is_some();
        let surprises = self.scenarios.iter().filter(surprising);
        surprises.map(|report| report.name.as_str()).collect()
    }

    /// How many scenarios fail for a known reason.
    #[must_use]
    pub fn weaknesses(&self) -> usize {
        let weak = |report: &&ScenarioReport| !report.passed && report.weakness.is_some();
        self.scenarios.iter().filter(weak).count()
    }

    /// For a person.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = format!(
            "{:26} {:>9}  {:16} {:12} {:8} {:>5}  verdict\n",
            "scenario", "ms", "detected by", "mode", "outcome", "tilt"
        );
        for report in &self.scenarios {
            let ms = report
                .detected_ms
                .map_or("-".to_owned(), |ms| format!("{ms:.1}"));
            let by = report.detected_by.as_deref().unwrap_or("-");
            let _ = writeln!(
                text,
                "{:26} {ms:>9}  {by:16} {:12} {:8} {:>5.0}  {}",
                report.name,
                report.mode,
                report.outcome.word(),
                report.tilt_deg,
                report.verdict()
            );
            if !report.passed {
                let _ = writeln!(text, "    {}", report.missed.join(", "));
            }
            if let Some(weakness) = &report.weakness {
                let _ = writeln!(text, "    {weakness}");
            }
        }
        let passed = self.scenarios.iter().filter(|report| report.passed).count();
        let (all, weak) = (self.scenarios.len(), self.weaknesses());
        let _ = writeln!(text, "{passed} of {all} passed, {weak} known weaknesses");
        text
    }
}

//! What came of scenarios, as JSON and as a table.

use std::collections::BTreeMap;
use std::fmt::Write;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Breach, Scenario};
use crate::closed_loop::{FaultReport, Outcome};
use crate::logics::LogicName;

/// All scenarios that were flown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scenarios {
    /// What came of each flight.
    pub scenarios: Vec<ScenarioReport>,
}

/// What came of one flight of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScenarioReport {
    /// Its name.
    pub name: String,
    /// Control logic that flew.
    pub logic: String,
    /// Seed of wind and noise.
    pub seed: u32,
    /// What broke.
    pub fault: String,
    /// When the firmware noticed, ms behind the fault; null where it did not.
    pub detected_ms: Option<f64>,
    /// What it noticed.
    pub detected_by: Option<String>,
    /// Within what it was to notice, ms; null where it need not.
    pub within_ms: Option<f64>,
    /// The flight state at the end.
    pub mode: String,
    /// Those from the fault on, in their order.
    pub states: Vec<String>,
    /// When it stopped the motors, ms behind the fault; null where they turned to the end.
    pub stopped_ms: Option<f64>,
    /// When all that it noticed was over for good, ms behind the fault; null where it never was.
    pub recovered_ms: Option<f64>,
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
    /// It is known not to pass in any flight, so that one which passes is a surprise.
    pub always_fails: bool,
}

impl ScenarioReport {
    pub(super) fn of(
        scenario: &Scenario,
        (logic, seed): (LogicName, u32),
        came: FaultReport,
    ) -> Self {
        let missed = missed(scenario, &came);
        Self {
            name: scenario.name().to_owned(),
            logic: logic.word().to_owned(),
            seed,
            fault: scenario.fault(),
            detected_ms: came.detected_ms,
            detected_by: came.detected_by,
            within_ms: scenario.written.detected_ms,
            mode: came.states.last().cloned().unwrap_or_default(),
            states: came.states,
            stopped_ms: came.stopped_ms,
            recovered_ms: came.recovered_ms,
            outcome: came.outcome,
            tilt_deg: came.largest_tilt_deg,
            passed: missed.is_empty(),
            missed,
            weakness: scenario.weakness(logic.word()).cloned(),
            always_fails: scenario.always_fails(),
        }
    }

    fn verdict(&self) -> &'static str {
        match (self.passed, &self.weakness) {
            (true, None) => "passed",
            (false, None) => "FAILED",
            (false, Some(_)) => "known weakness",
            (true, Some(_)) if self.always_fails => "MENDED",
            (true, Some(_)) => "passed",
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
    missed.extend(Breach::of_control(came).map(|breach| breach.to_string()));
    missed
}

/// All flights of one scenario.
struct Flights<'r>(Vec<&'r ScenarioReport>);

impl Flights<'_> {
    fn passed(&self) -> usize {
        self.0.iter().filter(|report| report.passed).count()
    }

    /// One fails without a known reason; or none fails, though each is known to.
    fn is_surprising(&self) -> bool {
        let fails_oddly = |report: &&ScenarioReport| !report.passed && report.weakness.is_none();
        let is_mended = self
            .0
            .iter()
            .all(|report| report.passed && report.always_fails);
        self.0.iter().any(fails_oddly) || is_mended
    }

    /// `4/5 flies, cut 31`: those that passed, how they ended, the largest tilt.
    fn cell(&self) -> String {
        let mut ends: Vec<&str> = self.0.iter().map(|report| report.outcome.word()).collect();
        ends.sort_unstable();
        ends.dedup();
        let tilts = self.0.iter().map(|report| report.tilt_deg);
        let tilt = tilts.fold(0.0, f64::max);
        let (passed, all) = (self.passed(), self.0.len());
        format!("{passed}/{all} {} {tilt:.0}", ends.join(", "))
    }
}

impl Scenarios {
    /// Scenarios that do not end as their files say: those that fail, and known weaknesses that are none any more.
    #[must_use]
    pub fn surprises(&self) -> Vec<&str> {
        let names = self.names().into_iter();
        let surprising = names.filter(|name| self.flights(|one| one.name == *name).is_surprising());
        surprising.collect()
    }

    fn names(&self) -> Vec<&str> {
        distinct(self.scenarios.iter().map(|report| report.name.as_str()))
    }

    fn flights(&self, of: impl Fn(&ScenarioReport) -> bool) -> Flights<'_> {
        Flights(self.scenarios.iter().filter(|report| of(report)).collect())
    }

    /// For a person: every flight, or where there are several of a scenario what came of them by logic.
    #[must_use]
    pub fn table(&self) -> String {
        let names = self.names();
        let mut text = if names.len() == self.scenarios.len() {
            self.by_flight()
        } else {
            self.by_logic(&names)
        };
        let all = self.flights(|_| true);
        let weak = self.flights(|report| !report.passed && report.weakness.is_some());
        let _ = writeln!(
            text,
            "{} of {} passed, {} known weaknesses",
            all.passed(),
            all.0.len(),
            weak.0.len()
        );
        text
    }

    fn by_flight(&self) -> String {
        let mut text = format!(
            "{:26} {:>8} {:>6}  {:16} {:22} {:>9} {:>8} {:8} {:>4}  verdict\n",
            "scenario", "noticed", "within", "by", "states", "stopped", "over", "outcome", "tilt"
        );
        for report in &self.scenarios {
            let _ = writeln!(
                text,
                "{:26} {:>8} {:>6}  {:16} {:22} {:>9} {:>8} {:8} {:>4.0}  {}",
                report.name,
                millis(report.detected_ms, 1),
                millis(report.within_ms, 0),
                report.detected_by.as_deref().unwrap_or("-"),
                report.states.join(" "),
                millis(report.stopped_ms, 0),
                millis(report.recovered_ms, 0),
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
        text + "Times are ms behind the fault, tilts degrees.\n"
    }

    fn by_logic(&self, names: &[&str]) -> String {
        let logics = distinct(self.scenarios.iter().map(|report| report.logic.as_str()));
        let mut text = format!("{:26}", "scenario");
        for logic in &logics {
            let _ = write!(text, " {logic:24}");
        }
        text.push('\n');
        for name in names {
            let _ = write!(text, "{name:26}");
            for logic in &logics {
                let flights = self.flights(|one| one.name == *name && one.logic == *logic);
                let _ = write!(text, " {:24}", flights.cell());
            }
            text.push('\n');
        }
        text += "Passed of flown, how they ended, largest tilt in degrees.\n";
        let mut failed: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for report in self.scenarios.iter().filter(|report| !report.passed) {
            let what = format!(
                "{}, {}: {}",
                report.name,
                report.logic,
                report.missed.join(", ")
            );
            failed
                .entry(what)
                .or_default()
                .push(report.seed.to_string());
        }
        for (what, seeds) in failed {
            let _ = writeln!(text, "{what} (seeds {})", seeds.join(" "));
        }
        text
    }
}

fn millis(time: Option<f64>, digits: usize) -> String {
    time.map_or("-".to_owned(), |ms| format!("{ms:.digits$}"))
}

/// Each once, in the order in which they come first.
fn distinct<'r>(words: impl Iterator<Item = &'r str>) -> Vec<&'r str> {
    let mut distinct = Vec::new();
    for word in words {
        if !distinct.contains(&word) {
            distinct.push(word);
        }
    }
    distinct
}

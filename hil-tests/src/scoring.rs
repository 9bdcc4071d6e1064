//! From what happened in a replay to the numbers of its report.
//!
//! Pure functions over plain data: no emulator, no clock, no file. A replay fills
//! [`FlightSteps`] hyperperiod by hyperperiod, [`score`] turns them into a [`Score`], a
//! [`Report`] adds what the replay knows about itself, and [`summary`] writes that for a person.
//! Native sweeps score with the same functions.
//!
//! Everything is counted after warm-up only. Where a quantity has no value (a share of no
//! hyperperiods, a latency without a run) it is `None`, which is `null` in the report; no
//! number there is ever infinite or not a number. The definitions are where they are computed:
//! decisions and staleness in `judge`, the yardsticks in `oracle` and `periodic`, the load in
//! `load`.

mod deviation;
mod digest;
mod felt;
mod flight_steps;
mod judge;
mod latency;
mod load;
mod options;
mod oracle;
mod periodic;
mod reason;
mod report;
mod rules;
mod section;
mod summary;
mod table;
#[cfg(test)]
mod tests;

pub use deviation::{Deviation, differs};
pub use digest::MotorDigest;
pub use flight_steps::{Command, FlightSteps, Run, Step};
pub use latency::{LatencySample, Quantiles, latencies};
pub use load::{Busy, Cost, LOADS, LoadTable, LogicCosts, Reach};
pub use options::{number, report_name};
pub use oracle::{ImpulseOracle, Oracle, OracleEqual};
pub use periodic::{Clock, EqualLoad, Held, PHASES, Periodic};
pub use reason::ByReason;
pub use report::{
    BoardTime, Cpu, Firmware, FlightPart, Gap, LatencyPart, ModelState, Options, Report, RunReport,
    Sensor, SetpointSource, Tier, WithoutLeading,
};
pub use rules::{LoadRules, MOST_SATURATED, Rules};
pub use section::{Actuators, Calibration, Control, Decisions, Section, WINDOW_US, Window};
pub use summary::summary;
pub(crate) use table::{Table, or_dash};

use oracle::Track;
use periodic::Flown;
use schemars::JsonSchema;
use serde::Serialize;

/// The warm-up that came before what is scored.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct WarmUp {
    /// False where the flight ended first; nothing is scored then.
    pub ended: bool,
    /// Hyperperiods in it.
    pub hyperperiods: u64,
    /// Runs in it.
    pub runs: u64,
}

/// Every number that follows from a flight alone.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Score {
    /// Length of the flight in seconds of the firmware's clock, warm-up included.
    pub duration_s: f64,
    /// Length of the warm-up in seconds; the whole flight where it never ended.
    pub warm_up_s: f64,
    /// Hyperperiods after warm-up.
    pub hyperperiods: u64,
    /// The warm-up itself.
    pub warm_up: WarmUp,
    /// False for a flight without hyperperiods after warm-up or with too many saturated ones.
    pub scored: bool,
    /// Control, decisions, calibration and actuators after warm-up.
    #[serde(flatten)]
    pub section: Section,
    /// The oracle with the configured quantum.
    pub oracle: Oracle,
    /// The oracle with as many runs.
    pub oracle_equal: OracleEqual,
    /// The oracle of the impulse rule with the configured budget.
    pub oracle_impulse: ImpulseOracle,
    /// The oracle of the impulse rule with as many runs.
    pub oracle_impulse_equal: ImpulseOracle,
    /// A periodic autopilot with as many runs.
    pub periodic_equal: Periodic,
    /// A periodic autopilot with the same load; null where nobody measured the control logic's.
    pub periodic_equal_load: Option<EqualLoad>,
    /// The reference held at evenly spaced hyperperiods, as many as there were runs.
    pub periodic_ideal: Periodic,
    /// Control, decisions and actuators per 10 s.
    pub windows: Vec<Window>,
}

/// Scores a flight.
///
/// `fly` flies the same input with a periodic autopilot by a clock and returns one entry
/// per hyperperiod, warm-up included; it is called a few times, with other rates, until the runs
/// match, and then with other phases.
///
/// # Panics
/// When `fly` returns another number of entries than the flight has hyperperiods.
pub fn score(flight: &FlightSteps, rules: &Rules, fly: impl FnMut(Clock) -> Vec<Held>) -> Score {
    let scored = flight.scored();
    let judged = judge::judge(flight, rules);
    let section = Section::of(
        scored.steps,
        judged.get(scored.first..).unwrap_or_default(),
        scored.length_s(),
        rules,
    );
    let runs = section.control.runs;
    let track = Track::new(&scored, rules);
    let mut periodic = Flown { flight, rules, fly };
    let load = rules.load.as_ref();
    Score {
        duration_s: flight.seconds(flight.last_us()),
        warm_up_s: flight.seconds(scored.start_us),
        hyperperiods: scored.steps.len() as u64,
        warm_up: warm_up(flight),
        scored: section
            .actuators
            .saturated_fraction
            .is_some_and(|share| share <= MOST_SATURATED),
        oracle: track.oracle(),
        oracle_equal: track.oracle_equal(runs),
        oracle_impulse: track.impulse(rules.budget()),
        oracle_impulse_equal: track.impulse_equal(runs),
        periodic_equal: periodic.equal_runs(runs),
        periodic_equal_load: load.and_then(|load| periodic.equal_load(runs, load)),
        periodic_ideal: periodic::periodic_ideal(&scored, rules.quantum, runs),
        windows: section::windows(flight, &judged, rules),
        section,
    }
}

fn warm_up(flight: &FlightSteps) -> WarmUp {
    let first = flight.scored().first;
    let steps = flight.steps().get(..first).unwrap_or_default();
    WarmUp {
        ended: flight.warm_up_end_us().is_some(),
        hyperperiods: first as u64,
        runs: steps.iter().map(|step| step.runs().count() as u64).sum(),
    }
}

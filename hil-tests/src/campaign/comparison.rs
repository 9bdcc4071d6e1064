//! Pairs of flights in the same wind, and how much better one is, cell by cell.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::interval::Interval;
use super::journal::{Landed, Records};
use super::plan::{Plan, USUAL_HZ};
use super::role::{Contender, Role};
use super::sortie::{Sortie, Tier};
use crate::closed_loop::report::FlightReport;

/// What a flight is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Root of the sum of the squared errors of all three axes.
    Attitude,
    /// Error of pitch.
    Pitch,
    /// Error of roll.
    Roll,
    /// Error of yaw.
    Yaw,
    /// Distance from where the drone should be.
    Position,
    /// Time to 20 % of the battery.
    FlightTime,
}

/// Which flights are compared with which, under the same seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Comparison {
    /// Its name in figures and JSON.
    pub name: &'static str,
    /// What is better or worse.
    pub of: Role,
    /// Than what.
    pub against: Role,
}

/// Every comparison of the main part, in the order of the report.
pub const COMPARISONS: [Comparison; 11] = [
    Comparison {
        name: "reactive against 400 Hz",
        of: Role::Reactive,
        against: Role::Periodic(USUAL_HZ),
    },
    Comparison {
        name: "reactive against periodic, equal runs",
        of: Role::Reactive,
        against: Role::EqualRuns,
    },
    Comparison {
        name: "reactive against periodic, equal processor time",
        of: Role::Reactive,
        against: Role::EqualTime,
    },
    Comparison {
        name: "reactive without foresight against 400 Hz",
        of: Role::Unforeseen,
        against: Role::Periodic(USUAL_HZ),
    },
    Comparison {
        name: "at equal margins: reactive against 400 Hz",
        of: Role::Tuned(Contender::Reactive),
        against: Role::Tuned(Contender::Usual),
    },
    Comparison {
        name: "at equal margins: reactive against periodic, equal runs",
        of: Role::Tuned(Contender::Reactive),
        against: Role::Tuned(Contender::EqualRuns),
    },
    Comparison {
        name: "what it can buy: reactive with faster loops against 400 Hz as configured",
        of: Role::Tuned(Contender::Reactive),
        against: Role::Periodic(USUAL_HZ),
    },
    Comparison {
        name: "hovering: reactive against 400 Hz",
        of: Role::Hovering(Contender::Reactive),
        against: Role::Hovering(Contender::Usual),
    },
    Comparison {
        name: "hovering: reactive against periodic, equal runs",
        of: Role::Hovering(Contender::Reactive),
        against: Role::Hovering(Contender::EqualRuns),
    },
    Comparison {
        name: "hovering, what it can buy: reactive with a disturbance observer against 400 Hz without",
        of: Role::Observing(Contender::Reactive),
        against: Role::Hovering(Contender::Usual),
    },
    Comparison {
        name: "hovering: 400 Hz with a disturbance observer against 400 Hz without",
        of: Role::Observing(Contender::Usual),
        against: Role::Hovering(Contender::Usual),
    },
];

/// How one airframe with one logic compares in one environment.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Cell {
    /// Name of the environment.
    pub environment: String,
    /// Name of the airframe.
    pub airframe: String,
    /// Name of the control logic.
    pub logic: String,
    /// Pairs of flights that were flown.
    pub pairs: usize,
    /// Crashes of the first and of the second of each pair.
    pub crashes: [usize; 2],
    /// Improvement in % over pairs in which nobody crashed; positive is better.
    pub improvement_percent: BTreeMap<Metric, Interval>,
}

/// A comparison over all cells.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Compared {
    /// Who is compared with whom.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// The mean of all cells.
    pub improvement_percent: BTreeMap<Metric, Interval>,
    /// Each cell.
    pub cells: Vec<Cell>,
}

impl Metric {
    /// Every metric.
    pub const ALL: [Self; 6] = [
        Self::Attitude,
        Self::Pitch,
        Self::Roll,
        Self::Yaw,
        Self::Position,
        Self::FlightTime,
    ];

    /// As a person calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Attitude => "attitude error",
            Self::Pitch => "pitch error",
            Self::Roll => "roll error",
            Self::Yaw => "yaw error",
            Self::Position => "position error",
            Self::FlightTime => "flight time",
        }
    }

    /// Its value of a flight; none of one that crashed.
    #[must_use]
    pub fn value(self, report: &FlightReport) -> Option<f64> {
        let errors = report.attitude_error_deg;
        match self {
            Self::Attitude => {
                let axes = [errors.roll?, errors.pitch?, errors.yaw?];
                Some(axes.iter().map(|axis| axis * axis).sum::<f64>().sqrt())
            }
            Self::Pitch => errors.pitch,
            Self::Roll => errors.roll,
            Self::Yaw => errors.yaw,
            Self::Position => report.position_error_m,
            Self::FlightTime => report.flight_time_s,
        }
    }

    /// How much better a flight is than another, in %: less error, or more time.
    #[must_use]
    pub fn improvement(self, of: &FlightReport, against: &FlightReport) -> Option<f64> {
        let ratio = self.value(of)? / self.value(against)?;
        let percent = match self {
            Self::FlightTime => 100.0 * (ratio - 1.0),
            _ => 100.0 * (1.0 - ratio),
        };
        percent.is_finite().then_some(percent)
    }
}

/// Two flights in the same wind.
pub type Pair<'r> = (&'r Landed, &'r Landed);

/// Flights of a plan's trials in a role, in order.
pub fn trials<'r>(
    plan: &Plan,
    records: &'r Records,
    role: Role,
) -> impl Iterator<Item = (&'r Sortie, &'r Landed)> {
    let duration_s = plan.duration_s;
    records.flights.iter().filter(move |(sortie, _)| {
        let is_trial = sortie.tier == Tier::Native && sortie.duration_s == duration_s;
        is_trial && sortie.role == role
    })
}

/// The pairs of a comparison, by cell and in the order of seeds.
#[must_use]
pub fn pairs<'r>(
    plan: &Plan,
    records: &'r Records,
    (of, against): (Role, Role),
) -> BTreeMap<[&'r str; 3], Vec<Pair<'r>>> {
    let mut cells = BTreeMap::<[&str; 3], Vec<Pair<'_>>>::new();
    for (sortie, first) in trials(plan, records, of) {
        if let Some(second) = records.flights.get(&sortie.with(against)) {
            cells
                .entry(sortie.cell())
                .or_default()
                .push((first, second));
        }
    }
    cells
}

impl Comparison {
    /// Compares every cell.
    #[must_use]
    pub fn over(self, plan: &Plan, records: &Records) -> Compared {
        let by_cell = pairs(plan, records, (self.of, self.against));
        let mut cells: Vec<Cell> = by_cell
            .iter()
            .map(|(cell, pairs)| one(*cell, pairs))
            .collect();
        cells.sort_by_key(|cell| plan.place([&cell.environment, &cell.airframe, &cell.logic]));
        let overall = Metric::ALL.into_iter().filter_map(|metric| {
            let seeds = by_cell.values().map(|pairs| {
                let values = pairs.iter().filter_map(|(of, against)| {
                    let percent = metric.improvement(&of.report, &against.report)?;
                    Some((of.job.sortie.seed, percent))
                });
                values.collect()
            });
            let seeds: Vec<Vec<(u32, f64)>> = seeds.collect();
            Some((metric, Interval::over_cells(&seeds)?))
        });
        Compared {
            comparison: self,
            improvement_percent: overall.collect(),
            cells,
        }
    }
}

fn one([environment, airframe, logic]: [&str; 3], pairs: &[Pair<'_>]) -> Cell {
    let crashes =
        |crashed: fn(&Pair<'_>) -> bool| pairs.iter().filter(|pair| crashed(pair)).count();
    let interval = |metric: Metric| Some((metric, improvement(metric, pairs)?));
    Cell {
        environment: environment.to_owned(),
        airframe: airframe.to_owned(),
        logic: logic.to_owned(),
        pairs: pairs.len(),
        crashes: [
            crashes(|pair| pair.0.report.crashed),
            crashes(|pair| pair.1.report.crashed),
        ],
        improvement_percent: Metric::ALL.into_iter().filter_map(interval).collect(),
    }
}

/// The improvement over some pairs; those in which somebody crashed have none.
#[must_use]
pub fn improvement(metric: Metric, pairs: &[Pair<'_>]) -> Option<Interval> {
    let values = pairs
        .iter()
        .filter_map(|(of, against)| metric.improvement(&of.report, &against.report));
    Interval::of(&values.collect::<Vec<f64>>())
}

//! Pairs of flights in the same wind, and how much better one is, cell by cell.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::journal::{Landed, Records};
use super::plan::{Plan, USUAL_HZ};
use super::role::Role;
use super::rule::{Contender, Rule};
use super::sortie::{CellName, Sortie, Tier};
use crate::closed_loop::report::FlightReport;
use crate::interval::Interval;

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

/// Which flights are compared with which, under the same seed, and where that is shown.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Comparison {
    /// Its name in tables and JSON.
    pub name: String,
    /// The role that is better or worse.
    pub of: Role,
    /// The role that it is better or worse than.
    pub against: Role,
    /// Its line in the headline, where it has one.
    #[serde(skip)]
    pub headline: Option<Shown>,
    /// Its row in the figures of improvements, where it has one.
    #[serde(skip)]
    pub figure: Option<Shown>,
}

/// How a part of the report shows a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Its place among the others there, from 1.
    pub place: u8,
    /// What is written of the other side.
    pub against: &'static str,
}

impl Comparison {
    fn new(name: impl Into<String>, of: Role, against: Role) -> Self {
        Self {
            name: name.into(),
            of,
            against,
            headline: None,
            figure: None,
        }
    }

    fn headline(mut self, place: u8, against: &'static str) -> Self {
        self.headline = Some(Shown { place, against });
        self
    }

    fn figure(mut self, place: u8, against: &'static str) -> Self {
        self.figure = Some(Shown { place, against });
        self
    }
}

const USUAL: Role = Role::Periodic(USUAL_HZ);
const HOVERING: [Role; 3] = [
    Role::Hovering(Contender::Reactive),
    Role::Hovering(Contender::Usual),
    Role::Hovering(Contender::EqualRuns),
];

/// Every comparison of the main part, in the order of the tables.
#[must_use]
pub fn comparisons() -> Vec<Comparison> {
    let [waypoints, hovering] = [over_waypoints().to_vec(), hovering().to_vec()];
    let tuned = Rule::ALL.into_iter().flat_map(at_equal_margins);
    waypoints.into_iter().chain(tuned).chain(hovering).collect()
}

fn over_waypoints() -> [Comparison; 4] {
    [
        Comparison::new("reactive against 400 Hz", Role::Reactive, USUAL)
            .headline(3, "Against periodic control at 400 Hz")
            .figure(1, "400 Hz"),
        Comparison::new(
            "reactive against periodic, equal runs",
            Role::Reactive,
            Role::EqualRuns,
        )
        .headline(1, "Against periodic control that runs as often")
        .figure(2, "equal runs"),
        Comparison::new(
            "reactive against periodic, equal processor time",
            Role::Reactive,
            Role::EqualTime,
        )
        .headline(
            2,
            "Against periodic control that takes as much processor time",
        )
        .figure(3, "equal time"),
        Comparison::new(
            "reactive without foresight against 400 Hz",
            Role::Unforeseen,
            USUAL,
        ),
    ]
}

/// Those with loops that a rule makes as fast as margins allow; one rule is in the headlines.
fn at_equal_margins(rule: Rule) -> Vec<Comparison> {
    let [reactive, usual, equal_runs] =
        [Contender::Reactive, Contender::Usual, Contender::EqualRuns]
            .map(|of| Role::Tuned(rule, of));
    let named = |what: &str| format!("at equal margins, {rule}: {what}");
    let compared = [
        Comparison::new(named("reactive against 400 Hz"), reactive, usual),
        Comparison::new(
            named("reactive against periodic, equal runs"),
            reactive,
            equal_runs,
        ),
        Comparison::new(
            named("reactive with faster loops against 400 Hz as configured"),
            reactive,
            USUAL,
        ),
    ];
    if rule != Rule::MIDDLE {
        return compared.into_iter().take(2).collect();
    }
    let [against_usual, against_equal_runs, against_configured] = compared;
    vec![
        against_usual
            .headline(
                5,
                "With loops as fast as equal margins allow, against periodic control at 400 Hz",
            )
            .figure(5, "400 Hz, equal margins"),
        against_equal_runs
            .headline(
                4,
                "With loops as fast as equal margins allow, against periodic control that runs as often",
            )
            .figure(4, "equal runs and margins"),
        against_configured.headline(
            6,
            "What spared runs can buy: reactive control with faster loops, against 400 Hz as configured",
        ),
    ]
}

fn hovering() -> [Comparison; 4] {
    [
    Comparison::new("hovering: reactive against 400 Hz", HOVERING[0], HOVERING[1])
        .headline(8, "Hovering, against periodic control at 400 Hz")
        .figure(6, "400 Hz, hovering"),
    Comparison::new(
        "hovering: reactive against periodic, equal runs",
        HOVERING[0],
        HOVERING[2],
    )
    .headline(7, "Hovering, against periodic control that runs as often")
    .figure(7, "equal runs, hovering"),
    Comparison::new(
        "hovering, what it can buy: reactive with a disturbance observer against 400 Hz without",
        Role::Observing(Contender::Reactive),
        HOVERING[1],
    )
    .headline(
        9,
        "What spared runs can buy, hovering: the cascade, reactive, with a disturbance observer, against 400 Hz without",
    ),
    Comparison::new(
        "hovering: 400 Hz with a disturbance observer against 400 Hz without",
        Role::Observing(Contender::Usual),
        HOVERING[1],
    )
    .headline(10, "The same observer at 400 Hz, against 400 Hz without"),
]
}

/// Comparisons that a part of the report shows, in its order, with what it calls the other side.
pub fn shown_in(
    compared: &[Compared],
    part: fn(&Comparison) -> Option<Shown>,
) -> Vec<(&Compared, &'static str)> {
    let shown = compared
        .iter()
        .filter_map(|it| Some((part(&it.comparison)?, it)));
    let mut shown: Vec<(Shown, &Compared)> = shown.collect();
    shown.sort_by_key(|(shown, _)| shown.place);
    let sides = shown.into_iter().map(|(shown, it)| (it, shown.against));
    sides.collect()
}

/// How two roles compare in one cell.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Cell {
    /// Environment, airframe and control logic.
    #[serde(flatten)]
    pub name: CellName,
    /// Pairs of flights that were flown.
    pub pairs: usize,
    /// Crashes of the first and of the second of each pair.
    pub crashes: [usize; 2],
    /// Improvement in % over pairs without a crash; positive is better.
    pub improvement_percent: BTreeMap<Metric, Interval>,
}

/// A comparison over all cells.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Compared {
    /// The two roles.
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
) -> BTreeMap<CellName, Vec<Pair<'r>>> {
    let mut cells = BTreeMap::<CellName, Vec<Pair<'_>>>::new();
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
            improvement_percent: overall.collect(),
            cells: cells(plan, records, (self.of, self.against)),
            comparison: self,
        }
    }
}

/// How two roles compare in every cell, in the plan's order.
#[must_use]
pub fn cells(plan: &Plan, records: &Records, roles: (Role, Role)) -> Vec<Cell> {
    let by_cell = pairs(plan, records, roles).into_iter();
    let mut cells: Vec<Cell> = by_cell.map(|(cell, pairs)| one(cell, &pairs)).collect();
    cells.sort_by_key(|cell| plan.place(&cell.name));
    cells
}

fn one(name: CellName, pairs: &[Pair<'_>]) -> Cell {
    let crashes =
        |crashed: fn(&Pair<'_>) -> bool| pairs.iter().filter(|pair| crashed(pair)).count();
    let interval = |metric: Metric| Some((metric, improvement(metric, pairs)?));
    Cell {
        name,
        pairs: pairs.len(),
        crashes: [
            crashes(|pair| pair.0.report.crashed),
            crashes(|pair| pair.1.report.crashed),
        ],
        improvement_percent: Metric::ALL.into_iter().filter_map(interval).collect(),
    }
}

/// The improvement over some pairs; those with a crash have none.
#[must_use]
pub fn improvement(metric: Metric, pairs: &[Pair<'_>]) -> Option<Interval> {
    let values = pairs
        .iter()
        .filter_map(|(of, against)| metric.improvement(&of.report, &against.report));
    Interval::of(&values.collect::<Vec<f64>>())
}

//! The findings of a campaign: every number of the report and of `--json`.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Serialize;

use super::comparison::{self, Compared, Metric, Pair, comparisons};
use super::journal::{Landed, Records, Ways};
use super::load::{self, Load, learning_share};
use super::plan::{Plan, USUAL_HZ};
use super::role::Role;
use super::sortie::{CellName, Sortie, Tier};
use super::tuning::{self, Tuning};
use crate::interval::Interval;

/// Everything, over the flights that have been flown so far.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Findings {
    /// Name of the plan.
    pub plan: String,
    /// Fingerprint of the sources that flew.
    pub sources: String,
    /// Seeds of the main comparison.
    pub seeds: u32,
    /// Seeds of the sweeps.
    pub sweep_seeds: u32,
    /// Simulated hours, by tier.
    pub hours: ByTier<f64>,
    /// Flights, by tier.
    pub flights: ByTier<usize>,
    /// Runs of the firmware, all of which gave the host's command bit by bit.
    pub equal_runs: u64,
    /// Flights that ended before their time, in words.
    pub crashes: Vec<String>,
    /// Flights of the plan.
    pub planned: usize,
    /// Flights of the plan that are not flown yet.
    pub missing: usize,
    /// Flights of the plan without a rate: the flight that decides it crashed.
    pub undecided: usize,
    /// Every comparison with its result.
    pub comparisons: Vec<Compared>,
    /// Reactive control with other settings against time-triggered control at 400 Hz.
    pub sweeps: Vec<Swept>,
    /// Time-triggered control at other rates against that at 400 Hz.
    pub rates: Vec<Swept>,
    /// How fast each policy may make its loops at equal margins.
    pub tunings: Vec<Tuning>,
    /// The means of each cell in each role.
    pub means: Vec<Means>,
    /// The processor's load.
    pub loads: Vec<Load>,
    /// Mean instructions of a run, by logic and way.
    pub ways: Vec<Ways>,
}

/// One value for each tier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ByTier<T> {
    /// The library alone.
    pub native: T,
    /// The firmware on the emulated board.
    pub emulated: T,
}

/// A setting of reactive control, and how much better than 400 Hz it is.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Swept {
    /// `p_run` or `failsafe_s`.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// Environment, airframe and so on.
    #[serde(flatten)]
    pub cell: comparison::Cell,
}

/// Means over the flights of one cell in one role.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Means {
    /// Environment, airframe and control logic.
    #[serde(flatten)]
    pub cell: CellName,
    /// When control runs.
    pub role: String,
    /// Flights.
    pub flights: usize,
    /// Those that ended before their time; they are in no mean.
    pub crashes: usize,
    /// Runs per second.
    pub rate_hz: Option<Interval>,
    /// Runs of a hundred whose command is within a quantum of the one before.
    pub unchanged_percent: Option<Interval>,
    /// Runs of a hundred that were time-triggered, to learn or because learning failed.
    pub learning_percent: Option<Interval>,
    /// Each metric in its unit: degrees, m, s.
    pub metrics: BTreeMap<Metric, Interval>,
}

impl Findings {
    /// The findings of a plan, over the flights that have been flown.
    #[must_use]
    pub fn of(plan: &Plan, records: &Records) -> Self {
        let planned = plan.part(None);
        let lacks = |sortie: &&Sortie| !records.flights.contains_key(*sortie);
        let undecided = planned
            .iter()
            .filter(lacks)
            .filter(|sortie| is_undecided(records, sortie));
        let undecided = undecided.count();
        let of_tier = |tier: Tier| {
            let flights = records.flights.values();
            flights.filter(move |landed| landed.job.sortie.tier == tier)
        };
        let hours = |tier| {
            of_tier(tier)
                .map(|landed| landed.report.duration_s)
                .sum::<f64>()
                / 3600.0
        };
        let per_second = |landed: &Landed| landed.report.control.per_second.clone();
        let runs = of_tier(Tier::Emulated).flat_map(per_second);
        let stamp = records.stamp.clone();
        Self {
            plan: plan.name.clone(),
            sources: stamp.map(|stamp| stamp.sources).unwrap_or_default(),
            seeds: plan.seeds,
            sweep_seeds: plan.sweep_seeds,
            hours: ByTier {
                native: hours(Tier::Native),
                emulated: hours(Tier::Emulated),
            },
            flights: ByTier {
                native: of_tier(Tier::Native).count(),
                emulated: of_tier(Tier::Emulated).count(),
            },
            equal_runs: runs.map(u64::from).sum(),
            crashes: records.flights.values().filter_map(crash).collect(),
            planned: planned.len(),
            missing: planned.iter().filter(lacks).count() - undecided,
            undecided,
            comparisons: comparisons()
                .into_iter()
                .map(|one| one.over(plan, records))
                .collect(),
            sweeps: sweeps(plan, records),
            rates: rates(plan, records),
            tunings: tuning::all(plan, records),
            means: means(plan, records),
            loads: load::all(plan, records),
            ways: records.ways.clone(),
        }
    }
}

/// Whether a flight waits for a rate that there will never be.
fn is_undecided(records: &Records, sortie: &Sortie) -> bool {
    let decided_by = sortie.role.decided_by();
    let decided_by = decided_by.and_then(|role| records.flights.get(&sortie.with(role)));
    decided_by.is_some_and(|landed| landed.report.control.rate_hz.is_none())
}

fn crash(landed: &Landed) -> Option<String> {
    let line = landed.report.crash_text()?;
    Some(format!("{}: {line}", landed.job.sortie))
}

/// Both sweeps with the value of `config/` among them, in the order of values.
fn sweeps(plan: &Plan, records: &Records) -> Vec<Swept> {
    let settings = reflex::config::SETTINGS;
    let p_runs = plan
        .p_runs
        .iter()
        .map(|value| (f64::from(*value) / 1e3, Role::PRun(*value)));
    let configured = (f64::from(settings.p_run) * 1e3).round() / 1e3;
    let p_runs = p_runs.chain([(configured, Role::Reactive)]);
    let failsafes = plan.failsafes.iter();
    let failsafes = failsafes.map(|value| (f64::from(*value) / 1e3, Role::Failsafe(*value)));
    let configured = settings.failsafe.ticks() as f64 / 1e6;
    let failsafes = failsafes.chain([(configured, Role::Reactive)]);
    let p_runs = p_runs.map(|(value, role)| ("p_run", value, role));
    let failsafes = failsafes.map(|(value, role)| ("failsafe_s", value, role));
    let settings = p_runs.chain(failsafes);
    let swept = settings.flat_map(|setting| {
        let cells = against_usual(plan, records, setting);
        cells.filter(|swept| swept.cell.name.logic == plan.sweep_logic)
    });
    in_order(swept.collect())
}

/// Time-triggered control at other rates against the usual one.
fn rates(plan: &Plan, records: &Records) -> Vec<Swept> {
    let rates = plan.rates_hz.iter().chain([&USUAL_HZ]);
    let swept = rates.flat_map(|hz| {
        let role = Role::Periodic(*hz);
        against_usual(plan, records, ("rate_hz", f64::from(*hz), role))
    });
    in_order(swept.collect())
}

/// Every cell of one value of a setting.
fn against_usual(
    plan: &Plan,
    records: &Records,
    (parameter, value, role): (&'static str, f64, Role),
) -> impl Iterator<Item = Swept> {
    let cells = comparison::cells(plan, records, (role, Role::Periodic(USUAL_HZ))).into_iter();
    cells.map(move |cell| Swept {
        parameter,
        value,
        cell,
    })
}

fn in_order(mut swept: Vec<Swept>) -> Vec<Swept> {
    swept.sort_by(|one, other| {
        let parameters = other.parameter.cmp(one.parameter);
        parameters.then(one.value.total_cmp(&other.value))
    });
    swept
}

/// Every cell in every role that is compared, or that error is traded for runs in.
fn means(plan: &Plan, records: &Records) -> Vec<Means> {
    let trade = &plan.trade;
    let traded = trade.bandwidths.iter().flat_map(|it| trade.roles(*it));
    let roles: BTreeSet<Role> = comparisons()
        .into_iter()
        .flat_map(|it| [it.of, it.against])
        .chain(traded)
        .collect();
    let of_role = |role| {
        let cells = comparison::pairs(plan, records, (role, role));
        let means = cells
            .into_iter()
            .map(|(cell, pairs)| mean(cell, role, &pairs));
        means.collect::<Vec<Means>>()
    };
    let mut means: Vec<Means> = roles.into_iter().flat_map(of_role).collect();
    means.sort_by_key(|one| plan.place(&one.cell));
    means
}

fn mean(cell: CellName, role: Role, flights: &[Pair<'_>]) -> Means {
    let of = |value: &dyn Fn(&Landed) -> Option<f64>| {
        let values = flights.iter().filter_map(|(landed, _)| value(landed));
        Interval::of(&values.collect::<Vec<f64>>())
    };
    let metrics = Metric::ALL
        .into_iter()
        .filter_map(|metric| Some((metric, of(&|landed| metric.value(&landed.report))?)));
    Means {
        cell,
        role: role.to_string(),
        flights: flights.len(),
        crashes: flights
            .iter()
            .filter(|(landed, _)| landed.report.crashed)
            .count(),
        rate_hz: of(&|landed| landed.report.control.rate_hz),
        unchanged_percent: of(&|landed| {
            let report = &landed.report;
            let share = report.control.unchanged_share.filter(|_| !report.crashed);
            share.map(|share| 100.0 * share)
        }),
        learning_percent: of(&|landed| Some(100.0 * learning_share(&landed.report)?)),
        metrics: metrics.collect(),
    }
}

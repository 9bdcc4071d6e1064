//! Error over runs, and load over error: two figures that the paper has not.

use anyhow::Result;

use super::Shown;
use super::bars::COLOURS;
use super::figures::svg;
use crate::campaign::comparison::Metric;
use crate::campaign::findings::{Findings, Means};
use crate::campaign::load::Load;
use crate::campaign::plan::Plan;
use crate::campaign::role::{Pace, Role};
use crate::plot::{Axis, Curve, Look, Marker, Panel, Point, Scale};

/// What one policy flew with loops of one bandwidth, in the order of its budgets or rates.
struct Paces<'f> {
    bandwidth: u32,
    is_reactive: bool,
    means: Vec<&'f Means>,
}

/// Both, where error was traded for runs; else none.
///
/// # Errors
/// None in practice: nothing is written but strings.
pub fn figures(plan: &Plan, findings: &Findings) -> Result<Vec<Shown>> {
    if plan.trade.bandwidths.is_empty() {
        return Ok(Vec::new());
    }
    let mut shown = vec![error_over_runs(plan, findings)?];
    // Without the emulated board nobody knows the load.
    if !findings.loads.is_empty() {
        shown.push(load_over_error(plan, findings)?);
    }
    Ok(shown)
}

fn error_over_runs(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let panels = each_cell(plan, |title, names| Panel {
        title,
        x: Axis::new("runs per second", Scale::Logarithmic),
        y: Axis::new("attitude error, degrees", Scale::Logarithmic),
        curves: curves(plan, findings, names, &|means, _| {
            Some(Point {
                x: means.rate_hz?.mean,
                y: error(means)?,
                ..Point::default()
            })
        }),
    });
    let title = "Attitude error over runs per second";
    Ok(Shown {
        file: "error_over_runs",
        number: "",
        title,
        svg: svg(plan, title, panels)?,
        ours: format!(
            "{WHO} Budgets of {} ms; rates of {} Hz. Means over seeds; what crashed is left out. \
             Seeds differ by their winds, in which all curves of a panel move together: intervals between \
             seeds would say little.",
            listed(plan.trade.budgets_us.iter().map(|us| f64::from(*us) / 1e3)),
            listed(plan.trade.rates_hz.iter().map(|hz| f64::from(*hz))),
        ),
        paper: NONE,
    })
}

fn load_over_error(plan: &Plan, findings: &Findings) -> Result<Shown> {
    let panels = each_cell(plan, |title, names| Panel {
        title,
        x: Axis::new("attitude error, degrees", Scale::Logarithmic),
        y: Axis::new("busy share of the processor, %", Scale::FromZero),
        curves: curves(plan, findings, names, &|means, is_reactive| {
            let load = findings.loads.iter().find(|load| load.cell.is(names))?;
            Some(Point {
                x: error(means)?,
                y: 100.0 * busy(load, is_reactive, means.rate_hz?.mean)?,
                ..Point::default()
            })
        }),
    });
    let title = "Busy share of the processor over attitude error";
    Ok(Shown {
        file: "load_over_error",
        number: "",
        title,
        svg: svg(plan, title, panels)?,
        ours: format!(
            "{WHO} Errors are those of the native flights. The load is that of a line through two flights of \
             the cell on the emulated board, each policy's own: reactive control with the default budget and \
             the finest, time-triggered control at 100 and 400 Hz."
        ),
        paper: NONE,
    })
}

const WHO: &str = "Loops of one to three times the configured bandwidth (colours), by reactive control with \
                   several budgets (circles) and by time-triggered control at several rates (triangles).";
const NONE: &str = "it has no such figure.";

/// A panel for each environment, a row of all logics.
fn each_cell(plan: &Plan, panel: impl Fn(String, [&str; 3]) -> Panel) -> Vec<Panel> {
    let airframe = plan.airframes.first().map_or("", String::as_str);
    let panel = &panel;
    let rows = plan.environments.iter().flat_map(|environment| {
        let logics = plan.logics.iter();
        logics.map(move |logic| {
            panel(
                format!("{logic} in {environment}"),
                [environment, airframe, logic],
            )
        })
    });
    rows.collect()
}

fn curves(
    plan: &Plan,
    findings: &Findings,
    names: [&str; 3],
    place: &dyn Fn(&Means, bool) -> Option<Point>,
) -> Vec<Curve> {
    let paces = paces(plan, findings, names);
    let curves = paces.iter().map(|paces| Curve {
        look: look(plan, paces),
        points: paces
            .means
            .iter()
            .filter_map(|means| place(means, paces.is_reactive))
            .collect(),
    });
    curves.collect()
}

fn paces<'f>(plan: &Plan, findings: &'f Findings, names: [&str; 3]) -> Vec<Paces<'f>> {
    let here = |role: Role| {
        let mut means = findings.means.iter();
        means.find(|one| one.role == role.to_string() && one.cell.is(names))
    };
    let bandwidths = plan.trade.bandwidths.iter();
    let both = bandwidths.flat_map(|percent| {
        [true, false].map(|is_reactive| Paces {
            bandwidth: *percent,
            is_reactive,
            means: plan
                .trade
                .roles(*percent)
                .filter(|role| matches!(role, Role::Traded(_, Pace::Budget(_))) == is_reactive)
                .filter_map(here)
                .collect(),
        })
    });
    both.collect()
}

fn look(plan: &Plan, paces: &Paces<'_>) -> Look {
    let mut bandwidths = plan.trade.bandwidths.iter();
    let kind = bandwidths.position(|it| *it == paces.bandwidth);
    let (policy, marker) = match paces.is_reactive {
        true => ("reactive", Marker::Circle),
        false => ("periodic", Marker::Triangle),
    };
    Look {
        name: format!("{policy}, {} x", f64::from(paces.bandwidth) / 100.0),
        colour: COLOURS[kind.unwrap_or_default() % COLOURS.len()],
        marker,
        width: 2,
    }
}

fn error(means: &Means) -> Option<f64> {
    Some(means.metrics.get(&Metric::Attitude)?.mean)
}

fn busy(load: &Load, is_reactive: bool, rate_hz: f64) -> Option<f64> {
    let policy = if is_reactive {
        load.reactive?
    } else {
        load.periodic
    };
    Some(policy.busy(rate_hz))
}

fn listed(values: impl Iterator<Item = f64>) -> String {
    let texts: Vec<String> = values.map(|value| value.to_string()).collect();
    texts.join(", ")
}

//! The trade curve of a sweep beside its two baselines, as a figure.

use std::path::Path;

use super::grid::{Axis as GridAxis, Grid, Parameter};
use super::outcome::Outcome;
use super::report::{At, SweepReport};
use super::table::rounded;
use crate::plot::{Axis, Curve, Figure, Look, Marker, Panel, Point, Scale};

/// Panels beside each other: as many as a window is wide.
const COLUMNS: usize = 2;

/// A baseline's or the policy's curve: its name, its colour, its marker.
type Kind = (&'static str, (u8, u8, u8), Marker);
const REACTIVE: Kind = ("reactive", (0, 90, 160), Marker::Circle);
const PERIODIC: Kind = ("periodic, equal runs", (213, 94, 0), Marker::Triangle);
const ORACLE: Kind = ("oracle, equal runs", (0, 145, 105), Marker::Square);

/// The figure: medians over all logs first, where there are several, then a panel for each.
///
/// The line of reactive control goes through the values of `p-run`, or of the first parameter
/// that has several; each combination of the others has its own, the lighter the later.
#[must_use]
pub fn trade_curves(report: &SweepReport) -> Figure {
    let mut panels: Vec<Panel> = report
        .by_log()
        .map(|points| {
            let rows = points.iter().map(|point| (point.at, point.outcome()));
            let log = points.first().map_or("", |first| &first.log);
            let name = Path::new(log).file_name().unwrap_or_default();
            let mut title = name.to_string_lossy().into_owned();
            if !points.iter().any(|point| point.score.scored) {
                title += " (not scored)";
            }
            panel(report, title, rows.collect())
        })
        .collect();
    if panels.len() > 1 {
        let most = report.medians.iter().map(|median| median.logs).max();
        let title = format!("median over {} scored logs", most.unwrap_or(0));
        let rows = report.medians.iter().map(|one| (one.at, one.outcome));
        panels.insert(0, panel(report, title, rows.collect()));
    }
    Figure {
        title: title(report),
        panels,
        columns: COLUMNS,
    }
}

/// What was swept, and the two settings that say most about the rest.
fn title(report: &SweepReport) -> String {
    let mut title = format!("Trade curve, {}", report.grid);
    for parameter in Parameter::ALL {
        if !report.grid.names(parameter) {
            let value = rounded(parameter.value(&report.base));
            title += &format!(", {} {value}", parameter.name());
        }
    }
    title
}

fn panel(report: &SweepReport, title: String, rows: Vec<(At, Outcome)>) -> Panel {
    let curve_axis = curve_axis(&report.grid);
    let groups = groups(&report.grid, curve_axis, &rows);
    let mut curves = Vec::new();
    for (place, group) in groups.iter().enumerate() {
        let shade = place as f64 / groups.len() as f64;
        curves.extend(group_curves(report, curve_axis, group, shade));
    }
    Panel {
        title,
        x: Axis::new("runs per second", Scale::Logarithmic),
        y: Axis::new(
            format!(
                "RMS deviation, quanta of {} of full scale",
                rounded(report.unit)
            ),
            Scale::FromZero,
        ),
        curves,
    }
}

/// The parameter whose values a line goes through.
fn curve_axis(grid: &Grid) -> Parameter {
    let varied = |axis: &&GridAxis| axis.values().len() > 1;
    let axes = grid.axes();
    let p_run = axes
        .iter()
        .filter(varied)
        .find(|axis| axis.parameter() == Parameter::PRun);
    let first = || axes.iter().find(varied).or(axes.first());
    p_run
        .or_else(first)
        .map_or(Parameter::PRun, GridAxis::parameter)
}

/// Rows that differ in the curve's parameter only, in the grid's order.
fn groups(grid: &Grid, curve: Parameter, rows: &[(At, Outcome)]) -> Vec<Vec<(At, Outcome)>> {
    let others = |at: &At| -> Vec<f64> {
        let axes = grid.axes().iter().map(GridAxis::parameter);
        axes.filter(|parameter| *parameter != curve)
            .map(|parameter| at.value(parameter))
            .collect()
    };
    let mut groups: Vec<Vec<(At, Outcome)>> = Vec::new();
    for row in rows {
        let own = groups.iter_mut().find(|group| {
            let first = group.first();
            first.is_some_and(|(at, _)| others(at) == others(&row.0))
        });
        match own {
            Some(group) => group.push(*row),
            None => groups.push(vec![*row]),
        }
    }
    groups
}

fn group_curves(
    report: &SweepReport,
    curve: Parameter,
    group: &[(At, Outcome)],
    shade: f64,
) -> [Curve; 3] {
    let scaled = || {
        group
            .iter()
            .map(|(at, outcome)| (at, outcome.scaled(at.quantum / report.unit)))
    };
    let last = group.len().saturating_sub(1);
    let reactive = scaled().enumerate().filter_map(|(place, (at, outcome))| {
        let label = label(&report.grid, curve, at, place == last);
        point(
            outcome.runs_per_s,
            outcome.rms_deviation_quanta,
            Some(label),
        )
    });
    let periodic = scaled().filter_map(|(_, outcome)| {
        point(
            outcome.periodic_runs_per_s,
            outcome.periodic_rms_quanta,
            None,
        )
    });
    let oracle = scaled().filter_map(|(_, outcome)| {
        point(outcome.oracle_runs_per_s, outcome.oracle_rms_quanta, None)
    });
    // What a baseline does depends on its runs alone, so its line goes from few to many.
    let sorted = |points: &mut dyn Iterator<Item = Point>| {
        let mut points: Vec<Point> = points.collect();
        points.sort_by(|one, other| one.x.total_cmp(&other.x));
        points
    };
    [
        curve_of(REACTIVE, 3, shade, reactive.collect()),
        curve_of(PERIODIC, 2, shade, sorted(&mut { periodic })),
        curve_of(ORACLE, 2, shade, sorted(&mut { oracle })),
    ]
}

/// The value at a point, the others' too at the end of a line of several.
fn label(grid: &Grid, curve: Parameter, at: &At, is_last: bool) -> String {
    let mut label = rounded(at.value(curve));
    if is_last {
        let varied = grid.axes().iter().filter(|axis| axis.values().len() > 1);
        for parameter in varied.map(GridAxis::parameter) {
            if parameter != curve {
                let value = rounded(at.value(parameter));
                label += &format!(", {} {value}", parameter.name());
            }
        }
    }
    label
}

fn curve_of((name, colour, marker): Kind, width: u32, shade: f64, points: Vec<Point>) -> Curve {
    // Never more than two thirds of the way to white: paper is white too.
    let lighter = |part: u8| (f64::from(part) + (255.0 - f64::from(part)) * shade * 0.66) as u8;
    let (red, green, blue) = colour;
    Curve {
        look: Look {
            name: name.to_owned(),
            colour: (lighter(red), lighter(green), lighter(blue)),
            marker,
            width,
        },
        points,
    }
}

fn point(x: Option<f64>, y: Option<f64>, label: Option<String>) -> Option<Point> {
    let (x, y) = x.zip(y)?;
    let interval = None;
    Some(Point {
        x,
        y,
        label,
        interval,
    })
}

//! The result of a tuning as a page: what pays, what trades, what was learned.

use anyhow::Result;
use maud::{Markup, PreEscaped, html};

use super::curves::Learned;
use super::report::{Configured, TuneReport};
use super::table::{cells, heading, legend, trades, verdict};
use super::tried::Tried;
use crate::page;
use crate::plot::{Axis, Curve, Figure, Look, Marker, Panel, Point, Scale};
use crate::scoring::or_dash;

/// Points of a model's line.
const STEPS: u32 = 120;
const VALUES: (u8, u8, u8) = (0, 114, 178);
const PAYS: (u8, u8, u8) = (0, 158, 115);
const MODEL: (u8, u8, u8) = (213, 94, 0);
const THRESHOLD: (u8, u8, u8) = (90, 90, 90);

/// The page; its figures are within it.
///
/// # Errors
/// None in practice: nothing is written but a string.
pub fn page(report: &TuneReport) -> Result<String> {
    let trade = trade(report).to_svg()?;
    let learned = learned(&report.inputs).to_svg()?;
    let body = html! {
        h1 { "What other settings would change" }
        (proposed(report))
        h2 { "Flights, as configured" }
        (logs(&report.logs))
        @for skipped in &report.skipped {
            p class="warning" { "left out: " (skipped.log) ": " (skipped.reason) }
        }
        h2 { "Every value that was tried" }
        p { (heading(report)) }
        (values(&report.values))
        p { (legend(report)) }
        figure {
            // Drawn by this program, whose figures escape what they are given.
            (PreEscaped(&trade))
            figcaption { "Down and to the left is better: fewer runs, and less straying. Bars are intervals." }
        }
        h2 { "What inputs learned, by the end of the longest flight" }
        figure {
            (PreEscaped(&learned))
            figcaption {
                "Of changes of an input, how often the command was another; the model through them, and the \
                 change above which it asks for a run."
            }
        }
    };
    Ok(page::page("Reflex: tuning", &body))
}

fn proposed(report: &TuneReport) -> Markup {
    html! {
        @match &report.proposal {
            Some(proposal) => {
                p { "Proposed: " strong { (proposal.value) " = " (proposal.to) } " in place of " (proposal.from) "." }
                pre { (proposal.diff) }
            }
            None => p { "No other value surely pays on these flights." }
        }
        ul { @for sentence in trades(report) { li { (sentence) } } }
    }
}

fn logs(logs: &[Configured]) -> Markup {
    html! {
        table {
            tr {
                th class="name" { "log" } th { "scored, s" } th { "runs/s" } th { "strayed, quanta" }
                th { "periodic at as many runs" } th { "load, %" }
            }
            @for log in logs {
                tr {
                    td class="name" { (log.log) @if !log.scored { " (not scored)" } }
                    td { (format!("{:.1}", log.scored_s)) }
                    td { (or_dash(log.runs_per_s, 1)) }
                    td { (or_dash(log.strayed_quanta, 3)) }
                    td { (or_dash(log.periodic_strayed_quanta, 3)) }
                    td { (or_dash(log.load.map(|share| 100.0 * share), 2)) }
                }
            }
        }
    }
}

fn values(values: &[Tried]) -> Markup {
    html! {
        table {
            tr {
                th class="name" { "value" } th { "from" } th { "to" } th { "runs/s" } th { "interval" }
                th { "strayed" } th { "interval" } th { "" }
            }
            @for tried in values {
                @let (runs, runs_interval) = cells(tried.runs);
                @let (strayed, strayed_interval) = cells(tried.strayed);
                tr {
                    td class="name" { (tried.path()) } td { (tried.from) } td { (tried.to) }
                    td { (runs) } td { (runs_interval) } td { (strayed) } td { (strayed_interval) }
                    td class=[tried.pays.then_some("better")] { (verdict(tried)) }
                }
            }
        }
    }
}

fn look(name: &str, colour: (u8, u8, u8), marker: Marker, width: u32) -> Look {
    Look {
        name: name.to_owned(),
        colour,
        marker,
        width,
    }
}

/// Runs against straying, a point for each value.
fn trade(report: &TuneReport) -> Figure {
    let points = |pays: bool| -> Vec<Point> {
        let of = report.values.iter().filter(|tried| tried.pays == pays);
        of.filter_map(|tried| {
            let strayed = tried.strayed?;
            Some(Point {
                x: tried.runs?.percent,
                y: strayed.percent,
                // Where nothing is sure, labels would lie on each other.
                label: tried
                    .is_sure()
                    .then(|| format!("{} {}", tried.key, tried.to)),
                interval: strayed
                    .from_percent
                    .zip(strayed.to_percent)
                    .map(|(from, to)| [from, to]),
            })
        })
        .collect()
    };
    let origin = Point::default();
    Figure {
        title: "Each value against the configuration".to_owned(),
        panels: vec![Panel {
            title: String::new(),
            x: Axis::new("change of runs per second, %", Scale::Linear),
            y: Axis::new("change of straying, %", Scale::Linear),
            curves: vec![
                Curve {
                    look: look("as configured", THRESHOLD, Marker::Square, 0),
                    points: vec![origin],
                },
                Curve {
                    look: look("pays", PAYS, Marker::Triangle, 0),
                    points: points(true),
                },
                Curve {
                    look: look("other values", VALUES, Marker::Circle, 0),
                    points: points(false),
                },
            ],
        }],
        columns: 1,
    }
}

/// Labels, model and threshold of each input.
fn learned(inputs: &[Learned]) -> Figure {
    Figure {
        title: "Probability of another command".to_owned(),
        panels: inputs.iter().map(panel).collect(),
        columns: 2,
    }
}

fn panel(learned: &Learned) -> Panel {
    let changes = || {
        learned
            .bins
            .iter()
            .map(|bin| bin.change)
            .filter(|change| *change > 0.0)
    };
    let low = changes().fold(f64::INFINITY, f64::min);
    let high = changes().fold(0.0, f64::max);
    let at = |x: f64, y: f64| Point {
        x,
        y,
        ..Point::default()
    };
    let steps = (0..=STEPS).map(|step| low * (high / low).powf(f64::from(step) / f64::from(STEPS)));
    let model = steps.filter_map(|change| Some(at(change, learned.probability(change)?)));
    let labels = learned.bins.iter().map(|bin| at(bin.change, bin.share()));
    let threshold = learned.threshold.into_iter();
    let threshold = threshold.flat_map(|change| [at(change, 0.0), at(change, 1.0)]);
    Panel {
        title: learned.input.clone(),
        x: Axis::new(format!("change, {}", learned.unit), Scale::Logarithmic),
        y: Axis::new("share, probability", Scale::FromZero),
        curves: vec![
            Curve {
                look: look("labels", VALUES, Marker::Circle, 0),
                points: labels.collect(),
            },
            Curve {
                look: look("model", MODEL, Marker::None, 2),
                points: model.collect(),
            },
            Curve {
                look: look("threshold", THRESHOLD, Marker::None, 1),
                points: threshold.collect(),
            },
        ],
    }
}

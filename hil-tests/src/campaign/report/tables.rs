//! Tables: every environment, airframe and logic.

use maud::{Markup, html};

use crate::campaign::comparison::{Cell, Compared, Metric};
use crate::campaign::findings::{Findings, Means};
use crate::campaign::margins;
use crate::campaign::plan::Plan;
use crate::campaign::sortie::CellName;
use crate::interval::Interval;

/// What the table of improvements has columns of.
const SHOWN: [Metric; 5] = [
    Metric::Attitude,
    Metric::Pitch,
    Metric::Roll,
    Metric::Yaw,
    Metric::FlightTime,
];

/// All tables.
pub fn section(plan: &Plan, findings: &Findings) -> Markup {
    html! {
        h2 { "Every environment, airframe and control logic" }
        p {
            "Improvement in %, mean ± half of the 95 % interval over pairs of one seed in which nobody "
            "crashed; crashes of either side beside it."
        }
        @for compared in &findings.comparisons {
            @if !compared.cells.is_empty() {
                h3 { (compared.comparison.name) }
                (improvements(compared))
            }
        }
        h3 { "What each cell comes to" }
        p {
            "Learning: runs in the scored part that were time-triggered, because reactive control had not yet "
            "learned or no longer trusted what it had. Unchanged: no motor's command differs by a quantum from "
            "that of the run before."
        }
        details {
            summary { "All of them" }
            (means(&findings.means))
        }
        (loads(plan, findings))
        @if !findings.tunings.is_empty() { (tunings(plan, findings)) }
    }
}

fn tunings(plan: &Plan, findings: &Findings) -> Markup {
    let mut tunings: Vec<_> = findings.tunings.iter().collect();
    tunings.sort_by_key(|it| plan.place(&it.cell));
    html! {
        @let [slowest, fastest] = margins::BANDWIDTHS;
        h3 { "Loops at equal margins" }
        p {
            "How fast each policy may make attitude and rate loops, in % of the configured bandwidth: the "
            "fastest from " (slowest) " to " (fastest) " that, with all slower ones, keeps the drone from "
            "turning more than a limit when it answers its motors twice as strongly, and when commands apply "
            "late. A rule is that delay with that limit, RMS."
        }
        table {
            tr { (names_head()) th class="name" { "control" } th { "bandwidth, %" } }
            @for it in tunings {
                tr {
                    (names(&it.cell))
                    td class="name" { (it.role) }
                    td { (it.bandwidth_percent) }
                }
            }
        }
    }
}

fn improvements(compared: &Compared) -> Markup {
    html! {
        table {
            tr {
                (names_head())
                @for metric in SHOWN { th { (metric.name()) } }
                th { "pairs" } th { "crashes" }
            }
            @for cell in &compared.cells {
                tr {
                    (names(&cell.name))
                    @for metric in SHOWN { (improvement(cell, metric)) }
                    td { (cell.pairs) }
                    td { (cell.crashes[0]) " : " (cell.crashes[1]) }
                }
            }
        }
    }
}

fn improvement(cell: &Cell, metric: Metric) -> Markup {
    let Some(interval) = cell.improvement_percent.get(&metric) else {
        return html! { td { "–" } };
    };
    let [low, high] = interval.ends();
    let class = match (interval.half_width, low > 0.0, high < 0.0) {
        (Some(_), true, _) => "better",
        (Some(_), _, true) => "worse",
        _ => "",
    };
    html! { td class=(class) { (signed(interval)) } }
}

fn means(means: &[Means]) -> Markup {
    html! {
        table {
            tr {
                (names_head())
                th { "runs/s" } th { "learning, %" } th { "unchanged, %" }
                th { "roll error, °" } th { "pitch error, °" } th { "yaw error, °" }
                th { "position error, m" } th { "flight time, min" } th { "flights" } th { "crashes" }
            }
            @for one in means {
                tr {
                    (names(&one.cell))
                    td class="name" { (one.role) }
                    td { (plain(one.rate_hz.as_ref(), 1.0, 1)) }
                    td { (plain(one.learning_percent.as_ref(), 1.0, 1)) }
                    td { (plain(one.unchanged_percent.as_ref(), 1.0, 1)) }
                    @for (metric, digits) in [(Metric::Roll, 3), (Metric::Pitch, 3), (Metric::Yaw, 3), (Metric::Position, 3)] {
                        td { (plain(one.metrics.get(&metric), 1.0, digits)) }
                    }
                    td { (plain(one.metrics.get(&Metric::FlightTime), 60.0, 2)) }
                    td { (one.flights) } td { (one.crashes) }
                }
            }
        }
    }
}

fn loads(plan: &Plan, findings: &Findings) -> Markup {
    let mut loads: Vec<_> = findings.loads.iter().collect();
    loads.sort_by_key(|load| plan.place(&load.cell));
    html! {
        h3 { "Processor time" }
        p {
            "Of the firmware on the emulated board at 168 MHz, an instruction a cycle. Time-triggered control "
            "is busy for a + c · rate, through flights at 100 and 400 Hz; at the rate of equal time it is as "
            "busy as reactive control. Where that lies beyond 11 to 1000 Hz, the nearest is flown."
        }
        table {
            tr {
                (names_head())
                th { "runs/s" } th { "learning, %" } th { "busy, %" } th { "a, %" } th { "c, us a run" }
                th { "equal time, Hz" } th { "flown, Hz" }
            }
            @for load in loads {
                tr {
                    (names(&load.cell))
                    td { (format!("{:.1}", load.rate_hz)) }
                    td { (format!("{:.1}", 100.0 * load.learning)) }
                    td { (format!("{:.2}", 100.0 * load.busy)) }
                    td { (format!("{:.2}", 100.0 * load.periodic.idle)) }
                    td { (format!("{:.1}", 1e6 * load.periodic.per_run_s)) }
                    td { (format!("{:.1}", load.equal_time_hz)) }
                    td {
                        (format!("{:.1}", load.flown_hz))
                        @if load.is_clamped() { " (limit)" }
                    }
                }
            }
        }
    }
}

fn names_head() -> Markup {
    html! { th class="name" { "environment" } th class="name" { "airframe" } th class="name" { "logic" } }
}

fn names(cell: &CellName) -> Markup {
    html! {
        @for name in [&cell.environment, &cell.airframe, &cell.logic] { td class="name" { (name) } }
    }
}

fn signed(interval: &Interval) -> String {
    let mean = percent(interval.mean);
    match interval.half_width {
        Some(half) => format!("{mean} ± {half:.2}"),
        None => mean,
    }
}

/// A number with its sign; what rounds to zero has none.
pub fn percent(value: f64) -> String {
    let text = format!("{value:+.2}");
    if text
        .trim_start_matches(['+', '-'])
        .chars()
        .all(|c| matches!(c, '0' | '.'))
    {
        return text[1..].to_owned();
    }
    text
}

fn plain(interval: Option<&Interval>, unit: f64, digits: usize) -> String {
    let Some(interval) = interval else {
        return "–".to_owned();
    };
    let mean = interval.mean / unit;
    match interval.half_width {
        Some(half) => format!("{mean:.digits$} ± {:.digits$}", half / unit),
        None => format!("{mean:.digits$}"),
    }
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        for (value, text) in [
            (1.25, "+1.25"),
            (-0.004, "0.00"),
            (0.004, "0.00"),
            (-0.04, "-0.04"),
            (0.0, "0.00"),
        ] {
            assert_eq!(percent(value), text);
        }
    }
}

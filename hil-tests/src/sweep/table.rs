//! A sweep as text: one table for each log, and one over all of them.

use super::grid::Axis;
use super::outcome::Outcome;
use super::report::{At, SweepReport};
use crate::scoring::{MOST_SATURATED, Table, or_dash};

/// The report for a person; a dash stands for what has no value.
///
/// With a single log there is no table over all.
#[must_use]
pub fn tables(report: &SweepReport) -> String {
    let mut text = heading(report);
    let mut logs = 0;
    for points in report.by_log() {
        let Some(first) = points.first() else {
            continue;
        };
        logs += 1;
        text += &format!("\n{}: {:.1} s", first.log, first.score.duration_s);
        if points.iter().any(|point| !point.score.scored) {
            text += &format!(
                ", not scored where nothing is left after warm-up or some command sits at a limit \
                 in over {:.0} % of hyperperiods",
                100.0 * MOST_SATURATED
            );
        }
        let rows = points.iter().map(|point| (&point.at, point.outcome()));
        text += &format!("\n{}", table(report, rows));
    }
    if logs > 1 {
        let most = report.medians.iter().map(|median| median.logs).max();
        text += &format!("\nmedian over {} scored logs\n", most.unwrap_or(0));
        let rows = report.medians.iter().map(|one| (&one.at, one.outcome));
        text += &table(report, rows).to_string();
    }
    text
}

fn heading(report: &SweepReport) -> String {
    let mut text = format!(
        "sweep {}: reactive control, and as many runs by the clock and by the oracle\n",
        report.grid
    );
    text += &format!(
        "RMS deviations in quanta of {} of full scale, seed {}\n",
        rounded(report.unit),
        report.base.seed
    );
    for skipped in &report.skipped {
        text += &format!("skipped {}: {}\n", skipped.log, skipped.reason);
    }
    text
}

fn table<'r>(report: &SweepReport, rows: impl Iterator<Item = (&'r At, Outcome)>) -> Table {
    let mut table = Table::new([
        "point",
        "runs/s",
        "stale %",
        "RMS quanta",
        "periodic",
        "oracle",
        "x periodic",
        "x oracle",
        "false positive %",
        "failsafe changed %",
    ]);
    for (at, outcome) in rows {
        let outcome = outcome.scaled(at.quantum / report.unit);
        let percent = |share: Option<f64>| or_dash(share.map(|share| 100.0 * share), 1);
        table.row([
            point(report.grid.axes(), at),
            or_dash(outcome.runs_per_s, 1),
            percent(outcome.stale_fraction),
            or_dash(outcome.rms_deviation_quanta, 3),
            or_dash(outcome.periodic_rms_quanta, 3),
            or_dash(outcome.oracle_rms_quanta, 3),
            or_dash(outcome.ratio_to_periodic, 2),
            or_dash(outcome.ratio_to_oracle, 2),
            percent(outcome.false_positive_share),
            percent(outcome.failsafe_changed_share),
        ]);
    }
    table
}

/// The place in the grid: `p-run 0.2, failsafe 0.1`.
fn point(axes: &[Axis], at: &At) -> String {
    let parts = axes.iter().map(|axis| {
        let value = at.value(axis.parameter());
        format!("{} {}", axis.parameter().name(), rounded(value))
    });
    parts.collect::<Vec<_>>().join(", ")
}

/// A value in three significant digits.
pub(super) fn rounded(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    rounded.to_string()
}

//! The result of a tuning as text: tables, the proposal, and how much to believe.

use super::effect::{Effect, PairedBy};
use super::report::{Trade, TuneReport, Wish};
use super::tried::Tried;
use crate::scoring::{Table, or_dash};

/// The report for a person; a dash stands for what has no value.
#[must_use]
pub fn summary(report: &TuneReport) -> String {
    [
        logs(report),
        format!("{}\n", heading(report)),
        values(&report.values),
        legend(report),
        proposed(report),
    ]
    .join("\n")
        + &trades(report)
            .into_iter()
            .map(|line| line + "\n")
            .collect::<String>()
}

fn logs(report: &TuneReport) -> String {
    let header = [
        "as configured",
        "scored s",
        "runs/s",
        "strayed",
        "periodic",
        "load %",
    ];
    let mut table = Table::new(header);
    for log in &report.logs {
        let name = match log.scored {
            true => log.log.clone(),
            false => format!("{} (not scored)", log.log),
        };
        table.row([
            name,
            format!("{:.1}", log.scored_s),
            or_dash(log.runs_per_s, 1),
            or_dash(log.strayed_quanta, 3),
            or_dash(log.periodic_strayed_quanta, 3),
            or_dash(log.load.map(|share| 100.0 * share), 2),
        ]);
    }
    let skipped = report.skipped.iter();
    let skipped = skipped.map(|skipped| format!("left out: {}: {}\n", skipped.log, skipped.reason));
    format!("{table}{}", skipped.collect::<String>())
}

/// What the effects are of.
pub(super) fn heading(report: &TuneReport) -> String {
    let logs = report.scored_logs();
    let count = match logs {
        1 => "one scored log".to_owned(),
        count => format!("{count} scored logs"),
    };
    match report.paired_by {
        PairedBy::Log => format!("change in %, paired by log, over {count}:"),
        PairedBy::Window => format!(
            "change in %, paired by windows of 10 s of {count}: how even it is here, not how it \
             would be in other flights; give a folder with three logs or more for that:"
        ),
    }
}

fn values(values: &[Tried]) -> String {
    let header = [
        "value", "from", "to", "runs/s", "", "strayed", "", "load", "",
    ];
    let mut table = Table::new(header);
    for tried in values {
        let [runs, strayed] = [tried.runs, tried.strayed].map(cells);
        let load = tried.load.map(|load| load.percent);
        table.row([
            tried.path(),
            tried.from.clone(),
            tried.to.clone(),
            runs.0,
            runs.1,
            strayed.0,
            strayed.1,
            load.map_or_else(|| "-".to_owned(), signed),
            verdict(tried).to_owned(),
        ]);
    }
    table.to_string()
}

/// A word for a value that pays, and for one that cannot be chosen.
pub(super) fn verdict(tried: &Tried) -> &'static str {
    match tried {
        Tried { lost_logs: 1.., .. } => "loses logs",
        Tried { pays: true, .. } => "pays",
        _ => "",
    }
}

/// The mean, and the interval around it.
pub(super) fn cells(effect: Option<Effect>) -> (String, String) {
    let Some(effect) = effect else {
        return ("-".to_owned(), String::new());
    };
    let interval = match (effect.from_percent, effect.to_percent) {
        (Some(from), Some(to)) => format!("{} to {}", signed(from), signed(to)),
        _ => "one pair".to_owned(),
    };
    (signed(effect.percent), interval)
}

fn signed(percent: f64) -> String {
    let text = format!("{percent:+.1}");
    if text == "-0.0" || text == "+0.0" {
        "0.0".to_owned()
    } else {
        text
    }
}

/// What the columns mean.
pub(super) fn legend(report: &TuneReport) -> String {
    format!(
        "strayed: RMS of the held commands from those of control at every sample, as the motors feel it; \
         periodic: the same of\nperiodic control at as many runs; load: of the processor, by load.toml. All \
         {} intervals together hold with 95 %. A value pays\nwhere runs or straying surely fall and the other \
         rises by no more than 2 %.\n",
        2 * report.values.len()
    )
}

fn proposed(report: &TuneReport) -> String {
    match &report.proposal {
        Some(proposal) => format!(
            "proposed: {} = {} in place of {}; `git apply` takes this:\n\n{}",
            proposal.value, proposal.to, proposal.from, proposal.diff
        ),
        None => "proposed: nothing, no other value surely pays on these logs\n".to_owned(),
    }
}

/// What a wish costs, a sentence each.
pub(super) fn trades(report: &TuneReport) -> Vec<String> {
    let sentence = |trade: &Trade| {
        let wish = match trade.wish {
            Wish::FewerRuns => "fewer runs",
            Wish::LessStraying => "less straying",
        };
        format!(
            "the cheapest way to {wish}: {} = {}, runs {} %, straying {} %",
            trade.value,
            trade.to,
            signed(trade.runs_percent),
            signed(trade.strayed_percent)
        )
    };
    report.trades.iter().map(sentence).collect()
}

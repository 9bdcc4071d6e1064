//! `cargo hil info`: what a log holds, and what a replay would take of it.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use super::log_arguments::LogArguments;
use crate::json::to_json;
use recorded_flights::{Contents, Dropouts, Evidence, Signal, Span};

/// Which log is looked into.
#[derive(Clone, Debug, Args)]
pub(super) struct InfoArguments {
    /// Log of any format, also as .gz
    log: PathBuf,
    #[command(flatten)]
    reading: LogArguments,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Prints what a log holds.
pub(super) fn run(arguments: &InfoArguments) -> Result<()> {
    let contents = Contents::read(&arguments.log, &arguments.reading.reading()?)?;
    let text = match arguments.json {
        true => to_json(&contents)?,
        false => text(&contents),
    };
    super::print(&text)
}

/// The lines for a person.
fn text(contents: &Contents) -> String {
    let mut lines = vec![
        format!("{}: {}", contents.log, contents.format),
        format!("vehicle      {}", vehicle(contents)),
        format!("length       {:.1} s", contents.length_s),
    ];
    lines.extend(contents.sensors.iter().map(|signal| line("sensor", signal)));
    lines.extend(
        contents
            .recorded
            .iter()
            .map(|signal| line("recorded", signal)),
    );
    lines.push(match &contents.armed {
        Some(spans) => format!("armed        {}", listed(spans)),
        None => "armed        the log does not tell".to_owned(),
    });
    lines.extend(flights(contents));
    if contents.dropouts.count > 0 {
        let Dropouts { count, lost_s } = contents.dropouts;
        lines.push(match lost_s > 0.0 {
            true => format!("dropouts     {count}, {lost_s:.3} s together"),
            false => format!("dropouts     {count}"),
        });
    }
    if let Some(longest) = contents
        .gaps
        .iter()
        .max_by(|a, b| a.length_s.total_cmp(&b.length_s))
    {
        let count = contents.gaps.len();
        let (length, at) = (longest.length_s, longest.at_s);
        lines.push(format!(
            "gaps         {count}, the longest {length:.3} s at {at:.1} s"
        ));
    }
    lines.extend(
        contents
            .skipped
            .iter()
            .map(|skip| format!("skipped      {skip}")),
    );
    lines.extend(
        contents
            .notes
            .iter()
            .map(|note| format!("note         {note}")),
    );
    lines.push(replay(contents));
    lines.join("\n") + "\n"
}

fn vehicle(contents: &Contents) -> String {
    let vehicle = &contents.vehicle;
    let description = match vehicle.description.as_str() {
        "" => "the log does not tell",
        description => description,
    };
    match &vehicle.other {
        Some(other) => format!("{other}: {description}"),
        None => description.to_owned(),
    }
}

fn line(what: &str, signal: &Signal) -> String {
    let Signal {
        name,
        samples,
        rate_hz,
    } = signal;
    format!("{what:<12} {name}: {samples} samples, {rate_hz:.0} Hz")
}

fn listed(spans: &[Span]) -> String {
    match spans {
        [] => "never".to_owned(),
        spans => spans
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join(", "),
    }
}

fn flights(contents: &Contents) -> Vec<String> {
    let by = match contents.flown.evidence {
        Evidence::Landed => "the log's landings",
        Evidence::Motors => "its motors",
        Evidence::Nothing => return vec!["flights      nothing shows when it flew".to_owned()],
    };
    if contents.flown.parts.is_empty() {
        return vec![format!("flights      none, by {by}")];
    }
    let numbered = contents.flown.parts.iter().zip(1..);
    numbered
        .map(|(part, number)| format!("flight {number:<5} {part}, by {by}"))
        .collect()
}

fn replay(contents: &Contents) -> String {
    match (&contents.replay, &contents.refusal) {
        (Some(replay), _) => format!(
            "a replay     takes {} ({}), rotation {} ({})",
            replay.part.span, replay.part.reason, replay.rotation, replay.rotation_reason
        ),
        (None, refusal) => {
            let reason = refusal.as_deref().unwrap_or_default();
            format!("a replay     is refused: {reason}")
        }
    }
}

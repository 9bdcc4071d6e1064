//! `cargo hil campaign`: the paper's experiments over seeds, and a report of them.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use super::bar::Bar;
use super::quantities::number;
use crate::campaign::{
    self, CampaignOptions, Compared, Findings, Here, Metric, Plan, Shard, percent,
};
use crate::clock;
use crate::json::to_json;
use crate::refusal::Refusal;
use crate::toolchain;

/// Where campaigns are kept when no folder is named, from the workspace's folder.
const FOLDER: &str = "target/hil/campaign";

/// What a campaign is told.
#[derive(Clone, Debug, Args)]
pub(super) struct CampaignArguments {
    /// The plan: `paper` for 260 hours, `trade` for error over runs and load over error, `smoke` for two minutes' work
    #[arg(value_name = "NAME")]
    name: String,
    /// Fly the I-th of N equal parts, for a cluster; parts may share a folder
    #[arg(
        long,
        value_name = "I/N",
        allow_hyphen_values = true,
        conflicts_with = "report_only"
    )]
    shard: Option<Shard>,
    /// Seeds of every comparison, 1 to 10000 [default: the plan's]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    seeds: Option<u32>,
    /// As many seeds as make so many simulated hours, at least
    #[arg(long, value_name = "HOURS", value_parser = number, allow_negative_numbers = true, conflicts_with = "seeds")]
    hours: Option<f64>,
    /// Fly the control logics that have gains of this name in config/logics/LOGIC/, with these
    #[arg(long, value_name = "NAME")]
    gains: Option<String>,
    /// Folder of journals, tables and report [default: target/hil/campaign/NAME]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Leave the emulated board out, and with it equal processor time
    #[arg(long)]
    native: bool,
    /// Print what was found as one JSON object instead of a summary
    #[arg(long)]
    json: bool,
    /// Fly nothing, write tables and report of the flights that there are
    #[arg(long)]
    report_only: bool,
}

/// Flies what is left to fly, writes tables and report, and prints what was found.
pub(super) fn run(arguments: &CampaignArguments) -> Result<()> {
    let plan = match arguments.hours {
        Some(hours) => Plan::for_hours(&arguments.name, hours)?,
        None => Plan::named(&arguments.name, arguments.seeds)?,
    };
    let plan = match &arguments.gains {
        Some(name) => plan.with_gains(name)?,
        None => plan,
    };
    let plan = if arguments.native {
        plan.native()
    } else {
        plan
    };
    if arguments
        .out
        .as_ref()
        .is_some_and(|out| out.as_os_str().is_empty())
    {
        return Err(Refusal::new("--out: must be the name of a folder").into());
    }
    let folder = || toolchain::root().join(FOLDER).join(&plan.name);
    let options = CampaignOptions {
        shard: arguments.shard,
        folder: arguments.out.clone().unwrap_or_else(folder),
        report_only: arguments.report_only,
        plan,
    };
    let mut bar = Bar::new();
    let findings = campaign::campaign(&options, &mut Here, &clock::today(), &mut bar);
    bar.finish();
    let findings = findings?;
    let text = if arguments.json {
        to_json(&findings)?
    } else {
        summary(&findings, &options)
    };
    super::print(&text)
}

fn summary(findings: &Findings, options: &CampaignOptions) -> String {
    let (hours, flights) = (findings.hours, findings.flights);
    let mut lines = vec![
        format!(
            "{:.1} h natively in {} flights",
            hours.native, flights.native
        ),
        match flights.emulated {
            0 => "none on the emulated board".to_owned(),
            some => format!(
                "{:.2} h on the emulated board in {some} flights, {} runs equal to the host's bit by bit",
                hours.emulated, findings.equal_runs
            ),
        },
        format!(
            "{} of {} flights missing, {} without a rate to be equal to, {} crashed",
            findings.missing,
            findings.planned,
            findings.undecided,
            findings.crashes.len()
        ),
        "improvement in %, mean of all cells with its 95 % interval; positive is better".to_owned(),
        heading(),
    ];
    lines.extend(findings.comparisons.iter().map(comparison));
    for name in ["flights.parquet", "report.html", "*.svg"] {
        lines.push(options.folder.join(name).display().to_string());
    }
    lines.join("\n") + "\n"
}

/// What the summary has columns of.
const COLUMNS: [Metric; 3] = [Metric::Attitude, Metric::Pitch, Metric::FlightTime];

fn heading() -> String {
    COLUMNS
        .map(|metric| format!("{:>15}", metric.name()))
        .concat()
}

fn comparison(compared: &Compared) -> String {
    let columns = COLUMNS.map(|metric| {
        let interval = compared.improvement_percent.get(&metric);
        let text = interval.map_or("-".to_owned(), |interval| {
            let half = interval.half_width;
            let half = half.map_or(String::new(), |half| format!(" ± {half:.2}"));
            percent(interval.mean) + &half
        });
        format!("{text:>15}")
    });
    format!("{}  {}", columns.concat(), compared.comparison.name)
}

//! `cargo hil tune`: what other settings would change on one's own flights.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use super::bar::Bar;
use super::recorded_arguments::RecordedArguments;
use crate::json::to_json;
use crate::output_file::OutputFile;
use crate::refusal::Refusal;
use crate::tune::{TuneOptions, page, summary, tune};

/// The arguments of a tuning. Defaults are those of `config/`; no option needs a rebuild.
#[derive(Clone, Debug, Args)]
pub(super) struct TuneArguments {
    #[command(flatten)]
    flight: RecordedArguments,
    /// Write the result as a page to this file, its figures within it
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Print the result as one JSON object instead of tables
    #[arg(long)]
    json: bool,
}

/// Flies every log with every value, then prints what came of it.
pub(super) fn run(arguments: &TuneArguments) -> Result<()> {
    let options = options(arguments)?;
    let mut bar = Bar::new();
    let result = tune(&options, &mut bar);
    bar.finish();
    let report = result?;
    if let Some(file) = &arguments.report {
        OutputFile::new("report", file).write(&page(&report)?)?;
    }
    let text = if arguments.json {
        to_json(&report)?
    } else {
        summary(&report)
    };
    super::print(&text)
}

fn options(arguments: &TuneArguments) -> Result<TuneOptions, Refusal> {
    let log = arguments.flight.log()?;
    let replay = arguments.flight.options()?;
    if arguments.flight.settings.is_by_clock() {
        return Err(Refusal::new(
            "--policy periodic: reactive control is tuned; leave out --rate and --policy periodic",
        ));
    }
    if let Some(file) = &arguments.report {
        let file = OutputFile::new("report", file);
        file.check()?;
        if let Some(log) = log.filter(|log| !log.is_dir()) {
            file.check_is_not(log)?;
        }
    }
    Ok(TuneOptions { replay, threads: 0 })
}

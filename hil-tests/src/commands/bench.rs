//! `cargo hil bench`: what every part costs, and whether that is too much.

use anyhow::{Result, bail};
use clap::Args;

use super::bar::Bar;
use crate::costs::{Costs, measure};
use crate::progress::Progress;

/// How the costs are told.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct BenchArguments {
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// Measures, prints, and fails where a limit is passed.
pub(super) fn run(arguments: BenchArguments) -> Result<()> {
    let mut bar = Bar::new();
    let costs = measure(&mut bar);
    bar.finish();
    let costs = costs?;
    let text = if arguments.json {
        costs.to_json()?
    } else {
        costs.table()
    };
    super::print(&text)?;
    within_limits(&costs)
}

/// The same as a step of `cargo hil test`.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    within_limits(&measure(progress)?)
}

fn within_limits(costs: &Costs) -> Result<()> {
    match costs.over() {
        Some(line) => bail!("{line}"),
        None => Ok(()),
    }
}

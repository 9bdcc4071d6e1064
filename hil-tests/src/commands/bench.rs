//! `cargo hil bench`: what every part costs, and whether that is too much.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;

use super::bar::Bar;
use crate::costs::{Costs, measure};
use crate::json::to_json;
use crate::progress::Progress;
use recorded_flights::{Flight, Rotate};

/// How the costs are printed.
#[derive(Clone, Debug, Args)]
pub(super) struct BenchArguments {
    /// Recorded flights, whose runs every control logic is measured on too
    #[arg(value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// Measures, prints, and fails where a limit is passed.
pub(super) fn run(arguments: &BenchArguments) -> Result<()> {
    let flights = arguments.logs.iter();
    let flights = flights.map(|log| Flight::read(log, Rotate::Auto).map_err(anyhow::Error::from));
    let flights = flights.collect::<Result<Vec<Flight>>>()?;
    let mut bar = Bar::new();
    let costs = measure(&flights, &mut bar);
    bar.finish();
    let costs = costs?;
    let text = if arguments.json {
        to_json(&costs)?
    } else {
        costs.table()
    };
    super::print(&text)?;
    within_limits(&costs)
}

/// The same as a step of `cargo hil test`.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    within_limits(&measure(&[], progress)?)
}

fn within_limits(costs: &Costs) -> Result<()> {
    match costs.over() {
        Some(line) => bail!("{line}"),
        None => Ok(()),
    }
}

//! `cargo hil replay`: a recorded flight through the firmware, and what it decided.

use anyhow::Result;

use super::bar::Bar;
use super::replay_arguments::ReplayArguments;
use super::sweep_arguments::write_figure;
use crate::json::to_json;
use crate::replay::{emulated, native};
use crate::scoring::summary;
use crate::sweep::{SweepOptions, sweep, tables, trade_curves};

/// Replays, then prints the report.
pub(super) fn run(arguments: &ReplayArguments) -> Result<()> {
    if let Some(options) = arguments.sweep_options()? {
        return fly_all(arguments, &options);
    }
    let options = arguments.options()?;
    let mut bar = Bar::new();
    let result = if arguments.native {
        native::replay(&options, &mut bar)
    } else {
        emulated::replay(&options, &mut bar)
    };
    bar.finish();
    let report = result?;
    // Printed only once it is whole: a failed replay leaves no half of a JSON object.
    let text = if arguments.json {
        to_json(&report)?
    } else {
        summary(&report)
    };
    super::print(&text)
}

/// Sweeps, draws the trade curves, then prints the tables.
fn fly_all(arguments: &ReplayArguments, options: &SweepOptions) -> Result<()> {
    let mut bar = Bar::new();
    let result = sweep(options, &mut bar);
    bar.finish();
    let report = result?;
    let figure = arguments.sweep.figure(arguments.json);
    if let Some(file) = &figure {
        write_figure(file, &trade_curves(&report).to_svg()?)?;
    }
    let mut text = if arguments.json {
        to_json(&report)?
    } else {
        tables(&report)
    };
    if let (Some(file), false) = (figure, arguments.json) {
        text += &format!("\ntrade curves: {}\n", file.display());
    }
    super::print(&text)
}

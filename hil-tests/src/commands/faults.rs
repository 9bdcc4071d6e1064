//! `cargo hil faults`: every scenario of faults, and whether it ends as expected.

use anyhow::{Result, bail};
use clap::Args;

use super::bar::Bar;
use crate::closed_loop::{Core, Flyer};
use crate::faults;
use crate::firmware::Firmware;
use crate::json::to_json;
use crate::logics::LogicName;
use crate::progress::Progress;
use crate::scenarios::{fly_all, read_all};

/// What flies the scenarios of hil-tests/scenarios/.
#[derive(Clone, Debug, Args)]
pub(super) struct FaultsArguments {
    /// Control logic [default: that of config/selection.toml]
    #[arg(long)]
    logic: Option<LogicName>,
    /// Seed of wind and noise
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Fly the same code on this computer, without firmware and emulator: faults of wires are left out
    #[arg(long)]
    native: bool,
    /// Only scenarios whose names contain this
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    /// Print every kind of fault that a script can name, and fly nothing
    #[arg(long)]
    list: bool,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// Flies them, prints the table, and fails where one does not pass for which no weakness is known.
pub(super) fn run(arguments: &FaultsArguments) -> Result<()> {
    if arguments.list {
        return super::print(&faults::list());
    }
    let mut scenarios = read_all(arguments.native)?;
    scenarios.retain(|scenario| scenario.name().contains(&arguments.only));
    let logic = arguments.logic.unwrap_or_else(LogicName::configured);
    let mut bar = Bar::new();
    let firmware = match arguments.native {
        true => None,
        false => Some(Firmware::build(logic, &mut bar)?),
    };
    let flyer = firmware.as_ref().map_or(Flyer::Native, |firmware| {
        Flyer::Emulated(Core::of(firmware))
    });
    bar.stage("Flying scenarios");
    let flown = fly_all(&scenarios, (logic, arguments.seed), flyer, &mut bar);
    bar.finish();
    let flown = flown?;
    super::print(&if arguments.json {
        to_json(&flown)?
    } else {
        flown.table()
    })?;
    match flown.surprises().as_slice() {
        [] => Ok(()),
        names => bail!("not as their files say: {}", names.join(", ")),
    }
}

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
use crate::scenarios::{Scenario, Scenarios, fly_all, read_all};

/// What flies the scenarios of hil-tests/scenarios/.
#[derive(Clone, Debug, Args)]
pub(super) struct FaultsArguments {
    /// Control logics, with commas between them [default: that of config/selection.toml]
    #[arg(long, value_delimiter = ',')]
    logic: Vec<LogicName>,
    /// Seed of wind and noise
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Fly under so many seeds, from that one on
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,
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
    let mut bar = Bar::new();
    let flown = arguments.fly(&scenarios, &mut bar);
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

impl FaultsArguments {
    fn fly(&self, scenarios: &[Scenario], bar: &mut Bar) -> Result<Scenarios> {
        let logics = match self.logic.as_slice() {
            [] => &[LogicName::configured()],
            logics => logics,
        };
        let last = self.seed.saturating_add(self.seeds - 1);
        let seeds: Vec<u32> = (self.seed..=last).collect();
        let mut flown = Scenarios::default();
        for logic in logics {
            let firmware = match self.native {
                true => None,
                false => Some(Firmware::build(*logic, bar)?),
            };
            let flyer = firmware.as_ref().map_or(Flyer::Native, |firmware| {
                Flyer::Emulated(Core::of(firmware))
            });
            bar.stage(&format!("Flying scenarios with {}", logic.word()));
            let of_logic = fly_all(scenarios, (*logic, &seeds), flyer, bar)?;
            flown.scenarios.extend(of_logic);
        }
        Ok(flown)
    }
}

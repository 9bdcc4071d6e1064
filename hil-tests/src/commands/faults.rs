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
use crate::scenarios::{RandomScripts, Scenarios, fly_all, fly_random, read_all};

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
    /// Fly so many random scripts of faults instead; one that breaks a promise is reduced and printed
    #[arg(long, value_name = "COUNT", conflicts_with_all = ["only", "seeds"], value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    random: Option<u32>,
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
    let mut bar = Bar::new();
    let result = match arguments.random {
        Some(count) => arguments.fly_random(count, &mut bar),
        None => arguments.fly_scenarios(&mut bar),
    };
    bar.finish();
    let (text, wrong) = result?;
    super::print(&text)?;
    match wrong {
        None => Ok(()),
        Some(line) => bail!(line),
    }
}

/// What is printed, and what is wrong if something is.
type Found = (String, Option<String>);

impl FaultsArguments {
    fn fly_scenarios(&self, bar: &mut Bar) -> Result<Found> {
        let mut scenarios = read_all(self.native)?;
        scenarios.retain(|scenario| scenario.name().contains(&self.only));
        let last = self.seed.saturating_add(self.seeds - 1);
        let seeds: Vec<u32> = (self.seed..=last).collect();
        let of_logics = self.with_each(bar, |logic, flyer, bar| {
            fly_all(&scenarios, (logic, &seeds), flyer, bar)
        })?;
        let flown = Scenarios {
            scenarios: of_logics.concat(),
        };
        let text = if self.json {
            to_json(&flown)?
        } else {
            flown.table()
        };
        let wrong = match flown.surprises().as_slice() {
            [] => None,
            names => Some(format!("not as their files say: {}", names.join(", "))),
        };
        Ok((text, wrong))
    }

    fn fly_random(&self, count: u32, bar: &mut Bar) -> Result<Found> {
        let random = self.with_each(bar, |logic, flyer, bar| {
            fly_random((count, self.seed), (logic, flyer), bar)
        })?;
        let text = if self.json {
            to_json(&random)?
        } else {
            random.iter().map(RandomScripts::summary).collect()
        };
        let new: usize = random.iter().map(RandomScripts::surprises).sum();
        let wrong =
            (new > 0).then(|| format!("{new} scripts break a promise by no known weakness"));
        Ok((text, wrong))
    }

    /// Flies with each logic that was asked for, on the tier that was.
    fn with_each<T>(
        &self,
        bar: &mut Bar,
        fly: impl Fn(LogicName, Flyer<'_>, &mut Bar) -> Result<T>,
    ) -> Result<Vec<T>> {
        let logics = match self.logic.as_slice() {
            [] => &[LogicName::configured()],
            logics => logics,
        };
        let of_logic = |logic: &LogicName| {
            let firmware = match self.native {
                true => None,
                false => Some(Firmware::build(*logic, bar)?),
            };
            let flyer = firmware.as_ref().map_or(Flyer::Native, |firmware| {
                Flyer::Emulated(Core::of(firmware))
            });
            bar.stage(&format!("Flying with {}", logic.word()));
            fly(*logic, flyer, bar)
        };
        logics.iter().map(of_logic).collect()
    }
}

//! `cargo hil profile`: where the instructions of a flight go.

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, Subcommand};

use super::bar::Bar;
use super::recorded_arguments::RecordedArguments;
use super::simulated_arguments::SimulatedArguments;
use crate::firmware::Firmware;
use crate::json::to_json;
use crate::output_file::OutputFile;
use crate::profile::{self, Profiled};
use crate::progress::Progress;

/// What is flown.
#[derive(Clone, Debug, Args)]
pub(super) struct ProfileArguments {
    #[command(subcommand)]
    flown: Flown,
}

#[derive(Clone, Debug, Subcommand)]
enum Flown {
    /// Count the instructions of a replay behind its warm-up, by part, function and task
    Replay(Box<Replay>),
    /// Count the instructions of a simulated flight's scored part, by part, function and task
    Fly(Box<Fly>),
}

#[derive(Clone, Debug, Args)]
struct Replay {
    #[command(flatten)]
    flight: RecordedArguments,
    #[command(flatten)]
    output: Output,
}

#[derive(Clone, Debug, Args)]
struct Fly {
    #[command(flatten)]
    flight: SimulatedArguments,
    #[command(flatten)]
    output: Output,
}

/// How a profile is written.
#[derive(Clone, Debug, Args)]
struct Output {
    /// Draw the flame graph to this SVG file: tasks, and the functions that they call
    #[arg(long, value_name = "FILE")]
    flame: Option<PathBuf>,
    /// Write the stacks of functions with their instructions to this file, for other tools
    #[arg(long, value_name = "FILE")]
    folded: Option<PathBuf>,
    /// Print the profile as one JSON object instead of tables
    #[arg(long)]
    json: bool,
}

/// Flies, writes what is asked for, then prints the profile.
pub(super) fn run(arguments: &ProfileArguments) -> Result<()> {
    let output = match &arguments.flown {
        Flown::Replay(replay) => &replay.output,
        Flown::Fly(fly) => &fly.output,
    };
    output.check()?;
    let mut bar = Bar::new();
    let profiled = arguments.flown.profiled(&mut bar);
    bar.finish();
    output.write(&profiled?)
}

impl Flown {
    fn profiled(&self, bar: &mut Bar) -> Result<Profiled> {
        match self {
            Self::Replay(replay) => profile::replay(&replay.flight.options()?, bar),
            Self::Fly(fly) => {
                let (options, scene) = (fly.flight.options()?, fly.flight.scene()?);
                let firmware = Firmware::build(options.gains.logic(), bar)?;
                bar.stage(&format!("Flying in {}", fly.flight.environment));
                let core = (&firmware, fly.flight.clock_mhz()?);
                profile::fly(&scene, &options, core, bar)
            }
        }
    }
}

impl Output {
    /// The files that are asked for, each with the name of its option.
    fn files(&self) -> [Option<OutputFile<'_>>; 2] {
        [("flame", &self.flame), ("folded", &self.folded)]
            .map(|(option, path)| Some(OutputFile::new(option, path.as_deref()?)))
    }

    fn check(&self) -> Result<()> {
        for file in self.files().into_iter().flatten() {
            file.check()?;
        }
        Ok(())
    }

    fn write(&self, profiled: &Profiled) -> Result<()> {
        let [flame, folded] = self.files();
        if let Some(file) = flame {
            file.write(&profile::figure(profiled)?)?;
        }
        if let Some(file) = folded {
            file.write(&profile::folded(&profiled.stacks))?;
        }
        super::print(&if self.json {
            to_json(&profiled.profile)?
        } else {
            profiled.profile.tables()
        })
    }
}

//! `cargo hil fuzz`: inputs that nobody meant, for all that reads.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use clap::Args;

use crate::fuzz::worker::{self, Inputs, PATIENCE};
use crate::fuzz::{TARGETS, Target};
use crate::progress::Progress;
use crate::refusal::Refusal;

/// Seed of continuous integration.
const SEED: u64 = 1;

/// What is fuzzed, and with how many inputs.
#[derive(Clone, Debug, Args)]
pub(super) struct FuzzArguments {
    /// What to fuzz [default: everything]
    #[arg(value_name = "TARGET")]
    targets: Vec<String>,
    /// Seed of the inputs
    #[arg(long, default_value_t = SEED)]
    seed: u64,
    /// Inputs of each target [default: as many as continuous integration tries]
    #[arg(long, value_name = "NUMBER")]
    inputs: Option<u64>,
    /// Go on for so long with each target
    #[arg(long, value_name = "NUMBER", conflicts_with = "inputs")]
    minutes: Option<u64>,
    /// Number of the first input
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    first: u64,
    /// Try the input in a file, here and now
    #[arg(long, value_name = "FILE", conflicts_with_all = ["inputs", "minutes", "first"])]
    input: Option<PathBuf>,
    /// Print every target and what it reads, and fuzz nothing
    #[arg(long)]
    list: bool,
    /// Be the process that tries inputs
    #[arg(long, hide = true, requires = "inputs")]
    worker: bool,
}

/// Fuzzes each target, and fails at the first input that fails.
pub(super) fn run(arguments: &FuzzArguments) -> Result<()> {
    if arguments.list {
        let row = |target: Target| format!("{:<14} {}\n", target.name, target.reads);
        return super::print(&TARGETS.map(row).concat());
    }
    let targets = targets(&arguments.targets)?;
    if let Some(file) = &arguments.input {
        return try_file(&targets, file);
    }
    for target in targets {
        let inputs = Inputs {
            seed: arguments.seed,
            first: arguments.first,
            count: match arguments.minutes {
                Some(_) => u64::MAX,
                None => arguments.inputs.unwrap_or(target.inputs),
            },
            time: arguments
                .minutes
                .map(|minutes| Duration::from_secs(60 * minutes)),
            patience: PATIENCE,
        };
        if arguments.worker {
            return worker::work(target, inputs.seed, inputs.first, inputs.count);
        }
        let said = fuzz(target, &inputs)?;
        super::print(&said)?;
    }
    Ok(())
}

/// Everything, as continuous integration does it.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    for (done, target) in TARGETS.into_iter().enumerate() {
        progress.detail(target.name);
        progress.done(done as f64, TARGETS.len() as f64);
        let inputs = Inputs {
            seed: SEED,
            first: 0,
            count: target.inputs,
            time: None,
            patience: PATIENCE,
        };
        fuzz(target, &inputs)?;
    }
    Ok(())
}

/// One line of what was tried.
fn fuzz(target: Target, inputs: &Inputs) -> Result<String> {
    let program = std::env::current_exe().context("this program has no name")?;
    let tried = worker::try_inputs(&program, target, inputs)?;
    let (name, seed) = (target.name, inputs.seed);
    Ok(format!(
        "{name:<14} {:>10} inputs of seed {seed}, {:>10} accepted\n",
        tried.inputs, tried.accepted
    ))
}

fn targets(names: &[String]) -> Result<Vec<Target>, Refusal> {
    if names.is_empty() {
        return Ok(TARGETS.to_vec());
    }
    let known = || TARGETS.map(|target| target.name).join(", ");
    let named = |name: &String| {
        let refusal = || {
            Refusal::new(format!(
                "target {name} is unknown, must be one of: {}",
                known()
            ))
        };
        Target::named(name).ok_or_else(refusal)
    };
    names.iter().map(named).collect()
}

fn try_file(targets: &[Target], file: &PathBuf) -> Result<()> {
    let [target] = targets else {
        return Err(Refusal::new("--input: name the one target that the file is for").into());
    };
    let input = std::fs::read(file).map_err(|error| {
        Refusal::new(format!(
            "--input {}: cannot be read: {error}",
            file.display()
        ))
    })?;
    let word = if target.load()?.accepts(&input) {
        "accepted"
    } else {
        "refused"
    };
    super::print(&format!("{}: {word}\n", file.display()))
}

//! Tries inputs in a process of its own, and keeps the one that ends it.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use rlimit::Resource;

use super::Target;
use crate::clock;
use crate::toolchain;

/// All memory of the process that tries inputs.
const MEMORY: u64 = 512 << 20;
/// Longest time for one input, which takes some ms, on a machine that is busy.
pub const PATIENCE: Duration = Duration::from_secs(30);
/// Where inputs that fail are kept.
const FOLDER: &str = "target/fuzz";

/// Which inputs are tried.
#[derive(Clone, Copy, Debug)]
pub struct Inputs {
    /// Seed of all of them.
    pub seed: u64,
    /// Number of the first.
    pub first: u64,
    /// How many; or, where there is a time, at most.
    pub count: u64,
    /// For how long.
    pub time: Option<Duration>,
    /// Longest time for one.
    pub patience: Duration,
}

/// What was tried without a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tried {
    /// How many inputs.
    pub inputs: u64,
    /// How many of them were accepted.
    pub accepted: u64,
}

/// What the process says before it tries an input.
#[derive(Clone, Copy)]
struct Step {
    number: u64,
    accepted: u64,
}

/// Tries inputs in a process of `program`, which is `cargo hil`'s.
///
/// # Errors
/// An input fails: one line with what it was, where it is kept, and what replays it.
pub fn try_inputs(program: &Path, target: Target, inputs: &Inputs) -> Result<Tried> {
    // What is to be built is built here: the process has little memory.
    let loaded = target.load()?;
    let mut child = start(program, target.name, inputs)?;
    let steps = steps(&mut child)?;
    let complaint = complaint(&mut child)?;
    let (last, ended) = follow(&steps, inputs);
    if ended != Ended::ByItself {
        let _ = child.kill();
    }
    let status = child.wait().context("the process got lost")?;
    let said = complaint.join().unwrap_or_default();
    let tried = Tried {
        inputs: last.number - inputs.first,
        accepted: last.accepted,
    };
    let reason = match ended {
        Ended::Late => return Ok(tried),
        Ended::ByItself if status.success() => return Ok(tried),
        Ended::ByItself => format!("{status}: {said}"),
        Ended::Endless => format!("takes over {} s", inputs.patience.as_secs()),
    };
    let file = keep(
        target.name,
        inputs.seed,
        last.number,
        &loaded.input(inputs.seed, last.number),
    )?;
    let (name, file) = (target.name, file.display());
    bail!(
        "{name}: input {} of seed {} fails ({reason}); cargo hil fuzz {name} --input {file}",
        last.number,
        inputs.seed
    )
}

/// The process itself: says the number of each input, and tries it.
///
/// # Errors
/// Nobody listens any more.
pub fn work(target: Target, seed: u64, first: u64, count: u64) -> Result<()> {
    let loaded = target.load()?;
    rlimit::setrlimit(Resource::AS, MEMORY, MEMORY).context("memory cannot be bounded")?;
    let mut out = std::io::stdout().lock();
    let mut accepted: u64 = 0;
    for number in first..first.saturating_add(count) {
        writeln!(out, "{number} {accepted}")?;
        accepted += u64::from(loaded.accepts(&loaded.input(seed, number)));
    }
    writeln!(out, "{} {accepted}", first.saturating_add(count))?;
    Ok(())
}

/// How following the process ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ended {
    /// It says no more.
    ByItself,
    /// The time is over.
    Late,
    /// It tries one input for too long.
    Endless,
}

fn follow(steps: &Receiver<Step>, inputs: &Inputs) -> (Step, Ended) {
    let passed = clock::stopwatch();
    let mut last = Step {
        number: inputs.first,
        accepted: 0,
    };
    loop {
        match steps.recv_timeout(inputs.patience) {
            Ok(step) => last = step,
            Err(RecvTimeoutError::Disconnected) => return (last, Ended::ByItself),
            Err(RecvTimeoutError::Timeout) => return (last, Ended::Endless),
        }
        if inputs.time.is_some_and(|time| passed() >= time) {
            return (last, Ended::Late);
        }
    }
}

fn start(program: &Path, name: &str, inputs: &Inputs) -> Result<Child> {
    let Inputs {
        seed, first, count, ..
    } = inputs;
    let [seed, first, count] = [seed, first, count].map(u64::to_string);
    let mut command = Command::new(program);
    command.args([
        "fuzz", name, "--seed", &seed, "--first", &first, "--inputs", &count, "--worker",
    ]);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
        .spawn()
        .with_context(|| format!("{} cannot be started", program.display()))
}

/// What the process says, as it says it; what is no step is left out.
fn steps(child: &mut Child) -> Result<Receiver<Step>> {
    let out = child.stdout.take().context("stdout is piped")?;
    let (said, heard) = sync_channel(100);
    thread::spawn(move || {
        for line in BufReader::new(out).lines().map_while(Result::ok) {
            let step = line.split_once(' ').and_then(|(number, accepted)| {
                Some(Step {
                    number: number.parse().ok()?,
                    accepted: accepted.parse().ok()?,
                })
            });
            let Some(step) = step else { continue };
            if said.send(step).is_err() {
                return;
            }
        }
    });
    Ok(heard)
}

/// The first line that the process complains with, where and what joined.
fn complaint(child: &mut Child) -> Result<thread::JoinHandle<String>> {
    let mut from = child.stderr.take().context("stderr is piped")?;
    Ok(thread::spawn(move || {
        let mut said = Vec::new();
        let _ = from.read_to_end(&mut said);
        let said = String::from_utf8_lossy(&said);
        let lines = said.lines().filter(|line| !line.trim().is_empty());
        lines
            .take(2)
            .collect::<Vec<_>>()
            .join(" ")
            .chars()
            .take(600)
            .collect()
    }))
}

fn keep(name: &str, seed: u64, number: u64, input: &[u8]) -> Result<PathBuf> {
    let folder = toolchain::root().join(FOLDER);
    let file = folder.join(format!("{name}-{seed}-{number}"));
    fs::create_dir_all(&folder)
        .and_then(|()| fs::write(&file, input))
        .with_context(|| file.display().to_string())?;
    Ok(file)
}

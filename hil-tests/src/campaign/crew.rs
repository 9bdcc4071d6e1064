//! Who flies: this process, or programs for other airframes, on every core.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;

use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::ValueEnum;
use reflex::config::{AIRFRAME, BANDWIDTH};
use serde::{Deserialize, Serialize};

use super::journal::{self, Landed, Stamp, Ways};
use super::sortie::{Job, Tier};
use crate::airframes::{self, Variant};
use crate::closed_loop::{self, Flyer, Scene};
use crate::costs;
use crate::firmware::Firmware;
use crate::logics::LogicName;
use crate::progress::{Progress, Silent};
use recorded_flights::{Flight, Rotate, sample_flight};

/// The hidden command that a program flies jobs by.
pub const WORKER: &str = "campaign-worker";
/// Speed of the emulated core, MHz.
const CLOCK_MHZ: u32 = 168;

/// Takes a journal's line of a finished flight, and tells how far it is.
pub type Take<'t> = &'t mut dyn FnMut(&str, &mut dyn Progress) -> Result<()>;

/// Whoever flies a campaign's jobs. Each flight follows from its job alone.
pub trait Crew {
    /// Flies jobs of one airframe; their lines come in any order.
    ///
    /// # Errors
    /// A flight that cannot be flown, firmware that contradicts the host, a line not taken.
    fn fly(&mut self, orders: &Orders, progress: &mut dyn Progress, take: Take<'_>) -> Result<()>;

    /// Measures what a run of each control logic costs.
    ///
    /// # Errors
    /// A program that cannot be built, a fault of the board.
    fn ways(&mut self, progress: &mut dyn Progress) -> Result<Vec<Ways>> {
        let log = sample_flight()?;
        let flight = Flight::read(&log, Rotate::Auto)?;
        let costs = costs::measure_logics(&[flight], progress)?;
        let ways = costs.into_iter().map(|cost| {
            let mean = cost
                .flights
                .first()
                .map_or(cost.everything, |flight| flight.mean);
            Ways {
                logic: cost.name,
                ours: mean.reactive,
                callbacks: mean.callbacks,
                pointer_vector: mean.pointer_vector,
            }
        });
        Ok(ways.collect())
    }
}

/// What a program is to fly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orders {
    /// What the lines are to carry.
    pub stamp: Stamp,
    /// The airframe.
    pub airframe: String,
    /// How fast its loops are, in % of the configured bandwidth.
    pub bandwidth: u32,
    /// What all of them fly on.
    pub tier: Tier,
    /// The flights.
    pub jobs: Vec<Job>,
}

impl Orders {
    /// The program that can fly them.
    fn variant(&self) -> Variant {
        Variant {
            airframe: self.airframe.clone(),
            bandwidth: f64::from(self.bandwidth) / 100.0,
        }
    }

    /// The stage that they are.
    fn stage(&self) -> String {
        let how = match self.tier {
            Tier::Emulated => "on the emulated board",
            Tier::Native => "natively",
        };
        format!(
            "Flying {} {how}: {} flights",
            self.variant().name(),
            self.jobs.len()
        )
    }
}

/// Flies in this process, the airframe that it was built for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Here;

/// Flies in a program for each airframe and bandwidth, built where it is not yet.
#[derive(Debug, Default)]
pub struct Programs(BTreeMap<String, Command>);

impl Crew for Here {
    fn fly(&mut self, orders: &Orders, progress: &mut dyn Progress, take: Take<'_>) -> Result<()> {
        let variant = orders.variant();
        ensure!(
            variant.built_in(),
            "{}: this program was built for {AIRFRAME} and a bandwidth of {BANDWIDTH}",
            variant.name()
        );
        let firmware = firmware(&orders.jobs, progress)?;
        let scenes = scenes(&orders.jobs)?;
        progress.stage(&orders.stage());
        let stop = AtomicBool::new(false);
        let (sender, landed) = mpsc::channel();
        rayon::in_place_scope_fifo(|scope| {
            for job in &orders.jobs {
                let (sender, scenes, firmware, stop) = (sender.clone(), &scenes, &firmware, &stop);
                scope.spawn_fifo(move |_| {
                    if !stop.load(Ordering::Relaxed) {
                        // Nobody listens any more only where it stopped.
                        let _ = sender.send(fly(job, scenes, firmware));
                    }
                });
            }
            drop(sender);
            let result = landed.iter().try_for_each(|landed| {
                take(&journal::flight_line(&orders.stamp, landed?)?, progress)
            });
            stop.store(true, Ordering::Relaxed);
            result
        })
    }
}

fn scenes(jobs: &[Job]) -> Result<BTreeMap<&str, Scene>> {
    let mut scenes = BTreeMap::new();
    for job in jobs {
        let name = job.sortie.environment.as_str();
        if !scenes.contains_key(name) {
            scenes.insert(name, Scene::load(name)?);
        }
    }
    Ok(scenes)
}

/// Each logic's firmware for this airframe, built one by one in the same place.
fn firmware<'j>(
    jobs: &'j [Job],
    progress: &mut dyn Progress,
) -> Result<BTreeMap<&'j str, Firmware>> {
    let mut built = BTreeMap::new();
    for job in jobs {
        let name = job.sortie.logic.as_str();
        if job.sortie.tier == Tier::Emulated && !built.contains_key(name) {
            let logic = LogicName::from_str(name, false).map_err(|error| anyhow!("{error}"))?;
            built.insert(name, Firmware::build(logic, progress)?);
        }
    }
    Ok(built)
}

fn fly(
    job: &Job,
    scenes: &BTreeMap<&str, Scene>,
    firmware: &BTreeMap<&str, Firmware>,
) -> Result<Landed> {
    let sortie = &job.sortie;
    let flyer = match sortie.tier {
        Tier::Native => Flyer::Native,
        Tier::Emulated => {
            let firmware = firmware.get(sortie.logic.as_str());
            Flyer::Emulated(firmware.context("no firmware was built")?, CLOCK_MHZ)
        }
    };
    let scene = scenes.get(sortie.environment.as_str());
    let scene = scene.context("no scene was loaded")?;
    let flown = closed_loop::fly(scene, &job.options()?, flyer, &mut Silent)
        .with_context(|| sortie.to_string())?;
    Ok(Landed {
        job: job.clone(),
        report: flown.report,
    })
}

/// One program's end: orders from the input, a line per flight to the output.
///
/// # Errors
/// Orders that are none, a flight that fails, an output that nobody reads.
pub fn serve(input: impl Read, output: &mut impl Write) -> Result<()> {
    let orders: Orders = serde_json::from_reader(input).context("these are no orders")?;
    let mut said = Said;
    Here.fly(&orders, &mut said, &mut |line, _| {
        output.write_all(line.as_bytes())?;
        Ok(output.flush()?)
    })
}

/// A program's progress: only what a command said that failed.
struct Said;

impl Progress for Said {
    fn stage(&mut self, _name: &str) {}

    fn output(&mut self, text: &str) {
        // Best effort: the error that follows says what failed.
        let _ = std::io::stderr().write_all(text.as_bytes());
    }
}

impl Programs {
    fn program(&mut self, variant: &Variant, progress: &mut dyn Progress) -> Result<Command> {
        let name = variant.name();
        if !self.0.contains_key(&name) {
            let command = airframes::program(variant, progress)?;
            self.0.insert(name.clone(), command);
        }
        let known = self.0.get(&name).context("it was built")?;
        let mut command = Command::new(known.get_program());
        let set = known
            .get_envs()
            .filter_map(|(name, value)| Some((name, value?)));
        command
            .envs(set)
            .arg(WORKER)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        Ok(command)
    }
}

impl Crew for Programs {
    fn fly(&mut self, orders: &Orders, progress: &mut dyn Progress, take: Take<'_>) -> Result<()> {
        let mut command = self.program(&orders.variant(), progress)?;
        let mut child = command.spawn().with_context(|| {
            format!(
                "{} cannot be started",
                command.get_program().to_string_lossy()
            )
        })?;
        progress.stage(&orders.stage());
        let spoken = serde_json::to_vec(orders)?;
        let result = converse(&mut child, spoken, &mut |line| take(line, progress));
        if result.is_err() {
            // Where it has ended already there is nothing left to stop.
            let _ = child.kill();
        }
        let status = child.wait()?;
        let said = result?;
        if !status.success() {
            let airframe = &orders.airframe;
            let mut lines: Vec<&str> = said.lines().collect();
            let last = lines.pop().unwrap_or("it did not say why");
            if !lines.is_empty() {
                progress.output(&(lines.join("\n") + "\n"));
            }
            bail!("{airframe}: {}", last.trim_start_matches("error: "));
        }
        Ok(())
    }
}

/// Gives orders, takes lines, and returns what was said besides.
fn converse(
    child: &mut Child,
    orders: Vec<u8>,
    take: &mut dyn FnMut(&str) -> Result<()>,
) -> Result<String> {
    let mut stdin = child.stdin.take().context("stdin is piped")?;
    let stdout = child.stdout.take().context("stdout is piped")?;
    let mut stderr = child.stderr.take().context("stderr is piped")?;
    thread::scope(|scope| {
        // A program that ends early says why on stderr.
        scope.spawn(move || stdin.write_all(&orders));
        let said = scope.spawn(move || {
            let mut said = Vec::new();
            let _ = stderr.read_to_end(&mut said);
            String::from_utf8_lossy(&said).into_owned()
        });
        let mut lines = BufReader::new(stdout);
        let mut line = String::new();
        let mut taken = Ok(());
        while taken.is_ok() && lines.read_line(&mut line)? > 0 {
            // A line without an end is of a program that was killed.
            if line.ends_with('\n') {
                taken = take(&line);
            }
            line.clear();
        }
        // Nothing is read any more: the program ends at its next line.
        drop(lines);
        taken?;
        Ok(said.join().unwrap_or_default())
    })
}

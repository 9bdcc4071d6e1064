//! Random scripts of faults: what holds whatever breaks, and what breaks it.

use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::{Context, Result, anyhow};
use proptest::prelude::Strategy;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::breach::Breach;
use super::{AIRFRAME, ENVIRONMENT, Scenario, fly_script, read_all};
use crate::closed_loop::{FaultReport, Flyer, Outcome, Scene, limits_of};
use crate::faults::{Entry, Limits, Script, any_script};
use crate::logics::LogicName;
use crate::parallel;
use crate::progress::Progress;

/// From take-off to the end of each, s.
const DURATION_S: f64 = 15.0;
/// Most flights that look for a smaller script.
const MOST_TRIES: usize = 200;

/// What came of random scripts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RandomScripts {
    /// Control logic that flew.
    pub logic: String,
    /// From which the scripts follow.
    pub seed: u32,
    /// How many scripts were flown.
    pub scripts: u32,
    /// How many faults they held.
    pub faults: usize,
    /// Scripts that the firmware told of.
    pub told: usize,
    /// Scripts that it did not tell of, and that did no harm: the drone flew on within 30 degrees of level.
    pub harmless: usize,
    /// Flights by how they ended: flies, landed, cut, crashed.
    pub outcomes: [usize; 4],
    /// Longest time between two runs while armed, ms.
    pub longest_gap_ms: f64,
    /// Longest time that a task kept a bus, ms; null on the emulated board.
    pub longest_transfer_ms: Option<f64>,
    /// Promises that were broken.
    pub broken: Vec<Broken>,
}

/// A random script that broke a promise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Broken {
    /// Its number, from 0; the seed of wind and noise is the seed of all and this.
    pub number: u32,
    /// The promise.
    pub breach: Breach,
    /// The smallest script that was found to break it, as a file.
    pub script: String,
    /// The flight that plays that file.
    pub command: String,
    /// The scenario that shows the known weakness behind it.
    pub weakness: Option<String>,
}

/// What flies random scripts.
struct Flight<'f> {
    /// Scenarios of known weaknesses.
    weak: Vec<Scenario>,
    logic: LogicName,
    flyer: Flyer<'f>,
    limits: Limits,
    scene: &'f Scene,
}

/// Flies so many random scripts; those that break a promise are reduced.
///
/// # Errors
/// As those of [`crate::closed_loop::fly`], with the script.
pub fn fly_random(
    (scripts, seed): (u32, u32),
    (logic, flyer): (LogicName, Flyer<'_>),
    progress: &mut dyn Progress,
) -> Result<RandomScripts> {
    let scene = Scene::load(ENVIRONMENT, AIRFRAME, None)?;
    let is_native = matches!(flyer, Flyer::Native);
    let mut weak = read_all(is_native)?;
    weak.retain(|scenario| scenario.weakness(logic.word()).is_some());
    let flight = Flight {
        weak,
        logic,
        flyer,
        limits: limits_of(&scene, DURATION_S, is_native),
        scene: &scene,
    };
    let numbers: Vec<u32> = (0..scripts).collect();
    let flown = parallel::map(&numbers, 0, |number| flight.play(seed, *number), progress)?;
    let mut report = RandomScripts {
        logic: logic.word().to_owned(),
        seed,
        scripts,
        ..RandomScripts::default()
    };
    for flown in flown {
        report.take(flown?);
    }
    Ok(report)
}

/// One random script, flown.
struct Flown {
    faults: usize,
    came: FaultReport,
    broken: Option<Broken>,
}

impl Flight<'_> {
    fn play(&self, seed: u32, number: u32) -> Result<Flown> {
        let of_flight = seed.wrapping_add(number);
        let mut tree = any_script(self.limits)
            .new_tree(&mut runner(seed, number))
            .map_err(|reason| anyhow!("no random script: {reason}"))?;
        let script = tree.current();
        let came = self.fly(&script, of_flight)?;
        let breach = Breach::any(&came).next();
        let broken = breach.map(|breach| {
            let smallest = self.reduce(&mut tree, &breach, of_flight)?;
            anyhow::Ok(Broken {
                number,
                breach,
                script: Script::written(&smallest)?,
                command: self.command(of_flight),
                weakness: self.weakness(&smallest),
            })
        });
        Ok(Flown {
            faults: script.len(),
            came,
            broken: broken.transpose()?,
        })
    }

    /// The simplest script on the way that breaks the same promise.
    fn reduce(
        &self,
        tree: &mut impl ValueTree<Value = Vec<Entry>>,
        breach: &Breach,
        seed: u32,
    ) -> Result<Vec<Entry>> {
        let mut smallest = tree.current();
        // Values that differ in digits which no file has are one script.
        let mut tried: BTreeMap<String, bool> = BTreeMap::new();
        let mut goes_on = tree.simplify();
        while goes_on && tried.len() < MOST_TRIES {
            let script = tree.current();
            let text = Script::written(&script)?;
            let breaks = match tried.get(&text) {
                Some(breaks) => *breaks,
                None => Breach::any(&self.fly(&script, seed)?).any(|new| new.is_like(breach)),
            };
            tried.insert(text, breaks);
            goes_on = if breaks {
                smallest = script;
                tree.simplify()
            } else {
                tree.complicate()
            };
        }
        Ok(smallest)
    }

    fn fly(&self, script: &[Entry], seed: u32) -> Result<FaultReport> {
        let text = || Script::written(script).unwrap_or_default();
        let error = |place: usize, key: &str, line| anyhow!(format!("{place}.{key}: {line}"));
        let faults = Script::checked(script, &self.limits, error)?;
        let came = fly_script(
            self.scene,
            (self.logic, seed),
            (faults, DURATION_S),
            self.flyer,
        );
        came.with_context(|| format!("seed {seed} and\n{}", text()))
    }

    /// The scenario of a known weakness that breaks the same thing, where a script breaks nothing else.
    fn weakness(&self, script: &[Entry]) -> Option<String> {
        let [fault] = script else {
            return None;
        };
        let known = self
            .weak
            .iter()
            .find(|scenario| scenario.breaks_like(fault));
        known.map(|scenario| scenario.name().to_owned())
    }

    /// Plays a script again.
    fn command(&self, seed: u32) -> String {
        let tier = match self.flyer {
            Flyer::Native => " --native",
            Flyer::Emulated(_) => "",
        };
        format!(
            "cargo hil fly{tier} --environment {ENVIRONMENT} --airframe {AIRFRAME} --logic {} --mission hover \
             --duration {DURATION_S} --seed {seed} --faults FILE",
            self.logic.word()
        )
    }
}

/// Chance of one script: the same on every computer and in whatever order they are flown.
fn runner(seed: u32, number: u32) -> TestRunner {
    let mut bytes = [0; 32];
    bytes[..4].copy_from_slice(&seed.to_le_bytes());
    bytes[4..8].copy_from_slice(&number.to_le_bytes());
    let chance = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    TestRunner::new_with_rng(Config::default(), chance)
}

impl RandomScripts {
    fn take(&mut self, flown: Flown) {
        let came = flown.came;
        self.faults += flown.faults;
        self.told += usize::from(came.detected_ms.is_some());
        self.harmless += usize::from(Breach::is_harmless(&came));
        let place = Outcome::ALL
            .iter()
            .position(|outcome| *outcome == came.outcome);
        self.outcomes[place.unwrap_or_default()] += 1;
        self.longest_gap_ms = self.longest_gap_ms.max(came.longest_gap_ms);
        let longest = self
            .longest_transfer_ms
            .into_iter()
            .chain(came.longest_transfer_ms);
        self.longest_transfer_ms = longest.reduce(f64::max);
        self.broken.extend(flown.broken);
    }

    /// Promises that are broken by no known weakness.
    #[must_use]
    pub fn surprises(&self) -> usize {
        let is_new = |broken: &&Broken| broken.weakness.is_none();
        self.broken.iter().filter(is_new).count()
    }

    /// For a person.
    #[must_use]
    pub fn summary(&self) -> String {
        let (scripts, faults) = (self.scripts, self.faults);
        let mut text = format!(
            "{scripts} random scripts with {faults} faults, {}, seed {}\n",
            self.logic, self.seed
        );
        let ends = Outcome::ALL.iter().zip(self.outcomes);
        let ends: Vec<String> = ends
            .map(|(outcome, count)| format!("{} {count}", outcome.word()))
            .collect();
        let _ = writeln!(text, "how they ended: {}", ends.join(", "));
        let _ = writeln!(
            text,
            "told of {}, harmless {}, longest gap of control {:.1} ms, longest transfer {}",
            self.told,
            self.harmless,
            self.longest_gap_ms,
            (self.longest_transfer_ms).map_or("-".to_owned(), |ms| format!("{ms:.2} ms"))
        );
        for broken in &self.broken {
            let weakness = broken.weakness.as_deref();
            let known = weakness.map_or(String::new(), |name| format!(", known: scenario {name}"));
            let _ = writeln!(
                text,
                "\n# script {}: {}{known}\n# {}\n{}",
                broken.number,
                broken.breach,
                broken.command,
                broken.script.trim_end()
            );
        }
        let (all, new) = (self.broken.len(), self.surprises());
        let _ = writeln!(
            text,
            "{all} promises broken, {} by known weaknesses",
            all - new
        );
        text
    }
}

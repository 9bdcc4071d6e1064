//! The files of scenarios: scripts, and what is expected of the flight.

use std::path::{Path, PathBuf};

use reflex_config::{ConfigError, Document};
use serde::Deserialize;

use super::{AIRFRAME, ENVIRONMENT};
use crate::closed_loop::{Outcome, Scene, limits_of};
use crate::faults::{Entry, Script};
use crate::toolchain;

/// No scenario is longer, s.
const LONGEST_S: f64 = 3600.0;

/// A scenario as it is written.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Written {
    pub(super) name: String,
    #[serde(default = "airframe")]
    airframe: String,
    /// From take-off to the end, s.
    #[serde(default = "duration_s")]
    duration_s: f64,
    /// The firmware notices within this, ms; without it, it need not.
    pub(super) detected_ms: Option<f64>,
    /// A state that it enters.
    pub(super) state: Option<String>,
    /// Endings that are right.
    pub(super) outcome: Vec<Outcome>,
    /// Largest tilt on the way there, degrees.
    pub(super) tilt_deg: Option<f64>,
    /// Why the firmware is known not to do so.
    weakness: Option<String>,
    /// Control logics that it is a weakness of, in some flights; all, in every flight, without it.
    weak_logics: Option<Vec<String>>,
    /// Only the emulated board can play it.
    #[serde(default)]
    emulated: bool,
    /// Only the native tier can.
    #[serde(default)]
    native: bool,
    fault: Vec<Entry>,
}

fn airframe() -> String {
    AIRFRAME.to_owned()
}

/// The drone is up after ten seconds; most of what breaks then is over in ten more.
fn duration_s() -> f64 {
    20.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    scenario: Vec<Written>,
}

/// A scenario to fly.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    pub(super) written: Written,
    pub(super) script: Script,
    file: String,
}

impl Scenario {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.written.name
    }

    /// The name of its file, without the end.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// What it breaks, in the words of scripts.
    #[must_use]
    pub fn fault(&self) -> String {
        let faults: Vec<String> = self.written.fault.iter().map(Entry::to_string).collect();
        faults.join(", ")
    }

    pub(super) fn airframe(&self) -> &str {
        &self.written.airframe
    }

    /// Why it is known to fail with a logic.
    pub(super) fn weakness(&self, logic: &str) -> Option<&String> {
        let logics = self.written.weak_logics.as_ref();
        let is_weak = logics.is_none_or(|logics| logics.iter().any(|weak| weak == logic));
        self.written.weakness.as_ref().filter(|_| is_weak)
    }

    /// It is known to fail in every flight.
    pub(super) fn always_fails(&self) -> bool {
        self.written.weakness.is_some() && self.written.weak_logics.is_none()
    }

    /// It breaks one thing alone, and that in the way of a fault.
    pub(super) fn breaks_like(&self, fault: &Entry) -> bool {
        matches!(self.written.fault.as_slice(), [own] if own.is_like(fault))
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.written.duration_s
    }
}

/// All scenarios that a tier can play, in the order of their files.
///
/// # Errors
/// A file that cannot be read, or says what no flight can play: file and line.
pub fn read_all(is_native: bool) -> anyhow::Result<Vec<Scenario>> {
    let mut scenarios = Vec::new();
    for file in files()? {
        scenarios.extend(read(&file, is_native)?);
    }
    Ok(scenarios)
}

/// The scenarios of one file; errors as those of [`read_all`].
pub(crate) fn read(file: &Path, is_native: bool) -> anyhow::Result<Vec<Scenario>> {
    let document = Document::open(file)?;
    let content: File = document.parse()?;
    let mut scenarios = Vec::new();
    for (place, written) in content.scenario.into_iter().enumerate() {
        let elsewhere = match is_native {
            true => written.emulated,
            false => written.native,
        };
        if elsewhere {
            continue;
        }
        if !(1.0..=LONGEST_S).contains(&written.duration_s) {
            let line = format!(
                "{} is out of range, must be 1 to {LONGEST_S} s",
                written.duration_s
            );
            return Err(document
                .error_at(&format!("scenario.{place}.duration_s"), line)
                .into());
        }
        let scene = Scene::load(ENVIRONMENT, &written.airframe, None)?;
        let limits = limits_of(&scene, written.duration_s, is_native);
        let error = |fault: usize, key: &str, line| -> ConfigError {
            document.error_at(&format!("scenario.{place}.fault.{fault}.{key}"), line)
        };
        let script = Script::checked(&written.fault, &limits, error)?;
        let file = file.file_stem().unwrap_or_default().to_string_lossy();
        scenarios.push(Scenario {
            written,
            script,
            file: file.into_owned(),
        });
    }
    Ok(scenarios)
}

fn files() -> std::io::Result<Vec<PathBuf>> {
    let folder = toolchain::root().join("hil-tests/scenarios");
    let entries = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut files: Vec<PathBuf> = entries.collect::<std::io::Result<_>>()?;
    files.retain(|file| file.extension().is_some_and(|end| end == "toml"));
    files.sort();
    Ok(files)
}

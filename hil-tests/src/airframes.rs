//! This program, built for another airframe or with faster loops.
//!
//! The number of motors, their mixer and the gains are constants of the firmware, so each
//! [`Variant`] has a build of its own, kept beside the others. Only what depends on `reflex` is
//! built again; the emulator is not.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use anyhow::{Context, Result};
use reflex::config::{AIRFRAME, BANDWIDTH};
use reflex_config::plant::Vehicle;

use crate::firmware::executable;
use crate::progress::Progress;
use crate::refusal::Refusal;
use crate::toolchain;

/// How many times as fast as configured attitude and rate loops may be built.
pub const BANDWIDTHS: [f64; 5] = [1.0, 0.5, 0.7, 1.4, 2.0];

/// What is fixed by a build of this program.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Name of the airframe.
    pub airframe: String,
    /// One of [`BANDWIDTHS`].
    pub bandwidth: f64,
}

impl Variant {
    /// An airframe with the loops as they are configured.
    #[must_use]
    pub fn of(airframe: &str) -> Self {
        Self {
            airframe: airframe.to_owned(),
            bandwidth: 1.0,
        }
    }

    /// What this very program was built for.
    #[must_use]
    pub fn built_in(&self) -> bool {
        self.airframe == AIRFRAME && self.bandwidth as f32 == BANDWIDTH
    }

    /// Its name, also of the folder that its build is kept in.
    #[must_use]
    pub fn name(&self) -> String {
        if self.bandwidth == 1.0 {
            self.airframe.clone()
        } else {
            format!("{}_{}", self.airframe, self.bandwidth)
        }
    }
}

/// The airframes that can be flown: those with a vehicle.
///
/// # Errors
/// The folder cannot be read.
pub fn names() -> Result<Vec<String>> {
    Ok(Vehicle::names(&toolchain::root().join("config"))?)
}

/// A command that calls this program as a variant; builds that where it is not yet.
///
/// # Errors
/// An unknown airframe or bandwidth, with those that are known (a refusal); a build that fails.
pub fn program(variant: &Variant, progress: &mut dyn Progress) -> Result<Command> {
    let number = number(variant)?;
    let path = if variant.built_in() {
        // A copy, as the next build of another variant takes this program's name.
        keep(variant, &env::current_exe()?)?
    } else {
        progress.stage(&format!("Building for {}", variant.name()));
        build(variant, number, progress)?
    };
    let mut command = Command::new(path);
    // The firmware that it builds is of the same kind.
    chosen(variant, &mut command);
    Ok(command)
}

/// Chooses a variant for a build, before the files of `config/`.
fn chosen(variant: &Variant, command: &mut Command) {
    command
        .env("REFLEX_AIRFRAME", &variant.airframe)
        .env("REFLEX_BANDWIDTH", variant.bandwidth.to_string());
}

/// A number that no other variant has.
fn number(variant: &Variant) -> Result<usize> {
    let known = names()?;
    let Some(airframe) = known.iter().position(|name| *name == variant.airframe) else {
        return Err(Refusal::new(format!(
            "--airframe {}: must be one of {}",
            variant.airframe,
            known.join(", ")
        ))
        .into());
    };
    let mut bandwidths = BANDWIDTHS.iter();
    let Some(bandwidth) = bandwidths.position(|known| *known == variant.bandwidth) else {
        return Err(Refusal::new(format!(
            "--bandwidth {}: must be one of {BANDWIDTHS:?}",
            variant.bandwidth
        ))
        .into());
    };
    Ok(bandwidth * known.len() + airframe)
}

fn build(variant: &Variant, number: usize, progress: &mut dyn Progress) -> Result<PathBuf> {
    let mut build = toolchain::cargo();
    chosen(variant, &mut build);
    build
        .args(["build", "--profile", "hil", "--ignore-rust-version"])
        .args(["--package", "hil-tests", "--bin", "hil"])
        .arg("--message-format=json-render-diagnostics");
    // Cargo keeps builds apart that differ in a profile, not those that differ in a variable: with
    // a number of its own each variant is built once, and none in the place of another.
    let units = 17 + number;
    build.args([
        "--config",
        &format!("profile.hil.package.reflex.codegen-units={units}"),
    ]);
    let messages = toolchain::run(&mut build, progress)?;
    let built = executable(&messages, "hil").context("cargo named no program that it built")?;
    keep(variant, &built)
}

/// Copies a program to where no build of another variant takes its place.
fn keep(variant: &Variant, built: &Path) -> Result<PathBuf> {
    let kept = toolchain::root()
        .join("target/hil/variants")
        .join(variant.name())
        .join("hil");
    if built == kept {
        return Ok(kept);
    }
    if let Some(folder) = kept.parent() {
        fs::create_dir_all(folder)?;
    }
    let fresh = kept.with_extension("new");
    fs::copy(built, &fresh).with_context(|| built.display().to_string())?;
    fs::rename(&fresh, &kept)?;
    Ok(kept)
}

//! This program, built for an airframe: how many motors there are is fixed by the build.
//!
//! The number of motors and their mixer are constants of the firmware, so each airframe has a
//! build of its own, kept beside the others. Only what depends on `reflex` is built again; the
//! emulator is not.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

use anyhow::{Context, Result};
use cargo_metadata::Message;
use reflex::config::AIRFRAME;
use reflex_config::plant::Vehicle;

use crate::progress::Progress;
use crate::refusal::Refusal;
use crate::toolchain;

/// Chooses the airframe of a build, before `config/selection.toml`.
const VARIABLE: &str = "REFLEX_AIRFRAME";

/// The airframes that can be flown: those with a vehicle.
///
/// # Errors
/// The folder cannot be read.
pub fn names() -> Result<Vec<String>> {
    Ok(Vehicle::names(&toolchain::root().join("config"))?)
}

/// A command that calls this program as built for an airframe; builds it where it is not yet.
///
/// # Errors
/// An unknown name, with those that are known (a refusal); a build that fails.
pub fn program(airframe: &str, progress: &mut dyn Progress) -> Result<Command> {
    let known = names()?;
    let Some(place) = known.iter().position(|name| name == airframe) else {
        return Err(Refusal::new(format!(
            "--airframe {airframe}: must be one of {}",
            known.join(", ")
        ))
        .into());
    };
    let path = if airframe == AIRFRAME {
        env::current_exe()?
    } else {
        progress.stage(&format!("Building for {airframe}"));
        build(airframe, place, progress)?
    };
    let mut command = Command::new(path);
    // The firmware that it builds is for the same airframe.
    command.env(VARIABLE, airframe);
    Ok(command)
}

fn build(airframe: &str, place: usize, progress: &mut dyn Progress) -> Result<PathBuf> {
    let mut build = toolchain::cargo();
    build
        .env(VARIABLE, airframe)
        .args(["build", "--profile", "hil", "--ignore-rust-version"])
        .args(["--package", "hil-tests", "--bin", "hil"])
        .arg("--message-format=json-render-diagnostics");
    // Cargo keeps builds apart that differ in a profile, not those that differ in a variable: with
    // a number of its own each airframe is built once, and none in the place of another.
    let units = 17 + place;
    build.args([
        "--config",
        &format!("profile.hil.package.reflex.codegen-units={units}"),
    ]);
    let messages = toolchain::run(&mut build, progress)?;
    let built = Message::parse_stream(messages.as_slice())
        .flatten()
        .filter_map(|message| match message {
            Message::CompilerArtifact(artifact) if artifact.target.name == "hil" => {
                artifact.executable.map(PathBuf::from)
            }
            _ => None,
        })
        .last()
        .context("cargo named no program that it built")?;
    // The next build of any airframe takes that name again.
    let folder = built.with_file_name("airframes").join(airframe);
    fs::create_dir_all(&folder)?;
    let kept = folder.join("hil");
    let fresh = kept.with_extension("new");
    fs::copy(&built, &fresh).with_context(|| built.display().to_string())?;
    fs::rename(&fresh, &kept)?;
    Ok(kept)
}

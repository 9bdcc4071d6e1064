//! What both tiers replay: the flight, its chips, and how much of it.

use std::path::PathBuf;

use anyhow::Result;

use super::options::ReplayOptions;
use super::refusals;
use crate::faults::{Limits, Script};
use crate::mountings::mountings;
use chip_models::{ChipOptions, Present};
use recorded_flights::{Flight, Standstill, sample_flight};

/// Reads the flight that the options name, and refuses one that cannot be replayed with them.
pub(crate) fn open_flight(options: &ReplayOptions) -> Result<(Flight, PathBuf)> {
    let path = match &options.log {
        Some(path) => path.clone(),
        None => sample_flight()?,
    };
    let flight = Flight::read(&path, options.rotate)?;
    refusals::check(options, &flight, &path)?;
    Ok((flight, path))
}

/// The specimens of the chips that a flight is replayed with, the same in both tiers.
pub(crate) fn chip_options(flight: &Flight, options: &ReplayOptions) -> ChipOptions {
    ChipOptions {
        seed: u64::from(options.settings.seed),
        noise: options.noise,
        present: Present {
            magnetometer: flight.mag.is_some(),
            ..Present::default()
        },
        mountings: mountings(),
        ..ChipOptions::default()
    }
}

/// What breaks in a replay.
///
/// # Errors
/// A script that names what no replay of this flight can play, with file and line.
pub(crate) fn script(flight: &Flight, options: &ReplayOptions, is_native: bool) -> Result<Script> {
    let Some(file) = &options.faults else {
        return Ok(Script::default());
    };
    let limits = Limits {
        take_off_ns: Standstill::default().length_ns(),
        duration_s: length_ns(flight, options) as f64 / 1e9,
        motors: None,
        is_native,
    };
    Ok(Script::read(file, &limits)?)
}

/// How much of a flight is replayed, ns.
pub(crate) fn length_ns(flight: &Flight, options: &ReplayOptions) -> u64 {
    let longest_s = options.duration_s.unwrap_or(f64::INFINITY);
    (longest_s.min(flight.duration_s()) * 1e9) as u64
}

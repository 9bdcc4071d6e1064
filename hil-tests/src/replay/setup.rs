//! What both tiers replay: the flight, its chips, and how much of it.

use std::ops::Range;
use std::path::PathBuf;

use anyhow::Result;

use super::options::ReplayOptions;
use super::refusals;
use crate::faults::{Limits, Script};
use crate::flight_log::FlightLog;
use crate::mountings::mountings;
use chip_models::{ChipOptions, Present};
use recorded_flights::{Flight, Sensor, Standstill, sample_flight};

/// Reads the flight that the options name, and refuses one that cannot be replayed with them.
pub(crate) fn open_flight(options: &ReplayOptions) -> Result<(Flight, PathBuf)> {
    let path = match &options.log {
        Some(path) => path.clone(),
        None => sample_flight()?,
    };
    let flight = Flight::read(&path, options.reading.clone())?;
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

/// The log that a replay is written to, where it is.
pub(super) fn flight_log(options: &ReplayOptions) -> Result<Option<FlightLog>> {
    let create = |path| FlightLog::create(path, &options.start());
    options.record.as_deref().map(create).transpose()
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

/// What of a flight is not scored, in us of a clock that shows `start_us` at the flight's start: gaps
/// that are longer than a failsafe period, through which nobody knows what the sensors felt.
pub(crate) fn left_out(flight: &Flight, options: &ReplayOptions, start_us: u64) -> Vec<Range<u64>> {
    let failsafe_s = options.settings.failsafe.ticks() as f64 * 1e-6;
    let at_us = |s: f64| start_us.saturating_add_signed((s * 1e6) as i64);
    let long = flight.gaps.iter().filter(|gap| gap.length_s > failsafe_s);
    let inertial = long.filter(|gap| gap.sensor != Sensor::Magnetometer);
    let mut spans: Vec<Range<u64>> = Vec::new();
    for gap in inertial {
        let span = at_us(gap.at_s)..at_us(gap.at_s + gap.length_s);
        // Gaps of both sensors may overlap.
        match spans.last_mut() {
            Some(last) if span.start <= last.end => last.end = last.end.max(span.end),
            _ => spans.push(span),
        }
    }
    spans
}

//! A recorded flight through the unmodified firmware on the emulated board.
//!
//! ```text
//! log -> flight -> chips -> [ firmware on the board ] -> motor registers, call log, defmt
//!           \-> setpoints -> link frames -^                      |
//!                            the same calls, natively -> reference, mirror -> score
//! ```
//! What the firmware did is read from three independent sources: its motor registers, the
//! edges on its interrupt lines, and its call log. They are held against each other, and the
//! calls are made again on a native autopilot: a firmware whose registers do not hold the
//! command it computed, or that computes other bits than the host, fails the replay.

pub(crate) mod about;
pub(crate) mod alignment;
mod bench;
mod board_about;
mod call_stream;
mod latency;
pub(crate) mod observation;
pub(crate) mod sense;
pub(crate) mod story;
#[cfg(test)]
mod tests;

use anyhow::{Context, Result, bail};
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use reflex::settings::MotorProtocol;

use crate::firmware::Firmware;
use crate::progress::Progress;
use crate::refusal::Refusal;
use crate::replay_options::ReplayOptions;
use crate::scoring::{Report, score};
use chip_models::{ChipOptions, Present};
use emulated_board::Watched;
use recorded_flights::{Flight, sample_flight};

use alignment::{Alignment, update_period_ns};
use bench::HANDLERS;
pub(crate) use bench::TestBench;
use observation::Observation;
use story::Story;

/// Replays a flight and scores it.
///
/// # Errors
/// A flight that cannot be read, firmware that cannot be built, a fault of the board, or a
/// firmware that contradicts itself or the host.
pub fn replay(options: &ReplayOptions, progress: &mut dyn Progress) -> Result<Report> {
    let (flight, path) = open_flight(options)?;
    let defmt = open_defmt(options)?;
    let firmware = Firmware::build(options.logic, progress)?;
    let watches = HANDLERS.map(Watched::from).to_vec();
    let mut bench = TestBench::new(&flight, options, &firmware, watches)?;
    let mut observation = Observation::new(defmt, options.defmt.clone());
    progress.stage(&format!("Replaying {}", path.display()));
    bench.run(&mut observation, progress)?;
    let outcome = bench.finish(&mut observation)?;
    observation.check()?;
    check_motor_period(options.settings.motors, outcome.motor_period_ns)?;

    progress.stage("Scoring");
    let alignment = Alignment::of(&observation, options.settings.motors)?;
    let start_us = alignment.clock_us(bench.flight_start_ns());
    let story = Story::tell(
        &observation.calls,
        (options.settings, options.logic),
        start_us,
    )?;
    if story.runs_in_the_air == 0 {
        bail!(
            "{}: the firmware never armed: see its log with --defmt FILE",
            path.display()
        );
    }
    let rules = story.rules();
    let score = score(&story.flight, &rules, |rate_hz| story.fly_periodic(rate_hz));
    let about = board_about::BoardAbout {
        options,
        flight: &flight,
        firmware: &firmware,
        bench: &bench,
        observation: &observation,
        outcome: &outcome,
        alignment: &alignment,
        story: &story,
    };
    Ok(Report {
        about: about.tell(),
        score,
    })
}

/// Reads the flight that the options name, once it is known to be worth a replay.
pub(crate) fn open_flight(options: &ReplayOptions) -> Result<(Flight, PathBuf)> {
    let path = match &options.log {
        Some(path) => path.clone(),
        None => sample_flight()?,
    };
    let flight = Flight::read(&path, options.rotate)?;
    sense::check(options, &flight, &path)?;
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
        ..ChipOptions::default()
    }
}

/// How much of a flight is replayed, ns.
pub(crate) fn length_ns(flight: &Flight, options: &ReplayOptions) -> u64 {
    let longest_s = options.duration_s.unwrap_or(f64::INFINITY);
    (longest_s.min(flight.duration_s()) * 1e9) as u64
}

/// The timers must beat as the protocol says.
fn check_motor_period(protocol: MotorProtocol, period_ns: Option<u64>) -> Result<()> {
    let wanted_ns = update_period_ns(protocol);
    if period_ns != Some(wanted_ns) {
        bail!("the motors beat every {period_ns:?} ns, not every {wanted_ns} ns");
    }
    Ok(())
}

fn open_defmt(options: &ReplayOptions) -> Result<Option<BufWriter<File>>> {
    let Some(path) = &options.defmt else {
        return Ok(None);
    };
    let file = File::create(path)
        .map_err(|error| Refusal::new(format!("--defmt {}: {error}", path.display())))
        .context("the decoded log cannot be written")?;
    Ok(Some(BufWriter::new(file)))
}

//! A recorded flight through the autopilot, without a processor.
//!
//! It is some hundred times faster than the flight was.
//! Nothing is shared between flights and no thread is started: any number of flights may go on
//! at once, in threads of the caller.

mod report;
#[cfg(test)]
pub(crate) mod tests;

use std::sync::Arc;

use anyhow::{Result, bail};
use reflex::app::Stamped;
use reflex::reactive::{Fit, Labels};
use reflex::sensors::{Input, Inputs};
use reflex::settings::Policy;

use super::link_frames::schedule;
use super::options::ReplayOptions;
use super::refusals;
use super::setup::{chip_options, flight_log, left_out, length_ns, open_flight, script};
use super::timeline::Timeline;
use crate::faults::broken;
use crate::flight_log::FlightLog;
use crate::native::{NativeBoard, clock};
use crate::progress::{Progress, named};
use crate::record::Look;
use crate::refusal::Refusal;
use crate::scoring::{Report, Score, WithoutLeading};
use recorded_flights::{Flight, FlightStimulus, Setpoints, Standstill};

/// Virtual time between two looks at the chips' sample counters.
const STEP_NS: u64 = 20_000_000;

/// Flies a flight and returns every call of the autopilot, in order.
///
/// # Errors
/// A flight that cannot be replayed with these options.
pub fn fly(flight: &Flight, options: &ReplayOptions) -> Result<Vec<Stamped>> {
    refusals::check_flight(options, flight, &flight.name)?;
    let (mut board, end_ns) = boot(flight, &Setpoints::of(flight), options)?;
    board.run_until(end_ns);
    Ok(board.take_calls())
}

/// Flies a flight and scores it.
///
/// # Errors
/// As [`fly`]; and where the drone never armed.
pub fn fly_and_score(flight: &Flight, options: &ReplayOptions) -> Result<Score> {
    let calls = fly(flight, options)?;
    Ok(timeline(&calls, flight, options, &flight.name)?.score(None))
}

/// Flies a flight and scores it; also what every input learned.
///
/// # Errors
/// As [`fly_and_score`].
pub(crate) fn fly_and_learn(
    flight: &Flight,
    options: &ReplayOptions,
) -> Result<(Score, Vec<Learned>)> {
    let calls = fly(flight, options)?;
    let timeline = timeline(&calls, flight, options, &flight.name)?;
    let autopilot = timeline.mirror.autopilot();
    let learned = Input::ALL.map(|input| Learned {
        input,
        labels: *autopilot.labels(input),
        fit: autopilot.fit(input),
        threshold: autopilot.threshold(input),
    });
    Ok((timeline.score(None), learned.into()))
}

/// What an input learned by the end of a flight, in the firmware's units.
#[derive(Clone, Debug)]
pub(crate) struct Learned {
    pub(crate) input: Input,
    pub(crate) labels: Labels,
    pub(crate) fit: Fit,
    pub(crate) threshold: f32,
}

/// Flies a flight once more, without the inputs that know the command; `None` where none triggers.
pub(super) fn without_leading(
    flight: &Flight,
    options: &ReplayOptions,
) -> Result<Option<WithoutLeading>> {
    let mut settings = options.settings;
    for input in Input::ALL {
        if !Inputs::OF_AXES.contains(input) {
            settings.triggers = settings.triggers.without(input);
        }
    }
    if settings == options.settings || settings.policy != Policy::Reactive {
        return Ok(None);
    }
    let options = ReplayOptions {
        settings,
        ..options.clone()
    };
    let score = fly_and_score(flight, &options)?;
    Ok(Some(WithoutLeading::of(settings.triggers, &score)))
}

/// Reads a flight, flies and scores it: what `cargo hil replay --native` does.
///
/// # Errors
/// A flight that cannot be read or replayed with these options.
pub fn replay(options: &ReplayOptions, progress: &mut dyn Progress) -> Result<Report> {
    let (flight, path) = open_flight(options)?;
    progress.stage(&format!("Replaying {} natively", named(&path)));
    let setpoints = Setpoints::of(&flight);
    let (mut board, end_ns) = boot(&flight, &setpoints, options)?;
    let mut log = flight_log(options)?;
    let looks = watch(&mut board, end_ns, log.as_mut(), progress)?;
    if let Some(log) = log {
        log.finish()?;
    }
    let calls = board.take_calls();

    progress.stage("Scoring");
    let timeline = timeline(&calls, &flight, options, &path.display().to_string())?;
    Ok(Report {
        run: report::report(options, &flight, &setpoints, &timeline, &board, &looks),
        score: timeline.score(None),
        without_leading: without_leading(&flight, options)?,
    })
}

/// A board that stands at the beginning, and when the flight ends.
///
/// # Errors
/// Those of its script of faults.
fn boot(
    flight: &Flight,
    setpoints: &Setpoints,
    options: &ReplayOptions,
) -> Result<(NativeBoard, u64)> {
    let at_rest = Standstill::default();
    let faults = script(flight, options, true)?;
    let source = broken(Arc::new(FlightStimulus::new(flight, at_rest)), &faults);
    let end_ns = at_rest.length_ns() + length_ns(flight, options);
    let mut frames = schedule(flight, setpoints, at_rest, &faults);
    frames.retain(|frame| frame.at_ns < end_ns);
    let chip_options = chip_options(flight, options);
    let mut board = NativeBoard::boot(&options.start(), &source, chip_options, frames);
    board.disturb(&faults);
    Ok((board, end_ns))
}

/// Runs to the end, looks at the chips on the way, and writes the flight down where it is to be.
fn watch(
    board: &mut NativeBoard,
    end_ns: u64,
    mut log: Option<&mut FlightLog>,
    progress: &mut dyn Progress,
) -> Result<Vec<Look>> {
    let start_ns = Standstill::default().length_ns();
    let seconds = |at_ns: u64| at_ns.saturating_sub(start_ns) as f64 * 1e-9;
    let mut looks = Vec::new();
    let mut at_ns = 0;
    while at_ns < end_ns {
        at_ns = (at_ns + STEP_NS).min(end_ns);
        board.run_until(at_ns);
        if let Some(log) = &mut log {
            log.follow(board.calls())?;
        }
        looks.push(Look {
            at_ns,
            chips: board.look_at_chips(),
        });
        progress.done(seconds(at_ns), seconds(end_ns));
    }
    Ok(looks)
}

fn timeline<'c>(
    calls: &'c [Stamped],
    flight: &Flight,
    options: &ReplayOptions,
    name: &str,
) -> Result<Timeline<'c>> {
    let start_us = clock(Standstill::default().length_ns()).ticks();
    let left_out = left_out(flight, options, start_us);
    let timeline = Timeline::of(calls, &options.start(), start_us, left_out)?;
    if timeline.runs_in_the_air == 0 {
        bail!(Refusal::new(format!("{name}: the drone never armed")));
    }
    Ok(timeline)
}

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

mod latency;
mod learning;
mod report;
mod session;
#[cfg(test)]
mod tests;

use anyhow::{Result, bail};
use reflex::settings::MotorProtocol;

use super::native::without_leading;
use super::options::ReplayOptions;
use super::setup::{flight_log, left_out, open_flight, script};
use super::timeline::Timeline;
use crate::firmware::Firmware;
use crate::flight_log::FlightLog;
use crate::progress::{Progress, named};
use crate::record::motor_timers::update_period_ns;
use crate::record::{Alignment, Counted, CountedFrom, DecodedLog, Observation, WAY};
use crate::scoring::Report;
use emulated_board::Watched;

use learning::Learning;
use report::BoardEvidence;
pub(crate) use session::Session;

/// Replays a flight and scores it.
///
/// # Errors
/// A flight that cannot be read, firmware that cannot be built, a fault of the board, or a
/// firmware that contradicts itself or the host.
pub fn replay(options: &ReplayOptions, progress: &mut dyn Progress) -> Result<Report> {
    Ok(whole(options, false, progress)?.report)
}

/// A replay whose instructions were counted.
pub(crate) struct Replayed {
    pub(crate) report: Report,
    pub(crate) firmware: Firmware,
    /// The instructions behind the warm-up; none where it lasted to the end.
    pub(crate) counted: Option<Counted>,
}

/// The same, and counts the instructions from the end of the warm-up.
///
/// # Errors
/// As those of [`replay`].
pub(crate) fn replay_counted(
    options: &ReplayOptions,
    progress: &mut dyn Progress,
) -> Result<Replayed> {
    whole(options, true, progress)
}

fn whole(options: &ReplayOptions, counts: bool, progress: &mut dyn Progress) -> Result<Replayed> {
    let (flight, path) = open_flight(options)?;
    let log = options
        .defmt
        .as_deref()
        .map(DecodedLog::create)
        .transpose()?;
    // A script that is refused is so before anything is built.
    script(&flight, options, false)?;
    let flight_log = flight_log(options)?;
    let firmware = Firmware::build(options.gains.logic(), progress)?;
    let watches = WAY.map(Watched::from).to_vec();
    let mut session = Session::new(&flight, options, &firmware, watches)?;
    let mut observation = Observation::new(log);
    progress.stage(&format!("Replaying {}", named(&path)));
    let learning = counts.then(|| Learning::new(&options.start(), session.flight_start_ns()));
    let counted_from = run(
        &mut session,
        &mut observation,
        flight_log,
        learning,
        progress,
    )?;
    let outcome = session.finish(&mut observation)?;
    observation.check()?;
    check_motor_period(options.settings.motors, outcome.motor_period_ns)?;

    progress.stage("Scoring");
    let alignment = Alignment::of(&observation, options.settings.motors)?;
    let start_us = alignment.clock_us(session.flight_start_ns());
    let left_out = left_out(&flight, options, start_us);
    let timeline = Timeline::of(&observation.calls, &options.start(), start_us, left_out)?;
    if timeline.runs_in_the_air == 0 {
        bail!(
            "{}: the firmware never armed: see its log with --defmt FILE",
            path.display()
        );
    }
    let evidence = BoardEvidence {
        options,
        flight: &flight,
        firmware: &firmware,
        session: &session,
        observation: &observation,
        outcome: &outcome,
        alignment: &alignment,
        timeline: &timeline,
    };
    let run = evidence.report();
    let busy = run.cpu.as_ref().and_then(|cpu| cpu.busy_fraction);
    let report = Report {
        run,
        score: timeline.score(busy),
        without_leading: without_leading(&flight, options)?,
    };
    let counted = counted_from.and_then(|from| from.to_end(&observation, &outcome));
    Ok(Replayed {
        report,
        firmware,
        counted,
    })
}

/// Runs to the end, and writes the flight down where it is to be.
///
/// Instructions are counted from where learning is over, where it is watched.
fn run(
    session: &mut Session,
    observation: &mut Observation,
    mut log: Option<FlightLog>,
    mut learning: Option<Learning>,
    progress: &mut dyn Progress,
) -> Result<Option<CountedFrom>> {
    let (mut counted_from, mut goes_on) = (None, true);
    while goes_on {
        goes_on = session.step(observation, progress)?;
        if let Some(log) = &mut log {
            log.follow(&observation.calls)?;
        }
        if let Some(learning) = &mut learning
            && goes_on
            && counted_from.is_none()
            && learning.is_over(observation, session.now_ns())?
        {
            counted_from = session.count(observation);
        }
    }
    log.map_or(Ok(()), FlightLog::finish)?;
    Ok(counted_from)
}

/// The timers must update as the protocol says.
fn check_motor_period(protocol: MotorProtocol, period_ns: Option<u64>) -> Result<()> {
    let wanted_ns = update_period_ns(protocol);
    if period_ns != Some(wanted_ns) {
        bail!("the motors beat every {period_ns:?} ns, not every {wanted_ns} ns");
    }
    Ok(())
}

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
mod report;
mod session;
#[cfg(test)]
mod tests;

use anyhow::{Result, bail};
use reflex::settings::MotorProtocol;

use super::options::ReplayOptions;
use super::setup::open_flight;
use super::timeline::Timeline;
use crate::firmware::Firmware;
use crate::progress::Progress;
use crate::record::motor_timers::update_period_ns;
use crate::record::{Alignment, DecodedLog, HANDLERS, Observation};
use crate::scoring::Report;
use emulated_board::Watched;

use report::BoardEvidence;
pub(crate) use session::Session;

/// Replays a flight and scores it.
///
/// # Errors
/// A flight that cannot be read, firmware that cannot be built, a fault of the board, or a
/// firmware that contradicts itself or the host.
pub fn replay(options: &ReplayOptions, progress: &mut dyn Progress) -> Result<Report> {
    let (flight, path) = open_flight(options)?;
    let log = options
        .defmt
        .as_deref()
        .map(DecodedLog::create)
        .transpose()?;
    let firmware = Firmware::build(options.gains.logic(), progress)?;
    let watches = HANDLERS.map(Watched::from).to_vec();
    let mut session = Session::new(&flight, options, &firmware, watches)?;
    let mut observation = Observation::new(log);
    progress.stage(&format!("Replaying {}", path.display()));
    session.run(&mut observation, progress)?;
    let outcome = session.finish(&mut observation)?;
    observation.check()?;
    check_motor_period(options.settings.motors, outcome.motor_period_ns)?;

    progress.stage("Scoring");
    let alignment = Alignment::of(&observation, options.settings.motors)?;
    let start_us = alignment.clock_us(session.flight_start_ns());
    let timeline = Timeline::of(&observation.calls, &options.start(), start_us)?;
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
    Ok(Report {
        run: evidence.report(),
        score: timeline.score(),
    })
}

/// The timers must update as the protocol says.
fn check_motor_period(protocol: MotorProtocol, period_ns: Option<u64>) -> Result<()> {
    let wanted_ns = update_period_ns(protocol);
    if period_ns != Some(wanted_ns) {
        bail!("the motors beat every {period_ns:?} ns, not every {wanted_ns} ns");
    }
    Ok(())
}

//! Closed loop: the autopilot flies a simulated drone in wind.
//!
//! ```text
//!   mission --> station --link--> [ autopilot on its board ] --pulses--> drone in wind
//!      ^          ^                         ^                               |
//!      +----------+-------------------------+--- chips <-- motion <---------+
//! ```
//! The drone is that of the crate `flight-dynamics`, which knows nothing of the firmware. The
//! autopilot is the unmodified firmware on the emulated board, or the same code natively; either
//! reads the register-level chip models, and its pulses move the drone from the instant that a
//! timer's update event applies them.
//!
//! **Lockstep**: the world goes one step ahead with the commands in force, then the board follows
//! through the same step and feels it. A step ends at an update event of the motors' timers, before
//! any command that is still to come can apply, so that none comes late. Virtual time alone counts: the same
//! options give the same flight, bit for bit.

mod battery_report;
mod battery_watch;
mod bent_field;
pub mod contention;
mod desired;
mod emulated;
mod fault_report;
mod fault_watch;
mod flight_report;
mod flying_board;
mod measures;
mod mission;
mod native;
mod outer_loop;
pub mod plot;
pub mod report;
mod sensed_motion;
mod simulated_flight;
mod station;
#[cfg(test)]
pub(crate) mod tests;
pub mod track;
mod tracker;
mod world;

use std::path::PathBuf;

use anyhow::Result;
use reflex::settings::Settings;
use reflex_config::Airframe;
use reflex_config::plant::{Environment, Tracking, Vehicle};

use crate::faults::{Limits, Script};
use crate::firmware::Firmware;
use crate::logics::GainSet;
use crate::progress::Progress;
use crate::record::Counted;

pub use battery_report::BatteryReport;
use contention::Contention;
pub use fault_report::{FaultReport, Outcome};
pub use mission::Mission;
use report::FlightReport;
use simulated_flight::SimulatedFlight;
use track::Moment;

/// Seconds of flight between two reports of progress.
const PROGRESS_PERIOD_S: f64 = 0.5;

/// What flies the drone.
#[derive(Clone, Copy, Debug)]
pub enum Flyer<'f> {
    /// The autopilot as a library, without a processor.
    Native,
    /// The firmware on the emulated board.
    Emulated(Core<'f>),
}

/// The emulated core that flies.
#[derive(Clone, Copy, Debug)]
pub struct Core<'f> {
    /// What it executes.
    pub firmware: &'f Firmware,
    /// How fast it is.
    pub mhz: u32,
    /// The instructions of the scored part are counted, for [`Flown::counted`].
    pub counts: bool,
}

impl<'f> Core<'f> {
    /// The processor's own speed, nothing counted.
    #[must_use]
    pub const fn of(firmware: &'f Firmware) -> Self {
        Self {
            firmware,
            mhz: 168,
            counts: false,
        }
    }
}

/// The drone and its surroundings.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the environment.
    pub environment_name: String,
    /// The environment.
    pub environment: Environment,
    /// How the drone's place is known.
    pub position_name: String,
    /// What is reported of it.
    pub tracking: Tracking,
    /// The drone as a body.
    pub vehicle: Vehicle,
    /// Name of the airframe.
    pub airframe_name: String,
    /// Where its motors are.
    pub airframe: Airframe,
}

impl Scene {
    /// An airframe in an environment, both of the configuration; its place is known as the
    /// environment says where no other way is named.
    ///
    /// # Errors
    /// An unknown name, with those that are known; a file with something wrong in it.
    pub fn load(environment: &str, airframe: &str, position: Option<&str>) -> Result<Self> {
        let config = crate::toolchain::root().join("config");
        let (vehicle, of_motors) = Vehicle::load(&config, airframe)?;
        let environment_name = environment.to_owned();
        let environment = Environment::load(&config, environment)?;
        let position_name = position.unwrap_or(&environment.position).to_owned();
        Ok(Self {
            tracking: Tracking::load(&config, &position_name)?,
            position_name,
            environment_name,
            environment,
            vehicle,
            airframe_name: airframe.to_owned(),
            airframe: of_motors,
        })
    }
}

/// What the script of a flight may do.
#[must_use]
pub fn limits_of(scene: &Scene, duration_s: f64, is_native: bool) -> Limits {
    Limits {
        take_off_ns: station::TAKE_OFF_NS,
        duration_s,
        motors: Some(scene.airframe.motors.len()),
        is_native,
    }
}

/// What is flown, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct FlyOptions {
    /// The gains of the control logic, which say its name.
    pub gains: GainSet,
    /// The autopilot's settings; its seed is that of everything.
    pub settings: Settings,
    /// What the drone is to do.
    pub mission: Mission,
    /// From take-off to the end, s.
    pub duration_s: f64,
    /// Where the scored part begins, s from take-off; none for as soon as the drone is up and
    /// has learned.
    pub scored_from_s: Option<f64>,
    /// How the drone differs from the one that the gains are for.
    pub stress: Stress,
    /// How control shares the processor.
    pub contention: Contention,
    /// What breaks in flight.
    pub faults: Script,
    /// Where the flight is written, for other tools.
    pub record: Option<PathBuf>,
}

/// A drone that answers more strongly or later, by which margins are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress {
    /// How many times the angular acceleration that its motors give it.
    pub gain: f64,
    /// How much later motor commands apply, s.
    pub delay_s: f64,
}

impl Default for Stress {
    /// None.
    fn default() -> Self {
        Self {
            gain: 1.0,
            delay_s: 0.0,
        }
    }
}

/// Flies and reports: a crash is a report as well.
///
/// # Errors
/// A fault of the board, firmware that contradicts itself or the host, parameters that describe
/// no drone, dynamics that diverged.
pub fn fly(
    scene: &Scene,
    options: &FlyOptions,
    flyer: Flyer<'_>,
    progress: &mut dyn Progress,
) -> Result<Flown> {
    let mut flight = SimulatedFlight::new(scene, options, flyer)?;
    let mut reported_s = 0.0;
    while flight.goes_on() {
        flight.step()?;
        if flight.since_take_off_s() >= reported_s {
            reported_s += PROGRESS_PERIOD_S;
            progress.done(flight.since_take_off_s(), options.duration_s);
        }
    }
    flight.end_log()?;
    let track = std::mem::take(&mut flight.track);
    let (report, counted) = flight.report(scene, flyer)?;
    Ok(Flown {
        report,
        track,
        counted,
    })
}

/// The result of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// Every number.
    pub report: FlightReport,
    /// The drone every 0.1 s from take-off.
    pub track: Vec<Moment>,
    /// The instructions of the scored part, where they were to be counted.
    pub counted: Option<Counted>,
}

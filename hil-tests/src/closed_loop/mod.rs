//! Closed loop: the autopilot flies a simulated drone in wind.
//!
//! ```text
//!   mission --> station --link--> [ autopilot on its board ] --pulses--> drone in wind
//!      ^          ^                         ^                               |
//!      +----------+-------------------------+--- chips <--- felt <----------+
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

mod desired;
mod emulated;
mod felt;
mod measures;
mod mission;
mod native;
mod outer_loop;
pub mod plot;
pub mod report;
mod station;
#[cfg(test)]
mod tests;
mod tier;
pub mod track;
mod world;

use std::num::NonZeroU64;
use std::sync::Arc;

use anyhow::{Context, Result};
use reflex::graph::ControlLogic;
use reflex::reactive::Phase;
use reflex::settings::{Policy, Settings};
use reflex_config::Airframe;
use reflex_config::plant::{Environment, Vehicle};

use crate::chips::{ChipOptions, StimulusSource};
use crate::firmware::Firmware;
use crate::logics::LogicName;
use crate::progress::Progress;

use desired::Desired;
use emulated::EmulatedTier;
use measures::Measures;
pub use mission::Mission;
use mission::{Course, Target};
use native::NativeTier;
use report::{AxisErrors, Control, CrashReport, FlightReport};
use station::{Station, TAKE_OFF_NS};
use tier::{Tier, update_period_ns};
use track::{KEPT_NS, Moment};
use world::{LONGEST_STEP_NS, World};

/// Time between two looks of mission, ground station and measures, ns.
const LOOK_NS: u64 = 10_000_000;
/// The scored part begins this long behind take-off at the soonest, s: the drone is up by then.
const UP_S: f64 = 10.0;
/// What is left in the battery where flight time ends (Bregu et al. 2016, section 7.1).
const RESERVE: f64 = 0.2;
/// Seconds between two words to a progress bar.
const TOLD_S: f64 = 0.5;

/// What flies the drone.
#[derive(Clone, Copy, Debug)]
pub enum Flyer<'f> {
    /// The autopilot as a library, without a processor.
    Native,
    /// The firmware on the emulated board, its core so many MHz fast.
    Emulated(&'f Firmware, u32),
}

/// The drone and its surroundings.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the environment.
    pub environment_name: String,
    /// The environment.
    pub environment: Environment,
    /// The drone as a body.
    pub vehicle: Vehicle,
    /// Where its motors are: the airframe that this program was built for.
    pub airframe: Airframe,
}

impl Scene {
    /// The airframe that this program was built for, in an environment of the configuration.
    ///
    /// # Errors
    /// An unknown name, with those that are known; a file with something wrong in it.
    pub fn load(environment: &str) -> Result<Self> {
        let config = crate::toolchain::root().join("config");
        let (vehicle, airframe) = Vehicle::load(&config, reflex::config::AIRFRAME)?;
        Ok(Self {
            environment_name: environment.to_owned(),
            environment: Environment::load(&config, environment)?,
            vehicle,
            airframe,
        })
    }
}

/// What is flown, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct FlyOptions {
    /// The control logic.
    pub logic: LogicName,
    /// What the autopilot is told; its seed is that of everything.
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
}

/// A drone that answers more strongly, or later: what gain and delay margins are measured with.
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

/// Flies, and tells what came of it: a crash is a report as well.
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
    let mut flight = Flight::new(scene, options, flyer)?;
    let mut told_s = 0.0;
    while flight.goes_on() {
        flight.step()?;
        if flight.since_take_off_s() >= told_s {
            told_s += TOLD_S;
            progress.done(flight.since_take_off_s(), options.duration_s);
        }
    }
    let track = std::mem::take(&mut flight.track);
    let report = flight.tell(scene, options, flyer)?;
    Ok(Flown { report, track })
}

/// What came of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// Every number.
    pub report: FlightReport,
    /// The drone every 0.1 s from take-off.
    pub track: Vec<Moment>,
}

/// A flight under way.
struct Flight<'o> {
    options: &'o FlyOptions,
    world: World,
    tier: Box<dyn Tier>,
    course: Course,
    station: Station,
    measures: Measures,
    track: Vec<Moment>,
    scored: Option<Scored>,
    now_ns: u64,
    end_ns: u64,
    step_ns: u64,
    applied: Vec<tier::Applied>,
    runs: Vec<tier::TimedRan>,
}

/// How things stood where the scored part began.
struct Scored {
    from_ns: u64,
    energy_j: f64,
    charge: f64,
    wind_sum: f64,
    looks: u64,
}

impl<'o> Flight<'o> {
    fn new(scene: &Scene, options: &'o FlyOptions, flyer: Flyer<'_>) -> Result<Self> {
        let seed = u64::from(options.settings.seed);
        let mut vehicle = scene.vehicle.clone();
        vehicle.inertia_kg_m2 = vehicle.inertia_kg_m2.map(|axis| axis / options.stress.gain);
        let world = World::new((&vehicle, &scene.airframe), &scene.environment, seed)?;
        let source: Arc<dyn StimulusSource> = Arc::clone(&world.felt) as _;
        let told = (options.settings, options.logic);
        let chips = ChipOptions {
            seed,
            noise: true,
            ..ChipOptions::default()
        };
        let tier: Box<dyn Tier> = match flyer {
            Flyer::Native => Box::new(NativeTier::boot(told, &source, chips)),
            Flyer::Emulated(firmware, mhz) => {
                let speed = NonZeroU64::new(u64::from(mhz) * 1_000_000).context("no clock")?;
                Box::new(EmulatedTier::boot(firmware, told, &source, chips, speed)?)
            }
        };
        let flies_to_goals = options.logic.logic().flies_to_goals();
        Ok(Self {
            options,
            world,
            tier,
            course: Course::new(options.mission, scene.environment.area_m, seed),
            station: Station::new(flies_to_goals, &scene.environment.position, seed),
            measures: Measures::default(),
            track: Vec::new(),
            scored: None,
            now_ns: 0,
            end_ns: TAKE_OFF_NS + (options.duration_s * 1e9) as u64,
            step_ns: update_period_ns(options.settings.motors).min(LONGEST_STEP_NS / 2),
            applied: Vec::new(),
            runs: Vec::new(),
        })
    }

    fn goes_on(&self) -> bool {
        self.now_ns < self.end_ns && self.end().is_none()
    }

    fn since_take_off_s(&self) -> f64 {
        (self.now_ns as f64 - TAKE_OFF_NS as f64) * 1e-9
    }

    fn step(&mut self) -> Result<()> {
        let next_ns = self.next_ns();
        self.world.advance_to(next_ns)?;
        self.tier.run_until(next_ns)?;
        let passes = |mark_ns: u64| next_ns / mark_ns > self.now_ns / mark_ns;
        let (looks, keeps) = (passes(LOOK_NS), passes(KEPT_NS));
        self.now_ns = next_ns;
        self.tier.take(&mut self.applied, &mut self.runs);
        let delay_ns = (self.options.stress.delay_s * 1e9) as u64;
        for mut applied in self.applied.drain(..) {
            applied.at_ns += delay_ns;
            self.world.command(applied);
        }
        for (at_ns, ran) in self.runs.drain(..) {
            let since_s = (at_ns as f64 - TAKE_OFF_NS as f64) * 1e-9;
            let scored = self.scored.is_some();
            let quantum = self.options.settings.quantum;
            self.measures.ran(&ran, since_s, scored, quantum);
        }
        if looks {
            self.look(keeps && next_ns >= TAKE_OFF_NS);
        }
        Ok(())
    }

    /// Where the next step ends: at an update event of the motors' timers, and before any command
    /// applies that is not given yet.
    fn next_ns(&self) -> u64 {
        let offset_ns = self.tier.update_offset_ns() % self.step_ns;
        let begun = (self.now_ns + self.step_ns - offset_ns) / self.step_ns;
        let next_ns = (begun * self.step_ns + offset_ns).max(self.now_ns + 1);
        let soonest_ns = self.tier.soonest_command_ns();
        let further_ns = (next_ns + self.step_ns).min(self.now_ns + LONGEST_STEP_NS);
        if further_ns <= soonest_ns {
            further_ns
        } else {
            next_ns
        }
    }

    /// Mission, ground station and measures, each with the drone as it is now.
    fn look(&mut self, keeps: bool) {
        let state = self.world.state();
        let (position, velocity) = (state.position, state.velocity);
        if self.now_ns >= TAKE_OFF_NS {
            self.course.advance(LOOK_NS as f64 * 1e-9, &position);
        }
        let target = self.course.target();
        let frames = self
            .station
            .speak(self.now_ns, (&position, &velocity), &target);
        for frame in frames {
            self.tier.transmit(frame);
        }
        let desired = self.tier.desired();
        if keeps {
            self.keep(&target, &desired);
        }
        self.judge(&target, &desired);
    }

    fn keep(&mut self, target: &Target, desired: &Desired) {
        let angles = self.world.angles();
        self.track.push(Moment {
            at_s: self.since_take_off_s(),
            position: self.world.state().position,
            target: target.position,
            angles_deg: angles.map(f64::to_degrees),
            off_deg: desired.less(angles).map(|off| off.map(f64::to_degrees)),
            wind_m_s: self.world.air.norm(),
        });
    }

    fn judge(&mut self, target: &Target, desired: &Desired) {
        let state = self.world.state();
        if self.scored.is_none() && self.begins_to_count() {
            self.scored = Some(Scored {
                from_ns: self.now_ns,
                energy_j: state.energy_used,
                charge: state.state_of_charge,
                wind_sum: 0.0,
                looks: 0,
            });
        }
        let Some(scored) = &mut self.scored else {
            return;
        };
        scored.wind_sum += self.world.air.norm();
        scored.looks += 1;
        let state = self.world.state();
        let (position, rates) = (state.position, state.rates);
        let angles = self.world.angles();
        self.measures.look(desired, angles, (target, &position));
        self.measures.turning.add(rates.norm());
    }

    fn begins_to_count(&self) -> bool {
        match self.options.scored_from_s {
            Some(from_s) => self.since_take_off_s() >= from_s,
            None => self.since_take_off_s() >= UP_S && self.tier.phase() != Phase::WarmUp,
        }
    }

    fn tell(self, scene: &Scene, options: &FlyOptions, flyer: Flyer<'_>) -> Result<FlightReport> {
        let crash = self.crash();
        let duration_s = self.since_take_off_s().max(0.0);
        let state = self.world.state();
        let (energy_j, charge) = (state.energy_used, state.state_of_charge);
        let whole = self.scored.as_ref().filter(|_| crash.is_none());
        let length_s = whole.map(|scored| (self.now_ns - scored.from_ns) as f64 * 1e-9);
        let power_w = whole
            .zip(length_s)
            .map(|(scored, length_s)| (energy_j - scored.energy_j) / length_s);
        let flight_time_s = whole
            .zip(length_s)
            .map(|(scored, length_s)| (1.0 - RESERVE) * length_s / (scored.charge - charge));
        let degrees = |axis: usize| {
            let error = self.measures.attitude[axis].value()?;
            whole.map(|_| error.to_degrees())
        };
        let runs = self.measures.runs();
        let share = 1.0 - self.measures.changed as f64 / runs as f64;
        let control = Control {
            rate_hz: length_s.map(|length_s| runs as f64 / length_s),
            runs,
            unchanged_share: (runs > 0).then_some(share),
            by_reason: self.measures.by_reason,
            per_second: self.measures.per_second.clone(),
        };
        let errors = AxisErrors {
            roll: degrees(0),
            pitch: degrees(1),
            yaw: degrees(2),
        };
        let position_error_m = whole.and_then(|_| self.measures.position.value());
        let wind_m_s = whole.map(|scored| scored.wind_sum / scored.looks as f64);
        let scored_from_s =
            (self.scored.as_ref()).map(|scored| (scored.from_ns - TAKE_OFF_NS) as f64 * 1e-9);
        let from_ns = self.scored.as_ref().map_or(0, |scored| scored.from_ns);
        let (cpu, digest) = self.tier.finish(from_ns)?;
        let (tier, clock_mhz) = match flyer {
            Flyer::Native => ("native", 168),
            Flyer::Emulated(_, mhz) => ("emulated", mhz),
        };
        let (policy, rate_hz) = match options.settings.policy {
            Policy::Reactive => ("reactive", None),
            Policy::Periodic(period) => ("periodic", Some(1e6 / period.ticks() as f64)),
        };
        Ok(FlightReport {
            environment: scene.environment_name.clone(),
            airframe: reflex::config::AIRFRAME.to_owned(),
            bandwidth: (f64::from(reflex::config::BANDWIDTH) * 100.0).round() / 100.0,
            logic: options.logic.word().to_owned(),
            mission: options.mission.name().to_owned(),
            tier: tier.to_owned(),
            policy: policy.to_owned(),
            rate_hz,
            clock_mhz,
            seed: options.settings.seed,
            duration_s,
            scored_from_s,
            crashed: crash.is_some(),
            crash,
            attitude_error_deg: errors,
            position_error_m,
            turning_rad_s: whole.and_then(|_| self.measures.turning.value()),
            control,
            cpu,
            energy_j,
            energy_per_minute_j: power_w.map(|power| power * 60.0),
            flight_time_s,
            wind_m_s,
            digest,
        })
    }

    /// What ended the flight before its time, and when in ns.
    fn end(&self) -> Option<(u64, String)> {
        let drone = self.world.drone();
        let crash = drone.crash().map(|crash| {
            let tilt = crash.tilt.to_degrees();
            let what = format!(
                "hit the ground at {:.1} m/s, tilted by {tilt:.0} degrees,",
                crash.speed
            );
            (crash.at_ns, what)
        });
        crash.or_else(|| Some((drone.upset()?, "turned over".to_owned())))
    }

    fn crash(&self) -> Option<CrashReport> {
        let (at_ns, what) = self.end()?;
        let state = self.world.state();
        Some(CrashReport {
            at_s: (at_ns as f64 - TAKE_OFF_NS as f64) * 1e-9,
            what,
            position_m: state.position.into(),
            velocity_m_s: state.velocity.into(),
            attitude_deg: self.world.angles().map(f64::to_degrees),
        })
    }
}

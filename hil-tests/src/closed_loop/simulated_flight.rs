//! A flight under way: world and autopilot in lockstep, looked at every 10 ms.

use std::sync::Arc;

use anyhow::Result;
use reflex::graph::ControlLogic;
use reflex::reactive::Phase;

use super::battery_watch::BatteryWatch;
use super::contention::Processor;
use super::desired::Desired;
use super::emulated::FlyingEmulatedBoard;
use super::fault_watch::FaultWatch;
use super::flying_board::{FlyingBoard, News};
use super::measures::Measures;
use super::mission::{Course, Target};
use super::native::FlyingNativeBoard;
use super::station::{Station, TAKE_OFF_NS};
use super::track::{KEPT_NS, Moment};
use super::world::{LONGEST_STEP_NS, World};
use super::{FlyOptions, Flyer, Scene};
use crate::faults::broken;
use crate::flight_log::FlightLog;
use crate::logics::Start;
use crate::mountings::mountings;
use crate::record::motor_timers::update_period_ns;
use chip_models::{ChipOptions, ZeroRate};

/// Time between two looks of mission, ground station and measures, ns.
const LOOK_NS: u64 = 10_000_000;
/// The scored part begins this long behind take-off at the soonest, s: the drone is up by then.
const UP_S: f64 = 10.0;

/// A flight under way.
pub(super) struct SimulatedFlight<'o> {
    pub(super) options: &'o FlyOptions,
    pub(super) world: World,
    pub(super) board: Box<dyn FlyingBoard>,
    course: Course,
    station: Station,
    processor: Processor,
    pub(super) measures: Measures,
    /// Where something is to break.
    pub(super) watch: Option<FaultWatch>,
    pub(super) battery: BatteryWatch,
    pub(super) track: Vec<Moment>,
    pub(super) scored: Option<Scored>,
    pub(super) now_ns: u64,
    end_ns: u64,
    step_ns: u64,
    news: News,
    log: Option<FlightLog>,
}

/// The scored part so far.
pub(super) struct Scored {
    pub(super) from: Standing,
    pub(super) to: Standing,
    pub(super) wind_sum: f64,
    pub(super) looks: u64,
}

/// How things stood at an instant.
#[derive(Clone, Copy)]
pub(super) struct Standing {
    pub(super) at_ns: u64,
    pub(super) energy_j: f64,
    pub(super) charge: f64,
}

impl<'o> SimulatedFlight<'o> {
    pub(super) fn new(scene: &Scene, options: &'o FlyOptions, flyer: Flyer<'_>) -> Result<Self> {
        let seed = u64::from(options.settings.seed);
        let mut vehicle = scene.vehicle.clone();
        vehicle.inertia_kg_m2 = vehicle.inertia_kg_m2.map(|axis| axis / options.stress.gain);
        let world = World::new((&vehicle, &scene.airframe), &scene.environment, seed)?;
        let source = broken(Arc::clone(&world.sensed) as _, &options.faults);
        let start = Start {
            settings: options.settings,
            airframe: scene.airframe.geometry(),
            gains: options.gains.values(),
        };
        let chips = ChipOptions {
            seed,
            noise: true,
            zero_rate: ZeroRate {
                turn_on_deg_s: scene.vehicle.gyroscope.turn_on_deg_s,
                warm_up_c: scene.vehicle.gyroscope.warm_up_c,
            },
            mountings: mountings(),
            ..ChipOptions::default()
        };
        let board: Box<dyn FlyingBoard> = match flyer {
            Flyer::Native => Box::new(FlyingNativeBoard::boot(
                &start,
                &source,
                chips,
                &options.faults,
            )),
            Flyer::Emulated(core) => Box::new(FlyingEmulatedBoard::boot(
                &core,
                &start,
                &source,
                chips,
                &options.faults,
            )?),
        };
        let create = |path| FlightLog::create(path, &start);
        let log = options.record.as_deref().map(create);
        let flies_to_goals = start.logic().flies_to_goals();
        Ok(Self {
            options,
            world,
            board,
            course: Course::new(options.mission, scene.environment.area_m, seed),
            station: Station::new(flies_to_goals, &scene.tracking, seed).under(&options.faults),
            processor: Processor::new(options.contention, seed),
            measures: Measures::default(),
            watch: options.faults.begins_ns().map(FaultWatch::new),
            battery: BatteryWatch::default(),
            track: Vec::new(),
            scored: None,
            now_ns: 0,
            end_ns: TAKE_OFF_NS + (options.duration_s * 1e9) as u64,
            step_ns: update_period_ns(options.settings.motors).min(LONGEST_STEP_NS / 2),
            news: News::default(),
            log: log.transpose()?,
        })
    }

    pub(super) fn goes_on(&self) -> bool {
        let ended = self.battery.has_ended_the_flight() || self.end().is_some();
        self.now_ns < self.end_ns && !ended
    }

    pub(super) fn since_take_off_s(&self) -> f64 {
        (self.now_ns as f64 - TAKE_OFF_NS as f64) * 1e-9
    }

    pub(super) fn step(&mut self) -> Result<()> {
        let next_ns = self.next_ns();
        if !self.options.faults.is_empty() {
            self.world.wear(&self.options.faults);
        }
        self.world.advance_to(next_ns)?;
        self.board.run_until(next_ns)?;
        let passes = |mark_ns: u64| next_ns / mark_ns > self.now_ns / mark_ns;
        let (looks, keeps) = (passes(LOOK_NS), passes(KEPT_NS));
        self.now_ns = next_ns;
        self.board.take(&mut self.news);
        for stamped in self.news.calls.drain(..) {
            if let Some(log) = &mut self.log {
                log.take(&stamped)?;
            }
        }
        let delay_ns = (self.options.stress.delay_s * 1e9) as u64;
        for mut applied in self.news.applied.drain(..) {
            applied.at_ns = self.processor.applies_ns(applied.at_ns) + delay_ns;
            self.world.command(applied);
        }
        for (at_ns, ran) in self.news.runs.drain(..) {
            let since_s = (at_ns as f64 - TAKE_OFF_NS as f64) * 1e-9;
            let scored = self.scored.is_some() && !self.battery.is_nearly_empty();
            let quantum = self.options.settings.quantum;
            if let Some(watch) = &mut self.watch {
                watch.ran(&(at_ns, ran));
            }
            self.measures.ran(&ran, since_s, scored, quantum);
        }
        let drone = self.world.drone();
        if let Some(watch) = &mut self.watch {
            watch.look(next_ns, self.board.as_ref(), drone);
        }
        if looks {
            self.board.measure(self.world.battery_pins_mv());
            self.battery.look(next_ns, self.board.as_ref(), drone);
            self.look(keeps && next_ns >= TAKE_OFF_NS);
            self.log_truth()?;
        }
        Ok(())
    }

    /// Writes down where the drone truly is, where the flight is written.
    fn log_truth(&mut self) -> Result<()> {
        let Some(log) = &mut self.log else {
            return Ok(());
        };
        let state = self.world.state();
        let [x, y, z] = state.attitude.imag().into();
        let attitude = [state.attitude.w, x, y, z].map(|part: f64| part as f32);
        let axes = [state.position, state.velocity].map(<[f64; 3]>::from);
        log.truth(
            self.now_ns / 1_000,
            attitude,
            axes.map(|axes| axes.map(|axis| axis as f32)),
        )
    }

    /// Ends the log of the flight, where it is written.
    pub(super) fn end_log(&mut self) -> Result<()> {
        self.log.take().map_or(Ok(()), FlightLog::finish)
    }

    /// Where the next step ends: at an update event of the motors' timers, and before any command
    /// applies that is not given yet.
    fn next_ns(&self) -> u64 {
        let offset_ns = self.board.update_offset_ns() % self.step_ns;
        let begun = (self.now_ns + self.step_ns - offset_ns) / self.step_ns;
        let next_ns = (begun * self.step_ns + offset_ns).max(self.now_ns + 1);
        let soonest_ns = self.board.soonest_command_ns();
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
            self.board.transmit(frame);
        }
        let desired = self.board.desired();
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
        if self.battery.is_nearly_empty() {
            return;
        }
        let state = self.world.state();
        let standing = Standing {
            at_ns: self.now_ns,
            energy_j: state.energy_used,
            charge: state.state_of_charge,
        };
        if self.scored.is_none() && self.begins_to_count() {
            self.board.begin_scored();
            self.scored = Some(Scored {
                from: standing,
                to: standing,
                wind_sum: 0.0,
                looks: 0,
            });
        }
        let Some(scored) = &mut self.scored else {
            return;
        };
        scored.to = standing;
        scored.wind_sum += self.world.air.norm();
        scored.looks += 1;
        let (position, rates) = (state.position, state.rates);
        let angles = self.world.angles();
        self.measures.look(desired, angles, (target, &position));
        self.measures.turning.add(rates.norm());
    }

    fn begins_to_count(&self) -> bool {
        match self.options.scored_from_s {
            Some(from_s) => self.since_take_off_s() >= from_s,
            None => {
                self.since_take_off_s() >= UP_S && self.board.telemetry().phase != Phase::WarmUp
            }
        }
    }

    /// What ended the flight before its time, and when in ns.
    pub(super) fn end(&self) -> Option<(u64, String)> {
        let drone = self.world.drone();
        let crash = drone.crash().map(|crash| {
            let tilt = crash.tilt.to_degrees();
            let what = format!(
                "hit the ground at {:.1} m/s, tilted by {tilt:.0} degrees,",
                crash.speed
            );
            (crash.at_ns, what)
        });
        let upset = || Some((drone.upset()?, "turned over".to_owned()));
        let (at_ns, mut what) = crash.or_else(upset)?;
        if self.battery.is_empty() {
            what += " the battery empty,";
        } else if self.battery.is_nearly_empty() {
            what += " the battery nearly empty,";
        }
        Some((at_ns, what))
    }
}

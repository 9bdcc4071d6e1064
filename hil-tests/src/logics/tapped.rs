//! A control logic that keeps what it was given before each of its runs.

use reflex::airframe::Mixed;
use reflex::app::{Autopilot, Stamped};
use reflex::control::{Goal, Setpoint};
use reflex::dataflow::{Description, Dirty};
use reflex::estimate::{Motion, Place};
use reflex::graph::ControlLogic;
use reflex::math::Quaternion;
use reflex::settings::Settings;
use reflex::units::Thrust;
use reflex_bench::step::Step;

use super::{AnyLogic, LogicName};

/// A logic, and a step for each of its runs.
struct Tapped {
    logic: AnyLogic,
    next: Step,
    steps: Vec<Step>,
}

/// What a logic was given before each run of a flight, from the flight's calls.
#[must_use]
pub fn steps_of(calls: &[Stamped], settings: Settings, name: LogicName) -> Vec<Step> {
    let mut steps = Vec::new();
    let tapped = Tapped {
        logic: name.logic(),
        next: Step::default(),
        steps: Vec::new(),
    };
    let mut autopilot = Autopilot::with_logic(settings, (), tapped);
    for stamped in calls {
        stamped.call.replay(stamped.at, &mut autopilot);
    }
    steps.append(&mut autopilot.logic().steps);
    steps
}

impl ControlLogic for Tapped {
    fn name(&self) -> &'static str {
        self.logic.name()
    }

    fn description(&self) -> Description {
        self.logic.description()
    }

    fn derivative_cutoff(&self) -> f32 {
        self.logic.derivative_cutoff()
    }

    fn align(&mut self, attitude: Quaternion) {
        self.logic.align(attitude);
    }

    fn restart(&mut self, attitude: Quaternion) {
        self.logic.restart(attitude);
    }

    fn stand(&mut self) {
        self.logic.stand();
    }

    fn reset_integrals(&mut self) {
        self.logic.reset_integrals();
    }

    fn take(&mut self, motion: &Motion, heading: Option<f32>) {
        self.logic.take(motion, heading);
        if motion.sums.dt > 0.0 {
            self.next.motion = Some(motion.sums);
            self.next.heading = Some(heading);
        }
        self.next.rotation = Some(motion.rotation);
    }

    fn fly(&mut self, setpoint: Setpoint) {
        self.logic.fly(setpoint);
        self.next.setpoint = Some(setpoint);
    }

    fn flies_to_goals(&self) -> bool {
        self.logic.flies_to_goals()
    }

    fn fly_to(&mut self, goal: Option<Goal>) {
        self.logic.fly_to(goal);
        self.next.goal = Some(goal);
    }

    fn see(&mut self, place: Place) {
        self.logic.see(place);
        self.next.place = Some(place);
    }

    fn go_blind(&mut self, blind: bool) {
        self.logic.go_blind(blind);
        self.next.blind = Some(blind);
    }

    fn run(&mut self) -> Dirty {
        self.steps.push(core::mem::take(&mut self.next));
        self.logic.run()
    }

    fn foresee(&self) -> Mixed {
        self.logic.foresee()
    }

    fn flown(&self) -> &Setpoint {
        self.logic.flown()
    }

    fn flown_to(&self) -> Option<Goal> {
        self.logic.flown_to()
    }

    fn collective(&self) -> Thrust {
        self.logic.collective()
    }

    fn estimate(&self) -> Quaternion {
        self.logic.estimate()
    }

    fn mixer(&self) -> &reflex::airframe::Mixer {
        self.logic.mixer()
    }

    fn lose_motor(&mut self, motor: u8) {
        self.logic.lose_motor(motor);
    }

    fn mixed(&self) -> &Mixed {
        self.logic.mixed()
    }
}

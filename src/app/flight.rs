//! From arming to the end of a flight: what is flown without a pilot.

use super::demand::{Aim, Silence};
use super::{Autopilot, Event, Fault, Next, Reason, Recorder, notice};
use crate::battery::BatteryState;
use crate::config::{
    ARMING_GRAVITY_ERROR, ARMING_RATE, ARMING_THRUST, ARMING_TILT, DESCEND_WHEN_EMPTY,
    FEWEST_TO_FLY,
};
use crate::control::{Goal, MotorTest, Setpoint, Yaw};
use crate::estimate::{Response, Unanswered};
use crate::graph::ControlLogic;
use crate::link::{Answer, ArmCommand, Calibrate, StoreCommand};
use crate::math::{Quaternion, sin_cos};
use crate::reactive::PhaseEvent;
use crate::safety::{Check, Checks, FlightEvent, FlightState, Seen};
use crate::sensors::GRAVITY;
use crate::time::Instant;
use crate::units::Velocity;

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    // What the pilot asks for.

    pub(super) fn on_arm(&mut self, at: Instant, asked: &ArmCommand) -> (Next, Option<Answer>) {
        let done = match (asked.arm, asked.force) {
            // Never forced: the checks hold for everyone.
            (true, _) => self.arm(at),
            (false, false) => self.move_state(FlightEvent::Disarm, at),
            (false, true) => self.move_state(FlightEvent::ForceDisarm, at),
        };
        // Whoever disarms a drone that stands has read why it refused to be armed.
        if !asked.arm && self.safety.state() == FlightState::Disarmed {
            self.reset = None;
            self.storage.acknowledge();
        }
        // Motors that stop do so now, not when the next sample comes.
        let next = if asked.arm || self.safety.is_armed() {
            Next::Wait
        } else {
            self.reactive.force(Reason::Ground);
            Next::Hyperperiod
        };
        (next, Some(temporarily(done)))
    }

    /// One motor turns, while the drone is disarmed; a next test takes the place of one under way.
    pub(super) fn on_motor_test(
        &mut self,
        at: Instant,
        test: &MotorTest,
    ) -> (Next, Option<Answer>) {
        let known = usize::from(test.motor) < self.safety.applied().len();
        let stands = matches!(
            self.safety.state(),
            FlightState::Disarmed | FlightState::Testing
        );
        let answer = match (known, stands) {
            (false, _) => Answer::Denied,
            (_, false) => Answer::TemporarilyRejected,
            _ => {
                self.move_state(FlightEvent::TestMotor, at);
                self.safety.plan_test(at, test);
                Answer::Accepted
            }
        };
        (Next::Wait, Some(answer))
    }

    /// Measures what is to be known of a drone at rest, which it has been for a while.
    pub(super) fn on_calibrate(&mut self, at: Instant, what: Calibrate) -> Answer {
        let done = match (self.stands_no_longer(), what) {
            (true, _) => Err(notice::CALIBRATE_ARMED),
            (false, Calibrate::Gyroscope) => self.sensing.rest(at).map(drop),
            (false, Calibrate::Level) => self.sensing.level(at),
        };
        let told = done.map(|()| {
            self.storage.wish().trim |= what == Calibrate::Level;
            notice::CALIBRATED
        });
        let accepted = told.is_ok();
        self.record.notice(told.unwrap_or_else(|refused| refused));
        temporarily(accepted)
    }

    /// Has the store keep or forget settings, while motors stand.
    pub(super) fn on_store_command(&mut self, what: StoreCommand) -> Answer {
        let stands = !self.stands_no_longer();
        if stands {
            let wish = self.storage.wish();
            let keeps = what == StoreCommand::Save;
            (wish.settings, wish.defaults) = (keeps, !keeps);
        }
        temporarily(stands)
    }

    /// True where motors may turn.
    pub(super) fn stands_no_longer(&self) -> bool {
        self.safety.is_armed() || self.safety.state() == FlightState::Testing
    }

    #[cold]
    #[inline(never)]
    fn arm(&mut self, at: Instant) -> bool {
        if self.safety.is_armed() {
            return true;
        }
        let checks = self.checks(at);
        if checks.all_passed() {
            self.move_state(FlightEvent::Arm, at);
            return true;
        }
        self.record.event(Event::NotArmed(checks));
        for check in checks.failed() {
            self.record.notice(notice::not_armed(check));
        }
        false
    }

    /// What must be right before motors may turn.
    fn checks(&self, now: Instant) -> Checks {
        let calibrated = self.safety.state() != FlightState::Calibrating;
        let health = self.health();
        let down = self.graph.estimate().down_in_body();
        let rates = self.sensing.motion().rotation.rates.0;
        let force = self.sensing.force().0.norm();
        let flies = !self.demand.is_silent() || self.flies_to_places(now);
        let goal = self.graph.flown_to().is_some();
        let thrust = self.graph.flown().thrust.share();
        Checks::NONE
            .and(Check::Calibration, calibrated)
            .and(Check::Imu, health.is_sound())
            .and(Check::Level, !health.level_disagrees)
            .and(Check::Configuration, self.record.are_sensors_sound(now))
            .and(Check::Still, rates.max_norm() <= ARMING_RATE)
            .and(
                Check::Gravity,
                (force - GRAVITY).abs() <= ARMING_GRAVITY_ERROR,
            )
            .and(Check::ImuMounting, self.sensing.stands_upright())
            .and(Check::ChipMounting, !self.sensing.chip_is_aslant())
            .and(Check::Tilt, down.z >= sin_cos(ARMING_TILT.to_radians()).1)
            .and(Check::Setpoint, flies)
            .and(Check::Thrust, goal || thrust <= ARMING_THRUST)
            .and(
                Check::MotorTest,
                self.safety.state() != FlightState::Testing,
            )
            .and(Check::Battery, self.battery.state() <= BatteryState::Good)
            .and(
                Check::Reset,
                !self.reset.is_some_and(|reset| reset.is_unexpected()),
            )
            .and(
                Check::Motors,
                !self.safety.has_lost_motors() && self.record.faults(Fault::Contrary) == 0,
            )
            .and(Check::Store, !self.storage.is_lost())
            .and(Check::Storing, !self.storage.is_busy())
            .and(Check::Models, self.reactive.are_models_sane())
            .and(Check::Load, self.record.are_runs_in_time(now))
    }

    /// True where goals can be flown: places come.
    fn flies_to_places(&self, now: Instant) -> bool {
        self.graph.flies_to_goals() && self.demand.knows_place(now)
    }

    /// True where a demand of the pilot is flown: not while the drone comes down for another
    /// reason than the pilot's silence. `first`: the pilot was silent before it.
    pub(super) fn obeys(&mut self, at: Instant, first: bool) -> bool {
        if first {
            self.move_state(FlightEvent::PilotBack, at);
        }
        self.safety.state() != FlightState::Descending
    }

    // States.

    /// Moves the state of the flight; false where that is refused.
    #[cold]
    #[inline(never)]
    pub(super) fn move_state(&mut self, event: FlightEvent, now: Instant) -> bool {
        match self.safety.on_event(event, now) {
            Ok(Some(state)) => {
                self.record.event(Event::Flight(state, event));
                self.record.notice(notice::flight(state, event));
                self.begin(state, now);
            }
            Ok(None) => {}
            Err(_) => {
                self.record.event(Event::NotDisarmed);
                self.record.notice(notice::NOT_DISARMED);
                return false;
            }
        }
        true
    }

    /// What a new state brings with it.
    fn begin(&mut self, state: FlightState, now: Instant) {
        match state {
            FlightState::Calibrating => {
                self.sensing.forget_calibration();
                self.stand(now);
            }
            FlightState::Disarmed => self.stand(now),
            FlightState::Armed => self.move_phase(PhaseEvent::Armed),
            FlightState::Descending => self.descend(now),
            FlightState::Testing
            | FlightState::Flying
            | FlightState::Waiting
            | FlightState::Blind => {}
        }
    }

    /// The next flight shall not begin with the thrust that this one ended with.
    fn stand(&mut self, now: Instant) {
        self.fly(now, Aim::Setpoint(Setpoint::default()));
        self.demand.forget();
        self.move_phase(PhaseEvent::Disarmed);
    }

    // What ends a flight.

    /// Looks for a take-off, a landing, an upset, and for the end of a state's time.
    pub(super) fn watch_flight(&mut self, now: Instant) {
        let setpoint = self.graph.flown();
        let seen = Seen {
            at: now,
            thrust: self.graph.collective(),
            rates: self.sensing.motion().rotation.rates.0,
            force: self.sensing.force().0,
            down: self.graph.estimate().down_in_body(),
            asked_down: match self.graph.flown_to() {
                None => setpoint.attitude.map(|attitude| attitude.down_in_body()),
                // Position loops lean as they need.
                Some(_) => None,
            },
            sees_place: self.graph.flown_to().is_some(),
        };
        if let Some(event) = self.safety.watch(&seen) {
            self.move_state(event, now);
        }
    }

    /// An empty battery ends the flight, before it does so by itself.
    pub(super) fn check_battery(&mut self, now: Instant) {
        if DESCEND_WHEN_EMPTY && self.battery.state() == BatteryState::Critical {
            self.move_state(FlightEvent::BatteryEmpty, now);
        }
    }

    /// What the drone is flown by may have fallen silent.
    pub(super) fn check_demand(&mut self, now: Instant) {
        let Some(silence) = self.demand.notice_silence(now, &self.graph) else {
            // The gyroscope may be back after the pilot fell silent.
            if self.safety.state() == FlightState::Flying && self.demand.is_silent() {
                self.move_state(FlightEvent::PilotSilent, now);
            }
            return;
        };
        self.record.event(Event::Silent(silence));
        self.record.notice(notice::silent(silence));
        self.move_state(FlightEvent::PilotSilent, now);
        let held = self.graph.flown_to().filter(|_| silence == Silence::Goal);
        match (self.safety.state(), held) {
            (FlightState::Descending, Some(_)) => {}
            (FlightState::Descending, None) => self.descend(now),
            (state, Some(goal)) if state.is_armed() => self.fly(now, stand_still(goal)),
            (state, _) if state.is_armed() => self.fly_alone(now),
            _ => self.fly(now, Aim::Setpoint(Setpoint::default())),
        }
    }

    /// Level, at the thrust that keeps the drone where it is, or lets it sink slowly.
    fn fly_alone(&mut self, now: Instant) {
        let thrust = self.safety.thrust_alone(now, self.sensing.sinking());
        self.fly(now, Aim::Setpoint(Setpoint::level(thrust)));
    }

    /// A descent begins, or goes on: to below the last goal, or level with less thrust.
    fn descend(&mut self, now: Instant) {
        match self.graph.flown_to() {
            Some(goal) if self.demand.knows_place(now) => {
                let goal = self.demand.sink(now, goal);
                self.fly(now, Aim::Goal(goal));
            }
            _ => self.fly_alone(now),
        }
    }

    /// What is flown without the pilot, or with a motor less, follows the drone.
    pub(super) fn aim(&mut self, now: Instant) {
        match self.safety.state() {
            FlightState::Descending => self.descend(now),
            FlightState::Waiting if self.graph.flown_to().is_none() => self.fly_alone(now),
            _ => {}
        }
        if self.safety.has_lost_motors() {
            self.free_heading(now);
        }
    }

    /// The heading that the drone has is the one that is asked for; it leans over the same ground.
    ///
    /// Without a motor no torque is left to hold a heading, and loops that hold on to one lean the
    /// wrong way as the drone turns.
    #[cold]
    fn free_heading(&mut self, now: Instant) {
        self.advance(now);
        let heading = self.graph.estimate().heading();
        let setpoint = *self.graph.flown();
        let aim = match (self.graph.flown_to(), setpoint.attitude) {
            (Some(goal), _) => Aim::Goal(Goal { heading, ..goal }),
            (None, Some(attitude)) if setpoint.yaw == Yaw::Heading => {
                let turn = Quaternion::from_heading(heading - attitude.heading());
                let attitude = Some(attitude.then_body(turn));
                Aim::Setpoint(Setpoint {
                    attitude,
                    ..setpoint
                })
            }
            _ => return,
        };
        self.fly(now, aim);
    }

    // Whether the body answers.

    /// Looks whether the body does as the motors are asked, whenever it is time.
    #[inline]
    pub(super) fn watch_response(&mut self, at: Instant) {
        if self.response.is_due(at) {
            self.look_at_response(at);
        }
    }

    #[inline(never)]
    fn look_at_response(&mut self, at: Instant) {
        if !self.safety.state().is_in_the_air() {
            self.response = Response::default();
            return;
        }
        let felt = [
            self.sensing.motion().rotation.rates.0,
            self.sensing.force().0,
        ];
        let mixer = self.graph.mixer();
        let asked = mixer.asked(self.safety.applied());
        if let Some(unanswered) = self.response.look(at, felt, &asked, mixer) {
            self.on_unanswered(at, unanswered);
        }
    }

    /// A drone that its other motors can level flies on without one; any other falls all the more
    /// the more is asked of its motors.
    #[cold]
    #[inline(never)]
    fn on_unanswered(&mut self, at: Instant, unanswered: Unanswered) {
        let flies = match unanswered {
            Unanswered::Motor(motor) => {
                self.record.fault(Fault::MotorLost);
                self.record.event(Event::MotorLost(motor));
                self.record.notice(notice::motor_lost(motor));
                self.graph.lose_motor(motor);
                self.safety.lose(motor) >= FEWEST_TO_FLY
            }
            Unanswered::Rates => {
                self.record.fault(Fault::Contrary);
                self.record.notice(notice::CONTRARY);
                false
            }
        };
        if !flies {
            self.move_state(FlightEvent::Unanswered, at);
        }
    }
}

/// The answer to what is done, or may be done later.
fn temporarily(done: bool) -> Answer {
    if done {
        Answer::Accepted
    } else {
        Answer::TemporarilyRejected
    }
}

/// A goal that nobody moves any more stands still.
fn stand_still(goal: Goal) -> Aim {
    Aim::Goal(Goal {
        velocity: Velocity::default(),
        ..goal
    })
}

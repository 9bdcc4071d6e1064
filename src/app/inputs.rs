//! What comes in: samples of both chips, messages of the link.

use super::hyperperiod::GATES;
use super::liveness::Sign;
use super::setpoints::{SetpointWatch, moved};
use super::{Autopilot, Call, Fault, Next, Reason, Recorder};
use crate::config::AEROBATICS;
use crate::control::Setpoint;
use crate::estimate::Motion;
use crate::graph::ControlLogic;
use crate::link::{Answer, Message};
use crate::math::{Vec3, atan2, wrapped};
use crate::reactive::{FallbackReason, Phase, PhaseEvent};
use crate::safety::{Arming, ArmingEvent, Refusal};
use crate::sensors::{Cause, IMU_BURST_LENGTH, ImuSample, Input, Inputs, chip_field, chip_force};
use crate::settings::Feedback;
use crate::telemetry::Event;
use crate::time::{Duration, Instant, micros, span};
use crate::units::BodyRates;

/// How long a measured error of the heading is believed.
const HEADING_LIFE: Duration = micros(200_000);

/// Cosine of the tilt beyond which arming is refused: 60 degrees.
///
/// A drone that lies on its side, or whose chips are mounted another way than face down, would
/// turn over.
const LEAST_UPRIGHT: f32 = 0.5;

/// The weakest horizontal field (gauss) that shows a heading; Earth's is 0.1 and more below
/// 70 degrees of latitude.
const WEAKEST_FIELD: f32 = 0.05;

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// A burst of the MPU6050 was received; `at` is the stamp of its interrupt.
    ///
    /// Filters, sums and compares; ends the hyperperiod where it is the last that gates.
    pub fn on_imu(&mut self, at: Instant, burst: &[u8; IMU_BURST_LENGTH]) -> Next {
        self.note(at, Call::Imu(*burst));
        let Some(sample) = ImuSample::from_burst(at, burst) else {
            self.count(Fault::ImuStale);
            return Next::Wait;
        };
        self.schedule.gate(at);
        let Some(bias) = self.bias else {
            self.calibrate(&sample);
            return Next::Wait;
        };
        if self.is_alive(at, burst) {
            self.take_sample(&ImuSample {
                rates: BodyRates(sample.rates.0 - bias.0),
                ..sample
            });
        }
        self.end_hyperperiod(at, Inputs::NONE.with(Input::Gyro).with(Input::Accel))
    }

    /// False for a sensor that repeats itself; only in flight, where that is an emergency.
    fn is_alive(&mut self, at: Instant, burst: &[u8; IMU_BURST_LENGTH]) -> bool {
        let sign = self.liveness.take(at, burst, self.settings.failsafe * 2);
        if self.arming != Arming::Armed || sign == Sign::Alive {
            if self.supervisor.phase() == Phase::Fallback(FallbackReason::ImuLost) {
                self.move_phase(PhaseEvent::ImuBack);
            }
            return true;
        }
        if sign == Sign::Stuck {
            self.count(Fault::ImuStuck);
        }
        self.move_phase(PhaseEvent::Fail(FallbackReason::ImuLost));
        false
    }

    /// Filters, sums and compares a sample.
    fn take_sample(&mut self, sample: &ImuSample) {
        if !self.arrival.take(sample, self.graph.derivative_cutoff()) {
            self.count(Fault::ImuJump);
        }
        self.compare_sample(sample.at);
    }

    /// Takes note of samples of gating inputs; says what the board does next.
    fn end_hyperperiod(&mut self, at: Instant, inputs: Inputs) -> Next {
        let phase = self.supervisor.phase();
        let exploration = &mut self.exploration;
        let explores = self.settings.feedback == Feedback::Every;
        let explore = || explores && exploration.draw();
        if !self.schedule.deliver(at, inputs) {
            self.next_if_asked()
        } else if self.schedule.end_of_hyperperiod(at, phase, explore) {
            Next::Hyperperiod
        } else {
            Next::Wait
        }
    }

    /// What was asked for runs at the hyperperiod's end, should its last sample not come.
    fn next_if_asked(&self) -> Next {
        if self.supervisor.phase() == Phase::Reactive && !self.schedule.asked().is_empty() {
            Next::HyperperiodAt(self.schedule.timeout())
        } else {
            Next::Wait
        }
    }

    fn calibrate(&mut self, sample: &ImuSample) {
        if let Some(found) = self.calibration.take(sample) {
            self.bias = Some(found.bias);
            self.graph.align(found.force);
            self.move_arming(ArmingEvent::Calibrated);
        }
    }

    /// Takes the filtered sample into its inputs, and what can be derived from it.
    fn compare_sample(&mut self, at: Instant) {
        let motion = self.arrival.motion();
        let learners = &mut self.learners;
        let calls = [
            (Input::Gyro, learners.gyro.calls(motion.rotation.rates.0)),
            (Input::Accel, learners.accel.calls(self.arrival.force().0)),
            (Input::Turned, learners.turned_calls(motion.sums.angle)),
        ];
        for (input, _) in calls.into_iter().filter(|(_, calls)| *calls) {
            self.schedule.ask(input);
        }
        // Time-triggered control need not foresee what it computes anyway.
        let foresees =
            self.supervisor.phase() == Phase::Reactive && self.learners.command.lesson.triggers;
        if foresees && self.foreseen_calls(at, &motion) {
            self.schedule.ask(Input::Command);
        }
    }

    /// True where the command that a run would come to calls for it.
    fn foreseen_calls(&mut self, at: Instant, motion: &Motion) -> bool {
        self.graph.take(motion, self.heading_error(at));
        let foreseen = self.graph.foresee();
        let calls = self.learners.command.calls(foreseen.shares);
        if foreseen.saturated != self.graph.mixed().saturated {
            self.advance(at);
        }
        calls
    }

    /// A sample of the LSM303AGR's accelerometer; `at` is the stamp of its interrupt.
    pub fn on_chip_accel(&mut self, at: Instant, counts: [i16; 3], cause: Cause) -> Next {
        self.note(at, Call::ChipAccel(counts, cause));
        if self.chips.accel.on_sample(at, counts) {
            self.count(Fault::AccelStuck);
            self.on_chip_lost(Input::ChipAccel);
        }
        self.on_chip_sample(at, Input::ChipAccel, chip_force(counts).0, cause)
    }

    /// A sample of the LSM303AGR's magnetometer, its OFFSET registers added back.
    pub fn on_chip_mag(&mut self, at: Instant, counts: [i16; 3], cause: Cause) -> Next {
        self.note(at, Call::ChipMag(counts, cause));
        if self.chips.mag.on_sample(at, counts) {
            self.count(Fault::MagStuck);
            self.on_chip_lost(Input::ChipMag);
        }
        let field = chip_field(counts).0;
        if !self.chips.mag.is_stuck() {
            self.measure_heading(at, field);
        }
        self.on_chip_sample(at, Input::ChipMag, field, cause)
    }

    fn on_chip_sample(&mut self, at: Instant, input: Input, sample: Vec3, cause: Cause) -> Next {
        if cause == Cause::Rearm {
            if let Some(learner) = self.learners.of_axes(input) {
                learner.rearm(sample);
            }
            return Next::Wait;
        }
        let learner = self.learners.of_axes(input);
        let crossed = learner.is_some_and(|learner| learner.calls(sample));
        // Where the chip compared, its comparison decides.
        if crossed || cause == Cause::Threshold {
            self.schedule.ask(input);
        }
        if self.supervisor.is_learning() {
            self.learners
                .hold(at, input, self.gate.applied(), &mut self.recorder);
        }
        if GATES.contains(input) {
            self.end_hyperperiod(at, Inputs::NONE.with(input))
        } else {
            self.next_if_asked()
        }
    }

    /// The field's horizontal direction, held against the one first seen, shows yaw drift.
    fn measure_heading(&mut self, at: Instant, field: Vec3) {
        let pose_leads = self
            .heading
            .pose_at
            .is_some_and(|pose_at| span(pose_at, at) <= HEADING_LIFE);
        // Where the body is now, not where it was at the last run.
        let turned = self.arrival.motion().sums.angle;
        let earth = self.graph.estimate().turned_by(turned).to_earth(field);
        let weak = earth.x.abs().max(earth.y.abs()) < WEAKEST_FIELD;
        if weak || pose_leads || self.bias.is_none() {
            return;
        }
        let direction = atan2(earth.y, earth.x);
        let reference = *self.heading.field.get_or_insert(direction);
        self.heading.error = Some((at, wrapped(reference - direction)));
    }

    /// The error of the heading, while it is fresh.
    pub(super) fn heading_error(&self, now: Instant) -> Option<f32> {
        self.heading
            .error
            .filter(|(at, _)| span(*at, now) <= HEADING_LIFE)
            .map(|(_, error)| error)
    }

    /// A message of the link; the answer where it was a command.
    pub fn on_message(&mut self, at: Instant, message: &Message) -> (Next, Option<Answer>) {
        self.note(at, Call::Message(*message));
        if !message.is_finite() {
            self.count(Fault::NotFinite);
            return (Next::Wait, None);
        }
        match message {
            Message::Heartbeat => (Next::Wait, None),
            Message::Setpoint(setpoint) => {
                self.on_setpoint(at, setpoint);
                (Next::Wait, None)
            }
            Message::Arm(arm) => self.on_arm(*arm),
            Message::Pose(pose) => {
                self.on_pose(at, pose);
                (Next::Wait, None)
            }
            Message::Goal(destination) => {
                self.on_goal(at, destination);
                (Next::Wait, None)
            }
        }
    }

    /// A setpoint joins: the next run uses it. It forces a run once it moved past its quantum.
    fn on_setpoint(&mut self, at: Instant, setpoint: &Setpoint) {
        if self.graph.flown_to().is_some() {
            self.setpoints = SetpointWatch::default();
        }
        let first = self.setpoints.at.is_none();
        let turning = self.setpoints.take(at, self.graph.flown(), setpoint);
        if turning > AEROBATICS {
            self.move_phase(PhaseEvent::Fail(FallbackReason::Aerobatics));
        }
        self.fly(at, *setpoint);
        if first || moved(self.learners.setpoint_of_last_run(), setpoint) {
            self.schedule.ask_for_setpoint();
        }
    }

    fn on_arm(&mut self, arm: bool) -> (Next, Option<Answer>) {
        if !arm {
            self.move_arming(ArmingEvent::Disarm);
            // The motors stop now, not when the next sample comes.
            self.schedule.force(Reason::Ground);
            return (Next::Hyperperiod, Some(Answer::Accepted));
        }
        let upright = self.graph.estimate().down_in_body().z >= LEAST_UPRIGHT;
        if self.arming == Arming::Disarmed && !upright {
            self.events.push(Event::Refused(Refusal::Tilted));
            return (Next::Wait, Some(Answer::TemporarilyRejected));
        }
        let answer = if self.move_arming(ArmingEvent::Arm) {
            Answer::Accepted
        } else {
            Answer::TemporarilyRejected
        };
        (Next::Wait, Some(answer))
    }

    /// Moves the arming state; false where that was refused.
    pub(super) fn move_arming(&mut self, event: ArmingEvent) -> bool {
        match self.arming.after(event) {
            Ok(arming) => {
                if arming != self.arming {
                    self.arming = arming;
                    self.events.push(Event::Arming(arming));
                    self.on_arming_changed();
                }
                true
            }
            Err(refusal) => {
                self.events.push(Event::Refused(refusal));
                false
            }
        }
    }

    fn on_arming_changed(&mut self) {
        let event = match self.arming {
            Arming::Armed => PhaseEvent::Armed,
            Arming::Disarmed | Arming::Calibrating => {
                // The next flight shall not begin with the thrust that this one ended with.
                self.fly(self.clock, Setpoint::default());
                self.setpoints = SetpointWatch::default();
                PhaseEvent::Disarmed
            }
        };
        self.move_phase(event);
    }
}

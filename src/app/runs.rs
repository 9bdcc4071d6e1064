//! Runs: the graph propagates, the gate passes, what happened becomes labels.

use super::{Autopilot, Call, Fault, Ran, Reason, Recorder};
use crate::control::Setpoint;
use crate::estimate::GyroCalibration;
use crate::graph::ControlLogic;
use crate::reactive::{FallbackReason, Phase, PhaseEvent, differs};
use crate::safety::{Arming, ArmingEvent, MotorOutput};
use crate::telemetry::Event;
use crate::time::Instant;

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// The hyperperiod ended: control runs if a run is due.
    ///
    /// The output must be written to the motors at once.
    pub fn on_hyperperiod(&mut self, now: Instant) -> Option<MotorOutput> {
        self.note(now, Call::Hyperperiod);
        if self.schedule.is_late(now) {
            self.count(Fault::LateRun);
            self.limits.late(now);
        }
        let reason = self.schedule.take_due(now, self.supervisor.phase())?;
        Some(self.run(now, reason))
    }

    /// The timer that depends on no sensor: control runs if the failsafe is due.
    ///
    /// To be called at [`Self::deadline`]; an early call does no harm.
    pub fn on_timer(&mut self, now: Instant) -> Option<MotorOutput> {
        self.note(now, Call::Timer);
        if now < self.deadline() {
            return None;
        }
        Some(self.run(now, Reason::Failsafe))
    }

    /// When [`Self::on_timer`] is due next.
    #[must_use]
    pub fn deadline(&self) -> Instant {
        self.schedule.deadline()
    }

    /// Looked at in every run, whoever asked for it: a drone that tumbles without its gyroscope
    /// may be run by the other chip often enough that the failsafe never is.
    fn check_gate(&mut self, now: Instant) {
        if !self.schedule.notice_silence(now) {
            return;
        }
        self.count(Fault::ImuSilent);
        self.move_arming(ArmingEvent::ImuLost);
        self.move_phase(PhaseEvent::Fail(FallbackReason::ImuLost));
        if self.arming == Arming::Calibrating {
            self.bias = None;
            self.calibration = GyroCalibration::default();
        }
    }

    pub(super) fn move_phase(&mut self, event: PhaseEvent) {
        if let Some(phase) = self.supervisor.on(event, self.clock) {
            self.events.push(Event::Phase(phase));
            match phase {
                Phase::Fallback(reason) if reason.refutes_models() => self.learners.restart(),
                Phase::WarmUp => self.learners.return_to_crossings(),
                _ => {}
            }
            self.learners.restart_holds();
            self.limits.restart();
            self.chips.retry();
            self.want_thresholds();
        }
    }

    fn run(&mut self, now: Instant, reason: Reason) -> MotorOutput {
        self.check_gate(now);
        self.check_chips(now);
        self.check_demand(now);
        let blind = self.supervisor.phase() == Phase::Fallback(FallbackReason::ImuLost);
        self.graph.go_blind(blind);
        let motion = self.arrival.take_motion();
        self.graph.take(&motion, self.heading_error(now));
        self.graph.run();
        let moved = core::mem::take(&mut self.advanced) || motion.sums.dt > 0.0;
        if self.arming != Arming::Armed {
            self.graph.reset_integrals();
        }
        let before = *self.gate.applied();
        let refused = self.gate.refused();
        let output = self.gate.pass(self.arming, &self.graph.mixed().shares);
        if self.gate.refused() != refused {
            self.count(Fault::Command);
        }
        let asked = self.schedule.asked();
        let expected = self.learners.expected_of(asked);
        let changed = differs(&before, &output.share(), self.settings.quantum);
        // Without new motion a command cannot change, which teaches nothing about sensors; and
        // a setpoint that moved may have changed it whatever they said.
        if moved && !self.schedule.is_asked_by_setpoint() {
            self.learn(now, reason, asked, changed);
        }
        if let Some(reason) = self.limits.passed(self.settings.p_run) {
            self.move_phase(PhaseEvent::Fail(reason));
        }
        self.judge_refits(now);
        self.schedule.on_run(now);
        self.setpoints.on_run();
        self.learners.on_run(
            motion.sums.angle,
            self.supervisor.is_learning(),
            &output.share(),
            self.graph.flown(),
        );
        self.chips.on_run();
        self.recorder.record(
            now,
            &Call::Ran(Ran {
                reason,
                asked,
                expected,
                shares: output.share(),
            }),
        );
        // On the ground a line every millisecond would tell nothing.
        if reason != Reason::Ground {
            self.events.push(Event::Ran {
                number: self.schedule.runs(),
                reason,
                asked,
                changed,
            });
        }
        output
    }

    /// A new setpoint, behind the motion that the one before led to; it ends a goal.
    pub(super) fn fly(&mut self, now: Instant, setpoint: Setpoint) {
        self.advance(now);
        self.graph.fly_to(None);
        self.graph.fly(setpoint);
        self.graph.run();
    }

    /// The graph takes the motion so far; the motors keep their command.
    ///
    /// What states come to depends on what held while time passed, as the setpoint and
    /// saturation. Where that changes between runs, what is past is taken first, so that states
    /// do not depend on how often control runs. Not inlined: in its many places it would cost 2 KiB.
    #[inline(never)]
    pub(super) fn advance(&mut self, now: Instant) {
        let motion = self.arrival.take_motion();
        if motion.sums.dt > 0.0 {
            self.graph.take(&motion, self.heading_error(now));
            self.graph.run();
            self.learners.on_advance(motion.sums.angle);
            self.advanced = true;
        }
    }
}

//! Reactive control: when does a change in a sensor call for new motor commands?
//!
//! For each input a logistic regression gives the probability that a run now would change the
//! command by a quantum or more; its inverse is a threshold, so that the hot path is one
//! comparison (Bregu et al., MobiSys 2016, sections 4 and 5). Labels come from shadow holds in
//! the warm-up, later from the runs that one input alone asked for.
//!
//! [`Reactive`] is the whole rule. It is shown samples, setpoints and runs, in this order:
//!
//! ```text
//! samples  -> take_motion, take_sample -> learners: past a threshold? -> schedule: asked
//!             end_hyperperiod          -> schedule: is a run due?
//! a run    -> learn                    -> labels, limits      -> on_phase_event
//!             review_models, on_run    -> new references
//! idle     -> refit_due, swap_model    -> new thresholds
//! ```

mod decision;
mod exploration;
mod fit;
mod hyperperiod;
mod judgement;
mod labels;
mod learners;
mod limits;
mod logistic;
mod outcome;
mod sample;
mod schedule;
mod setpoints;
mod shadow_holds;
mod supervisor;
mod watch;

pub use decision::Decision;
pub use exploration::Exploration;
pub use fit::{Fit, Refit, RefitJob};
pub use labels::{BIN_COUNT, Label, Labels};
pub use learners::changes_of;
pub use limits::Limits;
pub use logistic::Logistic;
pub use outcome::Outcome;
pub use sample::Sample;
pub use schedule::{Next, Reason};
pub use shadow_holds::{Held, Lead, Rule, ShadowHolds, differs};
pub use supervisor::{FallbackReason, Phase, PhaseEvent, Supervisor};
pub use watch::Watch;

use crate::airframe::MotorShares;
use crate::config::{AEROBATICS, REFIT_INTERVAL};
use crate::control::{Goal, Setpoint};
use crate::math::Vec3;
use crate::sensors::{Cause, ChipSample, Input, Inputs};
use crate::settings::{Reference, Settings};
use crate::time::{Instant, span};
use hyperperiod::GATES;
use judgement::Judgement;
use learners::Learners;
use schedule::Schedule;
use setpoints::SetpointQuanta;

/// When control runs, and what every run teaches about it.
#[derive(Clone, Debug)]
pub struct Reactive {
    schedule: Schedule,
    learners: Learners,
    setpoints: SetpointQuanta,
    supervisor: Supervisor,
    judgement: Judgement,
    /// The control logic took motion that no run has taught by yet.
    advanced: bool,
    /// Models were swapped in that no run has reviewed yet.
    unreviewed: bool,
}

/// A run of the control logic, as the trigger rule sees it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// When it began.
    pub at: Instant,
    /// Why.
    pub reason: Reason,
    /// It took motion; without new motion a command cannot change.
    pub moved: bool,
    /// The command that was applied until now.
    pub before: &'a MotorShares,
    /// The command that is applied now.
    pub applied: &'a MotorShares,
}

/// What a run turned out to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Inputs that asked for it.
    pub asked: Inputs,
    /// The largest probability of a changed command by a model that asked; `None` without one.
    pub expected: Option<f32>,
    /// The command moved by a quantum or more.
    pub changed: bool,
}

/// What the newest models mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Review {
    /// A phase ends.
    Move(PhaseEvent),
    /// The phase goes on; these inputs learn from lags from now on.
    Stay(Inputs),
}

impl Reactive {
    /// On the ground, with nothing learned.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self {
            schedule: Schedule::new(settings),
            learners: Learners::new(settings),
            setpoints: SetpointQuanta::default(),
            supervisor: Supervisor::new(settings.policy, settings.warm_up),
            judgement: Judgement::new(settings),
            advanced: false,
            unreviewed: false,
        }
    }

    // Asking for a run.

    /// Takes what a filtered sample of the gyroscope and of the accelerometer beside it says:
    /// rates in rad/s, specific force in m/s2, angle turned since the last run in rad.
    pub fn take_motion(&mut self, rates: Vec3, force: Vec3, turned: Vec3) {
        let learners = &mut self.learners;
        let calls = [
            (Input::Gyro, learners.calls(Input::Gyro, rates)),
            (Input::Accel, learners.calls(Input::Accel, force)),
            (Input::Turned, learners.turned_calls(turned)),
        ];
        for (input, _) in calls.into_iter().filter(|(_, calls)| *calls) {
            self.schedule.ask(input);
        }
    }

    /// True where the command that a run would compute is worth foreseeing.
    ///
    /// Time-triggered control need not foresee what it computes anyway.
    #[must_use]
    pub fn foresees(&self) -> bool {
        self.phase() == Phase::Reactive && self.learners.lesson(Input::Command).triggers
    }

    /// Takes the command that a run would compute now.
    pub fn take_foreseen(&mut self, command: &MotorShares) {
        if self.learners.command_calls(command) {
            self.schedule.ask(Input::Command);
        }
    }

    /// Takes a sample of a chip with a clock of its own, with the command in force.
    pub fn take_sample(
        &mut self,
        at: Instant,
        sample: &ChipSample,
        command: &MotorShares,
        tell: impl FnMut(Input, &Label),
    ) -> Next {
        let ChipSample { input, axes, cause } = *sample;
        if cause == Cause::Rearm {
            self.learners.rearm(input, axes);
            return Next::Wait;
        }
        let crossed = self.learners.calls(input, axes);
        // Where the chip compared, its comparison decides.
        if crossed || cause == Cause::Threshold {
            self.schedule.ask(input);
        }
        if self.supervisor.is_learning() {
            self.learners.hold(at, input, command, tell);
        }
        if GATES.contains(input) {
            self.end_hyperperiod(at, Inputs::NONE.with(input))
        } else {
            self.next_if_asked()
        }
    }

    /// Takes a setpoint: past its quantum it forces a run, and so does the `first` of all.
    pub fn take_setpoint(&mut self, setpoint: &Setpoint, first: bool) {
        if first || self.setpoints.calls(setpoint) {
            self.schedule.ask_for_setpoint();
        }
    }

    /// Takes a goal, behind one that was in force: past its quantum it forces a run.
    pub fn take_goal(&mut self, before: Option<&Goal>, goal: &Goal) {
        if self.setpoints.take_goal(before, goal) {
            self.schedule.ask_for_setpoint();
        }
    }

    /// True where setpoints turn so fast (rad/s) that models learned before say nothing.
    #[must_use]
    pub fn are_aerobatics(turning: f32) -> bool {
        turning > AEROBATICS
    }

    // Running when due.

    /// Takes note of samples of gating inputs; says what the board does next.
    pub fn end_hyperperiod(&mut self, at: Instant, inputs: Inputs) -> Next {
        if !self.schedule.deliver(at, inputs) {
            self.next_if_asked()
        } else if self.schedule.end_hyperperiod(at, self.supervisor.phase()) {
            Next::Hyperperiod
        } else {
            Next::Wait
        }
    }

    /// What was asked for runs at the hyperperiod's end, should its last sample not come.
    fn next_if_asked(&self) -> Next {
        if self.phase() == Phase::Reactive && !self.schedule.asked().is_empty() {
            Next::HyperperiodAt(self.schedule.timeout())
        } else {
            Next::Wait
        }
    }

    /// A run is due at once, whatever the phase.
    pub fn force(&mut self, reason: Reason) {
        self.schedule.force(reason);
    }

    /// True, and counted, where a run is due since a hyperperiod or longer.
    pub fn notice_late_run(&mut self, now: Instant) -> bool {
        let late = self.schedule.is_late(now);
        if late {
            self.judgement.on_late_run(now);
        }
        late
    }

    /// The reason of the run that is due at the end of a hyperperiod, if one is.
    pub fn take_due(&mut self, now: Instant) -> Option<Reason> {
        self.schedule.take_due(now, self.supervisor.phase())
    }

    /// When the failsafe run is due.
    #[must_use]
    pub fn deadline(&self) -> Instant {
        self.schedule.deadline()
    }

    /// Runs since start.
    #[must_use]
    pub fn runs(&self) -> u32 {
        self.schedule.runs()
    }

    // Learning.

    /// The control logic took motion without a run: the angle (rad) is still turned since the
    /// last run.
    pub fn on_advance(&mut self, turned: Vec3) {
        self.learners.on_advance(turned);
        self.advanced = true;
    }

    /// Judges a run and learns from it; every label is also passed to `tell`.
    pub fn learn(&mut self, run: &Run, mut tell: impl FnMut(Input, &Label)) -> Judged {
        let asked = self.schedule.asked();
        let judged = Judged {
            asked,
            expected: self.learners.expected_of(asked),
            changed: self.judgement.is_changed(run.before, run.applied),
        };
        // Without new motion a command cannot change, which teaches nothing about sensors; and
        // a setpoint that moved may have changed it whatever they said.
        let moved = core::mem::take(&mut self.advanced) || run.moved;
        if !moved || self.schedule.is_asked_by_setpoint() {
            return judged;
        }
        if matches!(run.reason, Reason::WarmUp | Reason::Fallback) {
            self.learners.hold_run(run.at, run.applied, &mut tell);
        }
        if self.phase() == Phase::Reactive
            && let Some(teaching) = self
                .judgement
                .judge(run.at, run.reason, asked, judged.changed)
        {
            self.learners.teach(&teaching, tell);
        }
        judged
    }

    /// The limit on wrong models and late runs that is passed, if one is.
    #[must_use]
    pub fn passed_limit(&self) -> Option<FallbackReason> {
        self.judgement.passed_limit()
    }

    /// What the newest models mean, once after each; `delivered` are inputs whose sensor lives.
    ///
    /// Done with the next run, not under the lock that swaps a model.
    pub fn review_models(&mut self, now: Instant, delivered: Inputs) -> Option<Review> {
        if !core::mem::take(&mut self.unreviewed) {
            return None;
        }
        let learned = self.learners.are_settled(delivered);
        let fitted = self.learners.leader_is_fitted();
        Some(match self.supervisor.judge(learned, fitted, now) {
            Some(event) => Review::Move(event),
            // First crossings taught some too little: they learn from pairs at several lags.
            None if self.supervisor.is_learning() => Review::Stay(self.learners.turn_to_lags(now)),
            None => Review::Stay(Inputs::NONE),
        })
    }

    /// After a run: its samples, its command and its setpoint are the new references.
    ///
    /// `turned` is the angle that the run took, in rad.
    pub fn on_run(&mut self, run: &Run, turned: Vec3, setpoint: &Setpoint) {
        self.schedule.on_run(run.at);
        self.setpoints.on_run(setpoint);
        self.learners
            .on_run(turned, self.supervisor.is_learning(), run.applied);
    }

    /// The labels of an input whose refit is due, copied: to be fitted in idle, without a lock.
    #[must_use]
    pub fn refit_due(&self, now: Instant) -> Option<RefitJob> {
        let learns = self.supervisor.is_learning() || self.phase() == Phase::Reactive;
        if !learns {
            return None;
        }
        Input::ALL.into_iter().find_map(|input| {
            let lesson = self.learners.lesson(input);
            (span(lesson.refitted, now) >= REFIT_INTERVAL).then_some(RefitJob {
                input,
                leads: input == self.learners.lead(),
                labels: lesson.labels,
            })
        })
    }

    /// Swaps a fit in and forgets a little; the weight of the labels behind it.
    pub fn swap_model(&mut self, now: Instant, refit: &Refit) -> f32 {
        self.unreviewed = true;
        self.learners
            .lesson_mut(refit.input)
            .on_refit(now, refit.fit)
    }

    // The phase.

    /// Moves the phase; the new one where it differs.
    pub fn on_phase_event(&mut self, event: PhaseEvent, now: Instant) -> Option<Phase> {
        let phase = self.supervisor.on(event, now)?;
        match phase {
            Phase::Fallback(reason) if reason.refutes_models() => self.learners.restart(),
            Phase::WarmUp => self.learners.return_to_crossings(),
            _ => {}
        }
        self.learners.restart_holds();
        self.judgement.restart();
        Some(phase)
    }

    /// The phase in force.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.supervisor.phase()
    }

    /// True where the gyroscope is lost.
    #[must_use]
    pub fn is_blind(&self) -> bool {
        self.phase() == Phase::Fallback(FallbackReason::ImuLost)
    }

    // What was learned.

    /// True where an input's model may ask for a run, and there is one.
    #[must_use]
    pub fn is_counted_on(&self, input: Input) -> bool {
        let lesson = self.learners.lesson(input);
        lesson.triggers && lesson.decision.model().is_some()
    }

    /// The change past which a chip shall interrupt, in the input's SI unit; `None` where every
    /// sample is wanted.
    ///
    /// A chip compares only in reactive control, with a model, against the last run's sample; one
    /// that gates has every sample waited for.
    #[must_use]
    pub fn threshold_for_chip(&self, input: Input) -> Option<f32> {
        let compares = self.phase() == Phase::Reactive
            && self.learners.reference() == Reference::LastRun
            && !GATES.contains(input)
            && self.is_counted_on(input);
        compares.then(|| self.threshold(input))
    }

    /// The change of an input above which it calls for a run, in its SI unit.
    #[must_use]
    pub fn threshold(&self, input: Input) -> f32 {
        self.learners.lesson(input).decision.threshold()
    }

    /// What the labels say of an input.
    #[must_use]
    pub fn fit(&self, input: Input) -> Fit {
        self.learners.lesson(input).decision.fit()
    }

    /// How often runs in reactive control turned out this way.
    #[must_use]
    pub fn outcomes(&self, outcome: Outcome) -> u32 {
        self.judgement.count(outcome)
    }
}

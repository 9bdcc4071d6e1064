//! Reactive control: when does a change in a sensor call for new motor commands?
//!
//! Two things call for a run. One is the impulse that the held command owes, past a budget
//! (`owed`), by a command that is predicted (`prediction`). The other is a sensor whose change says
//! so before: for each input a logistic regression gives the probability that a run now would be
//! *changed*, that its command would repay what it is worth; the inverse is a threshold, so that
//! the hot path is one comparison (Bregu et al., MobiSys 2016, sections 4 and 5). Labels come from
//! shadow holds in the warm-up, later from the runs that one input alone asked for; those of chips
//! from shadow runs at their samples. Where the impulse does not trigger, a run is changed when it
//! moves some motor by a quantum.
//!
//! [`Reactive`] is the whole rule. It is shown samples, setpoints and runs, in this order:
//!
//! ```text
//! samples  -> take_motion, take_sample -> learners: past a threshold? -> schedule: asked
//!             take_predicted           -> past the budget?            -> schedule: asked
//!             end_hyperperiod          -> schedule: is a run due?
//! a run    -> learn                    -> labels, limits      -> on_phase_event
//!             review_models, on_run    -> new references
//! idle     -> refit_due, swap_model    -> new thresholds
//!             sounding_due, on_column  -> new slopes of the prediction
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
mod owed;
mod prediction;
mod sample;
mod schedule;
mod setpoints;
mod shadow_holds;
mod shadow_runs;
mod supervisor;
mod watch;

pub use decision::{Decision, Rest};
pub use exploration::Exploration;
pub use fit::{EVIDENCE, Fit, Refit, RefitJob};
pub use labels::{BIN_COUNT, Counted, Label, Labels};
pub use learners::changes_of;
pub use limits::Limits;
pub use logistic::Logistic;
pub use outcome::Outcome;
pub use owed::{Course, Impulse, OfAxes, axes_of};
pub use prediction::{Column, Feature, Prediction, Situation, Sounding};
pub use sample::Sample;
pub use schedule::{Next, Reason};
pub use shadow_holds::{Commanded, Held, Lead, Rule, ShadowHolds, differs};
pub use supervisor::{FallbackReason, Phase, PhaseEvent, Supervisor};
pub use watch::Watch;

use crate::airframe::{Mixed, MotorShares};
use crate::config::{AEROBATICS, REFIT_INTERVAL};
use crate::control::{Goal, Setpoint};
use crate::estimate::Motion;
use crate::graph::ControlLogic;
use crate::math::{Vec3, min};
use crate::sensors::{Cause, ChipSample, Input, Inputs};
use crate::settings::{Reference, Settings};
use crate::time::{Instant, span};
use hyperperiod::GATES;
use judgement::{Judgement, Verdict};
use learners::Learners;
use owed::{Budget, Looks};
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
    prediction: Prediction,
    looks: Looks,
    /// What a sample of the inertial sensor says that may call for a run, by the models as they are.
    watched: Inputs,
    /// The control logic took motion that no run has taught by yet.
    advanced: bool,
    /// Models were swapped in that no run has reviewed yet.
    unreviewed: bool,
    /// No refit is due before.
    next_refit: Instant,
}

/// What is wanted of the command that a run would compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foresight {
    /// Nothing.
    None,
    /// A prediction from the motion since the last run.
    Predicted,
    /// The command itself.
    Exact,
}

/// A run of the control logic, as the trigger rule sees it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// When it began.
    pub at: Instant,
    /// Why.
    pub reason: Reason,
    /// The motion that it took; without one a command cannot change.
    pub motion: &'a Motion,
    /// The filtered specific force (m/s2).
    pub force: Vec3,
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
    /// The command moved by a quantum or more; `None` where time must show what it repays.
    pub changed: Option<bool>,
    /// What became of the last run, where this one ends the time that it was given.
    pub last: Option<bool>,
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
    pub fn new(settings: &Settings, logic: &impl ControlLogic) -> Self {
        let axes = owed::axes_of(logic.mixer());
        let learners = Learners::new(settings, axes);
        let worth = (learners.lead() == Input::Owed).then(|| Budget::new(settings).worth);
        Self {
            schedule: Schedule::new(settings),
            learners,
            setpoints: SetpointQuanta::default(),
            supervisor: Supervisor::new(settings.policy, settings.warm_up),
            judgement: Judgement::new(settings, worth),
            prediction: Prediction::new(axes, logic.mixer().motors(), logic.derivative_cutoff()),
            looks: Looks::default(),
            watched: Inputs::NONE,
            advanced: false,
            unreviewed: false,
            next_refit: Instant::from_ticks(0),
        }
    }

    // Asking for a run.

    /// Models or the phase are new: what is watched is not worked out anew at every sample.
    fn renew_watch(&mut self) {
        self.watched = if self.learns() {
            self.learners.motion_that_may_call()
        } else {
            Inputs::NONE
        };
    }

    /// Takes what a filtered sample of the gyroscope and of the accelerometer beside it (m/s2) says.
    ///
    /// What calls for no run, however it changes, is compared at runs only, which teach by it.
    pub fn take_motion(&mut self, motion: &Motion, force: Vec3) {
        if !self.watched.is_empty() {
            self.compare(true, motion, force);
        }
    }

    /// Compares what is watched of a motion, or what is not.
    fn compare(&mut self, watched: bool, motion: &Motion, force: Vec3) {
        let samples = [
            (Input::Gyro, motion.rotation.rates.0),
            (Input::Accel, force),
            (Input::Turned, self.learners.turned(motion.sums.angle)),
        ];
        for (input, sample) in samples {
            if self.watched.contains(input) == watched && self.learners.calls(input, sample) {
                self.schedule.ask(input);
            }
        }
    }

    /// True where there is something to learn: not on the ground, blind, or by the clock alone.
    fn learns(&self) -> bool {
        self.supervisor.is_learning() || self.phase() == Phase::Reactive
    }

    /// What is wanted of the command that a run would compute now: a prediction is not at each sample.
    #[must_use]
    pub fn foresight(&mut self) -> Foresight {
        match self.foresight_in_use() {
            Foresight::Predicted if !self.looks.is_due() => Foresight::None,
            wanted => wanted,
        }
    }

    /// How a command is known before it is computed.
    ///
    /// Time-triggered control need not foresee what it computes anyway.
    #[must_use]
    pub fn foresight_in_use(&self) -> Foresight {
        let triggers = |input| self.learners.lesson(input).triggers;
        if self.phase() != Phase::Reactive {
            Foresight::None
        } else if triggers(Input::Command) {
            Foresight::Exact
        } else if !triggers(Input::Owed) {
            Foresight::None
        } else if self.prediction.is_exact() {
            Foresight::Exact
        } else {
            Foresight::Predicted
        }
    }

    /// Takes the motion since the last run, by which the command is predicted; says what became of
    /// that run, once that is seen.
    pub fn take_predicted(
        &mut self,
        now: Instant,
        motion: &Motion,
        mut tell: impl FnMut(Input, &Label),
    ) -> Option<bool> {
        let owed = *self.prediction.predict(motion);
        self.spend(now, &owed, motion, &mut tell)
    }

    /// Takes the command that a run would compute now, beside the one that is held; says what
    /// became of the last run, once that is seen.
    pub fn take_foreseen(
        &mut self,
        now: Instant,
        command: &MotorShares,
        held: &MotorShares,
        motion: &Motion,
        mut tell: impl FnMut(Input, &Label),
    ) -> Option<bool> {
        if self.learners.lesson(Input::Command).triggers && self.learners.command_calls(command) {
            self.schedule.ask(Input::Command);
        }
        if !self.learners.lesson(Input::Owed).triggers {
            return None;
        }
        let owed = *self.prediction.foresee(command, held, motion);
        self.spend(now, &owed, motion, &mut tell)
    }

    /// Asks for a run where more is owed than the budget.
    fn spend(
        &mut self,
        now: Instant,
        owed: &Impulse,
        motion: &Motion,
        tell: &mut dyn FnMut(Input, &Label),
    ) -> Option<bool> {
        let size = owed.size();
        if self.learners.owed_calls(size) {
            self.schedule.ask(Input::Owed);
        }
        self.looks.take(size, self.threshold(Input::Owed));
        if self.learners.are_shadow_runs_due(now) {
            self.follow_shadow_runs(now, owed, motion, tell);
        }
        let verdict = self.judgement.settle(now, owed)?;
        Some(self.heed(&verdict, tell))
    }

    /// Learns from runs that are imagined at samples of chips. Not inlined: it is rare.
    #[inline(never)]
    fn follow_shadow_runs(
        &mut self,
        now: Instant,
        owed: &Impulse,
        motion: &Motion,
        tell: &mut dyn FnMut(Input, &Label),
    ) {
        let off = self.prediction.off(motion);
        self.learners.foresee(now, owed, off, tell);
    }

    /// Learns from what became of the last run. Not inlined: it is rare, and in three places.
    #[inline(never)]
    fn heed(&mut self, verdict: &Verdict, tell: &mut dyn FnMut(Input, &Label)) -> bool {
        if let Some(teaching) = &verdict.teaching {
            self.learners.teach(teaching, true, tell);
        }
        verdict.changed
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
            self.learners.refer(at, input, axes);
            return Next::Wait;
        }
        let crossed = self.learners.calls(input, axes);
        // Where the chip compared, its comparison decides.
        if crossed || cause == Cause::Threshold && self.learners.lesson(input).triggers {
            self.schedule.ask(input);
        }
        let learning = self.supervisor.is_learning();
        if learning && !self.counts_impulses() {
            self.learners.hold(at, input, command, tell);
        } else if learning
            || self.phase() == Phase::Reactive && self.learners.learns_from_samples(input)
        {
            self.learners.imagine_run(at, input, command);
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

    /// The control logic took motion without a run, while another command is held: the angle is
    /// still turned since the last run, and what is owed stays owed.
    pub fn on_advance(&mut self, motion: &Motion, command: &Mixed, held: &MotorShares) {
        self.learners.on_advance(motion.sums.angle);
        if self.counts_impulses() {
            self.prediction.on_advance(command, held, motion);
        }
        self.advanced = true;
    }

    /// A setpoint or a place changed the control logic's command; no motion came beyond this one.
    pub fn on_joined(&mut self, command: &Mixed, motion: &Motion) {
        self.looks = Looks::default();
        if self.counts_impulses() {
            self.prediction.on_joined(command, motion);
        }
    }

    /// Judges a run and learns from it; every label is also passed to `tell`.
    pub fn learn(&mut self, run: &Run, mut tell: impl FnMut(Input, &Label)) -> Judged {
        let moved = core::mem::take(&mut self.advanced) || run.motion.sums.dt > 0.0;
        if self.looks.left_one_out() && self.foresight_in_use() == Foresight::Predicted {
            self.prediction.predict(run.motion);
        }
        if moved && self.learns() {
            self.compare(false, run.motion, run.force);
        }
        let asked = self.schedule.asked();
        let mut judged = Judged {
            asked,
            expected: self.learners.expected_of(asked),
            changed: None,
            last: None,
        };
        let axes = self.prediction.axes();
        let gain = (self.counts_impulses()).then(|| axes.between(run.before, run.applied));
        match gain {
            Some(gain) => {
                judged.last = self.settle_last(run.at, gain, &mut tell);
                if self.phase() == Phase::Reactive {
                    let owed = self.prediction.owed();
                    self.learners.go_on(run.at, owed, gain);
                }
            }
            None => judged.changed = Some(self.judgement.is_changed(run.before, run.applied)),
        }
        // Without new motion a command cannot change, which teaches nothing about sensors; and
        // a setpoint that moved may have changed it whatever they said.
        if !moved || self.schedule.is_asked_by_setpoint() {
            return judged;
        }
        if matches!(run.reason, Reason::WarmUp | Reason::Fallback) {
            self.learners.hold_run(run.at, run.applied, &mut tell);
        }
        if self.phase() != Phase::Reactive {
            return judged;
        }
        if let Some(gain) = gain {
            self.judgement
                .await_repayment(run.at, run.reason, asked, gain);
        } else if let Some(changed) = judged.changed
            && let Some(teaching) = self.judgement.judge(run.at, run.reason, asked, changed)
        {
            self.learners.teach(&teaching, false, &mut tell);
        }
        judged
    }

    /// What became of the last run, where this one, whose command moved by `gain`, ends the time that
    /// it was given.
    fn settle_last(
        &mut self,
        now: Instant,
        gain: OfAxes,
        tell: &mut dyn FnMut(Input, &Label),
    ) -> Option<bool> {
        let owed = self.prediction.owed();
        let verdict = self.judgement.settle_early(now, owed, gain)?;
        Some(self.heed(&verdict, tell))
    }

    /// The limit on wrong models and late runs that is passed, if one is.
    ///
    /// Beside a budget no model is needed: where sensors ask wrongly too often they are silenced
    /// until they have learned anew, and reactive control goes on.
    #[must_use]
    pub fn passed_limit(&mut self) -> Option<FallbackReason> {
        let passed = self.judgement.passed_limit()?;
        if passed == FallbackReason::FalsePositives && self.counts_impulses() {
            self.learners.silence();
            self.renew_watch();
            self.judgement.restart();
            return None;
        }
        Some(passed)
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
    /// `command` is what the control logic computed; the gate may have stopped it. False where it
    /// refutes the predictions, so that commands are foreseen exactly until the next sounding.
    #[must_use]
    pub fn on_run(&mut self, run: &Run, command: &Mixed, setpoint: &Setpoint) -> bool {
        self.schedule.on_run(run.at);
        self.looks = Looks::default();
        self.setpoints.on_run(setpoint);
        let turned = run.motion.sums.angle;
        self.learners
            .on_run(turned, self.supervisor.is_learning(), run.applied);
        !self.counts_impulses() || self.prediction.on_run(command, run.applied, run.motion)
    }

    /// The control logic, copied, where it is to be sounded: in idle, without a lock.
    #[must_use]
    pub fn sounding_due<L: ControlLogic + Clone>(
        &self,
        now: Instant,
        logic: &L,
        situation: &Situation,
    ) -> Option<Sounding<L>> {
        let due = self.prediction.is_sounding_due(now) && self.counts_impulses() && self.learns();
        due.then(|| Sounding::new(logic, self.prediction.axes(), situation))
    }

    /// A sounding ended: another one is due after a while.
    pub fn on_sounded(&mut self, now: Instant) {
        self.prediction.on_sounded(now);
    }

    /// Takes what a sounding found of one feature; false where that is not finite, so that commands
    /// are foreseen exactly until the next sounding.
    #[must_use]
    pub fn on_column(&mut self, column: &Column) -> bool {
        self.prediction.on_column(column)
    }

    /// True where a run is changed by what it repays, not by what it moves.
    fn counts_impulses(&self) -> bool {
        self.learners.lead() == Input::Owed
    }

    /// The labels of an input whose refit is due, copied: to be fitted in idle, without a lock.
    #[must_use]
    pub fn refit_due(&mut self, now: Instant) -> Option<RefitJob> {
        if now < self.next_refit || !self.learns() {
            return None;
        }
        let learning = self.supervisor.is_learning();
        let found = Input::ALL.into_iter().find_map(|input| {
            let lesson = self.learners.lesson(input);
            let due = span(lesson.refitted, now) >= REFIT_INTERVAL;
            // To settle, a model must be seen to stay where it is.
            let due = due && (learning || lesson.has_news(now));
            due.then_some(RefitJob {
                input,
                leads: self.learners.stands_alone(input),
                evidence: self.learners.evidence_of(input),
                labels: lesson.labels,
            })
        });
        if found.is_none() {
            // No setting: a refit comes a quarter late at most, and few samples pay for the look.
            self.next_refit = now + REFIT_INTERVAL / 4;
        }
        found
    }

    /// Swaps a fit in and forgets a little; the weight of the labels behind it.
    pub fn swap_model(&mut self, now: Instant, refit: &Refit) -> f32 {
        self.unreviewed = true;
        let weight = self
            .learners
            .lesson_mut(refit.input)
            .on_refit(now, refit.fit);
        self.renew_watch();
        weight
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
        if self.supervisor.is_learning() {
            self.learners.begin(now);
        }
        self.learners.restart_holds();
        self.judgement.restart();
        self.renew_watch();
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
    /// Every sample teaches in the warm-up, is waited for where it gates, and is the reference of the
    /// next with `previous-sample`. Else a chip compares, with its highest code where nothing is asked
    /// of it.
    #[must_use]
    pub fn threshold_for_chip(&self, input: Input) -> Option<f32> {
        let asks = self.phase() == Phase::Reactive && self.learners.lesson(input).triggers;
        let follows = asks && self.learners.reference() == Reference::PreviousSample;
        if self.supervisor.is_learning() || GATES.contains(input) || follows {
            None
        } else if asks {
            Some(min(self.threshold(input), f32::MAX))
        } else {
            Some(f32::MAX)
        }
    }

    /// The change of an input above which it calls for a run, in its SI unit.
    #[must_use]
    pub fn threshold(&self, input: Input) -> f32 {
        self.learners.lesson(input).decision.threshold()
    }

    /// The labels of an input.
    #[must_use]
    pub fn labels(&self, input: Input) -> &Labels {
        &self.learners.lesson(input).labels
    }

    /// What the labels say of an input.
    #[must_use]
    pub fn fit(&self, input: Input) -> Fit {
        self.learners.lesson(input).decision.fit()
    }

    /// The change of an input that the last run met.
    #[must_use]
    pub fn change_met(&self, input: Input) -> Option<f32> {
        self.learners.lesson(input).decision.met()
    }

    /// False where a model is no number.
    #[must_use]
    pub fn are_models_sane(&self) -> bool {
        Input::ALL
            .into_iter()
            .all(|input| self.fit(input).is_usable())
    }

    /// How often runs in reactive control turned out this way.
    #[must_use]
    pub fn outcomes(&self, outcome: Outcome) -> u32 {
        self.judgement.count(outcome)
    }
}

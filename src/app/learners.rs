//! What each input learns and decides by.
//!
//! Four inputs are sensed, two are derived from the gyroscope at each of its samples: the angle
//! turned since the last run, and the command that a run would come to. One input *leads*, the
//! one that knows most of what a change does: the foreseen command where that may trigger, else
//! the gyroscope, else the angle. The others are relevant for what they tell before it does.

use super::Recorder;
use crate::airframe::MotorShares;
use crate::config::{
    ACCEL, CHIP_ACCEL, CHIP_MAG, COMMAND, Changes, GYRO, LABELS_OF_EACH_CLASS, STABLE_CHANGE,
    TURNED,
};
use crate::control::Setpoint;
use crate::math::Vec3;
use crate::reactive::{
    Decision, Fit, Held, Label, Labels, Lead, Logistic, Rule, Sample, ShadowHolds, Watch,
};
use crate::sensors::{Input, Inputs};
use crate::settings::{Reference, Settings};
use crate::time::Instant;

/// One input: what it is measured against, what it learned.
#[derive(Clone, Debug)]
pub(super) struct Learner<S = Vec3> {
    pub(super) watch: Watch<S>,
    pub(super) lesson: Lesson,
    holds: ShadowHolds<S>,
}

/// What one input learned, whatever its samples are.
#[derive(Clone, Debug)]
pub(super) struct Lesson {
    pub(super) decision: Decision,
    pub(super) labels: Labels,
    /// Its model may ask for a run.
    pub(super) triggers: bool,
    pub(super) refitted: Instant,
    /// Refits in a row that left the threshold where it was.
    stable: u8,
}

/// One learner per input.
#[derive(Clone, Debug)]
pub(super) struct Learners {
    pub(super) gyro: Learner,
    pub(super) accel: Learner,
    pub(super) chip_accel: Learner,
    pub(super) chip_mag: Learner,
    pub(super) turned: Learner,
    pub(super) command: Learner<MotorShares>,
    lead: Input,
    rule: Rule,
    /// Angle turned in earlier runs, which the shadow holds look back to.
    turned_before: Vec3,
    setpoint: Setpoint,
    /// Inputs whose shadow holds start anew with their next sample, not under whoever's lock.
    stale_holds: Inputs,
}

impl<S: Sample> Learner<S> {
    fn new(input: Input, changes: &Changes, settings: &Settings) -> Self {
        Self {
            watch: Watch::new(settings.reference),
            lesson: Lesson {
                decision: Decision::new(settings.p_run),
                labels: Labels::new(changes),
                triggers: settings.triggers.contains(input),
                refitted: Instant::from_ticks(0),
                stable: 0,
            },
            holds: ShadowHolds::new(changes),
        }
    }

    /// Takes a sample; true where its change calls for a run.
    pub(super) fn calls(&mut self, sample: S) -> bool {
        let x = self.watch.take(sample);
        self.lesson.decision.take(x) && self.lesson.triggers
    }

    fn on_run(&mut self) {
        self.watch.on_run();
        self.lesson.decision.on_run();
    }

    /// What is measured against is this sample now.
    pub(super) fn rearm(&mut self, sample: S) {
        self.watch.rearm(sample);
        self.lesson.decision.on_run();
    }

    /// Shows a sample, with the command in force, to the shadow holds.
    fn hold(
        &mut self,
        now: Instant,
        newest: &Held<S>,
        rule: &Rule,
        lead: &Lead,
        tell: impl FnMut(&Label),
    ) {
        self.holds
            .take(now, newest, rule, lead, &mut self.lesson.labels, tell);
    }
}

impl Lesson {
    /// Swaps a fit in; keeps count of how long the threshold has been stable.
    ///
    /// Where labels became too few to fit again, what they said while there were enough stays:
    /// a threshold that hides changes also starves its own labels.
    pub(super) fn swap(&mut self, fit: Fit) {
        let starved = self.labels.of_rarer_class() < LABELS_OF_EACH_CLASS as f32;
        if fit == Fit::Unfit && starved && self.decision.fit() != Fit::Unfit {
            return;
        }
        let before = self.decision.model().map(|_| self.decision.threshold());
        self.decision.set_fit(fit);
        self.stable = match (before, self.decision.model()) {
            (Some(threshold), Some(model)) if self.is_still_right(threshold, &model) => {
                self.stable.saturating_add(1)
            }
            _ => 0,
        };
    }

    /// True where a newer model sees an older threshold close to `P_run` too.
    fn is_still_right(&self, threshold: f32, newer: &Logistic) -> bool {
        (newer.probability(threshold) - self.decision.p_run()).abs() <= STABLE_CHANGE
    }

    /// Stable and with labels of both classes, or known not to matter.
    pub(super) fn is_settled(&self) -> bool {
        match self.decision.fit() {
            _ if !self.triggers => true,
            Fit::Irrelevant => true,
            Fit::Unfit => false,
            Fit::Model(_) => {
                self.stable >= 2 && self.labels.of_rarer_class() >= LABELS_OF_EACH_CLASS as f32
            }
        }
    }

    /// Forgets everything: what was learned elsewhere holds no longer.
    fn restart(&mut self) {
        self.labels.fade(0.0);
        self.decision.set_fit(Fit::Unfit);
        self.stable = 0;
    }

    /// Counts what the present change came to; nothing where no change was measured.
    pub(super) fn label(&mut self, changed: bool, weight: f32) -> Option<Label> {
        let x = self.decision.change()?;
        let label = Label { x, changed, weight };
        self.labels.add(&label);
        Some(label)
    }
}

/// Calls a method of every learner, whatever its samples are.
macro_rules! each {
    ($learners:ident.$method:ident $arguments:tt) => {
        $learners.gyro.$method $arguments;
        $learners.accel.$method $arguments;
        $learners.chip_accel.$method $arguments;
        $learners.chip_mag.$method $arguments;
        $learners.turned.$method $arguments;
        $learners.command.$method $arguments;
    };
}

impl Learners {
    pub(super) fn new(settings: &Settings) -> Self {
        let lead = [Input::Command, Input::Gyro]
            .into_iter()
            .find(|input| settings.triggers.contains(*input))
            .unwrap_or(Input::Turned);
        let command = COMMAND.times(settings.quantum);
        Self {
            gyro: Learner::new(Input::Gyro, &GYRO.changes, settings),
            accel: Learner::new(Input::Accel, &ACCEL.changes, settings),
            chip_accel: Learner::new(Input::ChipAccel, &CHIP_ACCEL.changes, settings),
            chip_mag: Learner::new(Input::ChipMag, &CHIP_MAG.changes, settings),
            turned: Learner::new(Input::Turned, &TURNED, settings),
            command: Learner::new(Input::Command, &command, settings),
            lead,
            rule: Rule {
                reference: settings.reference,
                pairs: settings.pairs,
                quantum: settings.quantum,
                failsafe: settings.failsafe,
            },
            turned_before: Vec3::ZERO,
            setpoint: Setpoint::default(),
            stale_holds: Inputs::NONE,
        }
    }

    /// The input that the others are judged against.
    pub(super) fn lead(&self) -> Input {
        self.lead
    }

    /// The learner of an input with three axes; `None` for the command.
    pub(super) fn of_axes(&mut self, input: Input) -> Option<&mut Learner> {
        match input {
            Input::Gyro => Some(&mut self.gyro),
            Input::Accel => Some(&mut self.accel),
            Input::ChipAccel => Some(&mut self.chip_accel),
            Input::ChipMag => Some(&mut self.chip_mag),
            Input::Turned => Some(&mut self.turned),
            Input::Command => None,
        }
    }

    pub(super) fn lesson(&self, input: Input) -> &Lesson {
        match input {
            Input::Gyro => &self.gyro.lesson,
            Input::Accel => &self.accel.lesson,
            Input::ChipAccel => &self.chip_accel.lesson,
            Input::ChipMag => &self.chip_mag.lesson,
            Input::Turned => &self.turned.lesson,
            Input::Command => &self.command.lesson,
        }
    }

    pub(super) fn lesson_mut(&mut self, input: Input) -> &mut Lesson {
        match input {
            Input::Gyro => &mut self.gyro.lesson,
            Input::Accel => &mut self.accel.lesson,
            Input::ChipAccel => &mut self.chip_accel.lesson,
            Input::ChipMag => &mut self.chip_mag.lesson,
            Input::Turned => &mut self.turned.lesson,
            Input::Command => &mut self.command.lesson,
        }
    }

    /// True where the angle turned since the last run calls for a run.
    pub(super) fn turned_calls(&mut self, since_last_run: Vec3) -> bool {
        self.turned.calls(self.turned_before + since_last_run)
    }

    /// The largest probability of a changed command by a model among those that asked.
    pub(super) fn expected_of(&self, asked: Inputs) -> Option<f32> {
        Input::ALL
            .into_iter()
            .filter(|input| asked.contains(*input))
            .filter_map(|input| self.lesson(input).decision.probability())
            .reduce(f32::max)
    }

    /// Shows the samples of a time-triggered run to the shadow holds.
    pub(super) fn hold_run(
        &mut self,
        now: Instant,
        command: &MotorShares,
        recorder: &mut impl Recorder,
    ) {
        for input in [Input::Gyro, Input::Accel, Input::Turned] {
            self.hold(now, input, command, recorder);
        }
        let (rule, Some(lead)) = (self.rule, self.lead_for(Input::Command)) else {
            return;
        };
        let newest = Held {
            sample: *command,
            command: *command,
            rates: self.gyro.watch.newest().unwrap_or_default(),
        };
        if self.takes_stale(Input::Command) {
            self.command.holds.restart();
        }
        let tell = |label: &Label| recorder.label(Input::Command, label);
        self.command.hold(now, &newest, &rule, &lead, tell);
    }

    /// Shows the newest sample of an input, with the command in force, to its shadow holds.
    pub(super) fn hold(
        &mut self,
        now: Instant,
        input: Input,
        command: &MotorShares,
        recorder: &mut impl Recorder,
    ) {
        let (rule, Some(lead)) = (self.rule, self.lead_for(input)) else {
            return;
        };
        let rates = self.gyro.watch.newest().unwrap_or_default();
        let stale = self.takes_stale(input);
        let Some(learner) = self.of_axes(input) else {
            return;
        };
        if stale {
            learner.holds.restart();
        }
        if let Some(sample) = learner.watch.newest() {
            let newest = Held {
                sample,
                command: *command,
                rates,
            };
            let tell = |label: &Label| recorder.label(input, label);
            learner.hold(now, &newest, &rule, &lead, tell);
        }
    }

    /// Who is asked before an input; `None` while that has no model to be asked for.
    fn lead_for(&self, input: Input) -> Option<Lead> {
        if input == self.lead {
            return Some(Lead::Itself);
        }
        let decision = &self.lesson(self.lead).decision;
        decision.model().map(|_| match self.lead {
            Input::Command => Lead::Command(decision.threshold()),
            Input::Gyro => Lead::Gyro(decision.threshold()),
            // An angle alone is too weak a leader to overtake anybody.
            _ => Lead::Itself,
        })
    }

    /// True once for an input whose shadow holds start anew.
    fn takes_stale(&mut self, input: Input) -> bool {
        let stale = self.stale_holds.contains(input);
        self.stale_holds = self.stale_holds.without(input);
        stale
    }

    pub(super) fn restart_holds(&mut self) {
        self.stale_holds = Inputs::ALL;
        // Sums of a whole flight would lose the small angles that a hold turns by.
        self.turned_before = Vec3::ZERO;
        self.turned.rearm(Vec3::ZERO);
    }

    /// Forgets all labels and models.
    pub(super) fn restart(&mut self) {
        for input in Input::ALL {
            self.lesson_mut(input).restart();
        }
    }

    /// After a run: its samples, its command and its setpoint are the new references.
    ///
    /// `turned` is the angle that the run took, `learning` whether shadow holds look further
    /// back than to this run.
    pub(super) fn on_run(
        &mut self,
        turned: Vec3,
        learning: bool,
        command: &MotorShares,
        setpoint: &Setpoint,
    ) {
        each!(self.on_run());
        let last_run = self.rule.reference == Reference::LastRun;
        self.turned_before = if learning || !last_run {
            self.turned_before + turned
        } else {
            Vec3::ZERO
        };
        if last_run {
            self.turned.rearm(self.turned_before);
            self.command.rearm(*command);
        }
        self.setpoint = *setpoint;
    }

    /// The graph took motion, but no run came of it: angles are still turned since the last run.
    pub(super) fn on_advance(&mut self, turned: Vec3) {
        self.turned_before += turned;
    }

    pub(super) fn setpoint_of_last_run(&self) -> &Setpoint {
        &self.setpoint
    }
}

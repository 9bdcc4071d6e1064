//! What each input learns and decides by.
//!
//! Some inputs are sensed, others derived at each burst: the angle turned since the last run, the
//! command that a run would compute, and the impulse that the held one owes. One input *leads*,
//! the one that knows most of what a change does: of those that may trigger the impulse owed, else
//! the command, else the gyroscope, else the angle. The others are relevant for changes that they
//! show before it does; those of chips that compare are a second opinion, judged by themselves.

mod learner;
#[cfg(test)]
mod tests;

pub(super) use learner::Lesson;
pub use learner::changes_of;
use learner::{Learner, Showing};

use super::outcome::Teaching;
use super::owed::{Budget, Course, Impulse, OfAxes};
use super::shadow_runs::ShadowRuns;
use super::{Commanded, EVIDENCE, Label, Lead, Rest, Rule, Sample};
use crate::airframe::{Axes, MotorShares};
use crate::math::Vec3;
use crate::sensors::{Input, Inputs};
use crate::settings::{Feedback, Pairs, Reference, Settings};
use crate::time::{Instant, span};

/// One learner per input.
#[derive(Clone, Debug)]
pub(super) struct Learners {
    /// Those of three axes, by the number of their input.
    of_axes: [Learner; Input::OF_AXES.len()],
    command: Learner<MotorShares>,
    owed: Learner<Course>,
    lead: Input,
    /// The way of the command, where it leads over time; in reactive control while a shadow run needs it.
    course: Option<Course>,
    /// When control last ran in reactive control.
    ran: Instant,
    /// The run that the budget would have called for last in the warm-up, which runs more often.
    budgeted: Option<Course>,
    shadow_runs: ShadowRuns,
    feedback: Feedback,
    axes: Axes,
    rule: Rule,
    /// Angle turned in earlier runs, which the shadow holds look back to.
    turned_before: Vec3,
    /// Inputs whose shadow holds start anew with their next sample, not under whoever's lock.
    stale_holds: Inputs,
    /// Inputs that first crossings taught too little: their shadow holds end after lags.
    lagging: Inputs,
}

impl Learners {
    pub(super) fn new(settings: &Settings, axes: Axes) -> Self {
        let lead = [Input::Owed, Input::Command, Input::Gyro]
            .into_iter()
            .find(|input| settings.triggers.contains(*input))
            .unwrap_or(Input::Turned);
        let budget = Budget::new(settings);
        // A budget is there from the start: what has no model yet need not ask.
        let rest = if lead == Input::Owed {
            Rest::Closed
        } else {
            Rest::Open
        };
        Self {
            of_axes: Input::each_of_axes(|input| Learner::new(input, settings, rest)),
            command: Learner::new(Input::Command, settings, rest),
            owed: Learner::new(Input::Owed, settings, Rest::Budget(budget.most)),
            lead,
            course: None,
            ran: Instant::from_ticks(0),
            budgeted: None,
            shadow_runs: ShadowRuns::new(),
            feedback: settings.feedback,
            axes,
            rule: Rule {
                reference: settings.reference,
                pairs: settings.pairs,
                counts: if lead == Input::Owed {
                    budget.worth
                } else {
                    settings.quantum
                },
                failsafe: settings.failsafe,
            },
            turned_before: Vec3::ZERO,
            stale_holds: Inputs::NONE,
            lagging: Inputs::NONE,
        }
    }

    /// The input that the others are judged against.
    pub(super) fn lead(&self) -> Input {
        self.lead
    }

    /// What changes are measured against.
    pub(super) fn reference(&self) -> Reference {
        self.rule.reference
    }

    /// Takes a sample of an input with three axes; true where its change calls for a run.
    pub(super) fn calls(&mut self, input: Input, sample: Vec3) -> bool {
        let learner = self.of_axes(input);
        learner.is_some_and(|learner| learner.calls(&sample))
    }

    /// The angle turned, which is measured against that of the last run.
    pub(super) fn turned(&self, since_last_run: Vec3) -> Vec3 {
        self.turned_before + since_last_run
    }

    /// True where the command that a run would compute calls for it.
    pub(super) fn command_calls(&mut self, command: &MotorShares) -> bool {
        self.command.calls(command)
    }

    /// True where so much owed is past the budget.
    pub(super) fn owed_calls(&mut self, owed: f32) -> bool {
        self.owed.lesson.decision.take(Some(owed)) && self.owed.lesson.triggers
    }

    /// What a sample of the inertial sensor says that may call for a run.
    pub(super) fn motion_that_may_call(&self) -> Inputs {
        let each = self.rule.reference == Reference::PreviousSample;
        let may_call = |input: &Input| each || self.lesson(*input).may_call();
        let inputs = [Input::Gyro, Input::Accel, Input::Turned];
        inputs.into_iter().filter(may_call).collect()
    }

    /// What an input is measured against is this sample now.
    pub(super) fn rearm(&mut self, input: Input, sample: Vec3) {
        if let Some(learner) = self.of_axes(input) {
            learner.rearm(sample);
        }
    }

    /// A chip took its reference.
    pub(super) fn refer(&mut self, at: Instant, input: Input, sample: Vec3) {
        self.rearm(input, sample);
        self.shadow_runs.refer(at, input);
    }

    /// The learner of an input with three axes; `None` for others.
    fn of_axes(&mut self, input: Input) -> Option<&mut Learner> {
        self.of_axes.get_mut(input as usize)
    }

    /// What an input learned.
    pub(super) fn lesson(&self, input: Input) -> &Lesson {
        match (self.of_axes.get(input as usize), input) {
            (Some(learner), _) => &learner.lesson,
            (None, Input::Owed) => &self.owed.lesson,
            (None, _) => &self.command.lesson,
        }
    }

    pub(super) fn lesson_mut(&mut self, input: Input) -> &mut Lesson {
        match (self.of_axes.get_mut(input as usize), input) {
            (Some(learner), _) => &mut learner.lesson,
            (None, Input::Owed) => &mut self.owed.lesson,
            (None, _) => &mut self.command.lesson,
        }
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
        mut tell: impl FnMut(Input, &Label),
    ) {
        if self.lead == Input::Owed {
            let of_axes = self.of_command(command);
            let course = self.course.get_or_insert(Course::begun(now, of_axes));
            course.go_on(now, of_axes);
            let course = *course;
            self.follow(&course, &mut tell);
            self.budget(&course);
        }
        for input in Inputs::OF_IMU.iter() {
            self.hold(now, input, command, &mut tell);
        }
    }

    /// Shows the newest sample of an input, with the command in force, to its shadow holds.
    pub(super) fn hold(
        &mut self,
        now: Instant,
        input: Input,
        command: &MotorShares,
        mut tell: impl FnMut(Input, &Label),
    ) {
        if !self.lesson(input).triggers {
            return;
        }
        let Some(lead) = self.lead_for(input) else {
            return;
        };
        let showing = Showing {
            now,
            command: match (self.lead, self.course) {
                (Input::Owed, None) => return,
                (Input::Owed, Some(course)) => Commanded::Over(course),
                _ => Commanded::Now(*command),
            },
            rates: self.newest(Input::Gyro).unwrap_or_default(),
            rule: self.rule_for(input),
            lead,
            anew: self.takes_stale(input),
        };
        let tell = |label: &Label| tell(input, label);
        match self.of_axes(input) {
            Some(learner) => learner.hold(learner.watch.newest(), &showing, tell),
            None if input == Input::Owed => self.owed.hold(self.course, &showing, tell),
            None => self.command.hold(Some(*command), &showing, tell),
        }
    }

    /// A command about the axes.
    fn of_command(&self, command: &MotorShares) -> OfAxes {
        let still = MotorShares::all(0.0, command.len());
        self.axes.between(&still, command)
    }

    /// In the warm-up chips meet the holds of the budget, not those of the many runs.
    fn budget(&mut self, course: &Course) {
        let (most, failsafe) = (self.owed.lesson.decision.threshold(), self.rule.failsafe);
        let lasts = |since: &Course| {
            course.change_since(since) <= most && span(since.at(), course.at()) < failsafe
        };
        if self.budgeted.as_ref().is_some_and(lasts) {
            return;
        }
        self.budgeted = Some(*course);
        for input in Input::OF_CHIPS {
            if let Some(learner) = self.of_axes(input) {
                learner.watch.on_run();
            }
            self.shadow_runs.refer(course.at(), input);
        }
    }

    /// A chip sampled, with a command in force: what would a run now repay?
    ///
    /// In the warm-up the command is that of the budget's last run, not that of the newest.
    pub(super) fn imagine_run(&mut self, at: Instant, input: Input, command: &MotorShares) {
        let begun = Course::begun(self.ran, self.of_command(command));
        let lesson = self.lesson(input);
        let (triggers, change) = (lesson.triggers, lesson.decision.change());
        if let (true, Some(x)) = (triggers, change) {
            let run = self.budgeted.or(self.course).unwrap_or(begun);
            if self.shadow_runs.sample(at, input, x, &run) {
                self.course.get_or_insert(run);
            }
        }
    }

    /// True where a run that is imagined has something to learn from the command now.
    pub(super) fn are_shadow_runs_due(&self, now: Instant) -> bool {
        self.shadow_runs.are_due(now)
    }

    /// The command is `off` from the held one, which owes so much: what imagined runs learn from it.
    pub(super) fn foresee(
        &mut self,
        now: Instant,
        owed: &Impulse,
        off: OfAxes,
        tell: &mut dyn FnMut(Input, &Label),
    ) {
        if let Some(mut course) = self.course {
            course.spend(now, owed, off);
            self.follow(&course, tell);
        }
    }

    /// A run moved the command by `gain`; the one before owed so much.
    pub(super) fn go_on(&mut self, now: Instant, owed: &Impulse, gain: OfAxes) {
        self.ran = now;
        self.course = self.course.filter(|_| self.shadow_runs.are_under_way());
        if let Some(course) = &mut self.course {
            course.spend(now, owed, gain);
        }
    }

    /// Not inlined: it is rare, and in several places.
    #[inline(never)]
    fn follow(&mut self, course: &Course, tell: &mut dyn FnMut(Input, &Label)) {
        let worth = self.rule.counts;
        let learners = &mut self.of_axes;
        self.shadow_runs.follow(course, worth, |input, label| {
            if let Some(learner) = learners.get_mut(input as usize) {
                learner.lesson.labels.add(&label);
                tell(input, &label);
            }
        });
    }

    /// True where every sample of an input is a label, so that a run adds none.
    pub(super) fn learns_from_samples(&self, input: Input) -> bool {
        self.second_opinions().contains(input) && self.feedback == Feedback::Every
    }

    /// Adds the labels of a run, or of the last one where they come `late`.
    #[inline(never)]
    pub(super) fn teach(
        &mut self,
        teaching: &Teaching,
        late: bool,
        tell: &mut dyn FnMut(Input, &Label),
    ) {
        for input in Input::ALL {
            if teaching.inputs.contains(input)
                && !self.learns_from_samples(input)
                && let Some(label) =
                    self.lesson_mut(input)
                        .label(teaching.changed, teaching.weight, late)
            {
                tell(input, &label);
            }
        }
    }

    /// True where every model that is waited for is stable: a budget needs none, a second opinion
    /// can come later, and a sensor that delivers nothing has none.
    pub(super) fn are_settled(&self, delivered: Inputs) -> bool {
        let spared = if self.lead == Input::Owed {
            Inputs::OF_CHIPS.with(Input::Owed)
        } else {
            Inputs::NONE
        };
        let waited_for = |input: &Input| delivered.contains(*input) && !spared.contains(*input);
        let mut inputs = Input::ALL.into_iter().filter(waited_for);
        inputs.all(|input| self.lesson(input).is_settled())
    }

    /// True where the leading input has something to decide by.
    pub(super) fn leader_is_fitted(&self) -> bool {
        self.lesson(self.lead).decision.is_ready()
    }

    /// The newest sample of an input with three axes.
    fn newest(&self, input: Input) -> Option<Vec3> {
        self.of_axes.get(input as usize)?.watch.newest()
    }

    /// What an input's labels depend on.
    fn rule_for(&self, input: Input) -> Rule {
        let mut rule = self.rule;
        if self.lagging.contains(input) {
            rule.pairs = Pairs::WeightedLags;
        }
        rule
    }

    /// The inputs that learn from lags from here on: first crossings taught them too little.
    ///
    /// Their labels so far stay, what is held begins anew.
    pub(super) fn turn_to_lags(&mut self, now: Instant) -> Inputs {
        if self.rule.pairs != Pairs::FirstCrossings {
            return Inputs::NONE;
        }
        let held = self.lagging.or(self.stale_holds);
        let turning: Inputs = Input::ALL
            .into_iter()
            .filter(|input| !held.contains(*input) && self.lesson(*input).is_stuck(now))
            .collect();
        self.lagging = self.lagging.or(turning);
        self.stale_holds = self.stale_holds.or(turning);
        turning
    }

    /// First crossings again for every input, where the settings ask for them.
    pub(super) fn return_to_crossings(&mut self) {
        self.lagging = Inputs::NONE;
    }

    /// Who is asked before an input; `None` while that has no model to be asked for.
    fn lead_for(&self, input: Input) -> Option<Lead> {
        if self.stands_alone(input) {
            return Some(Lead::Itself);
        }
        let decision = &self.lesson(self.lead).decision;
        decision.is_ready().then(|| match self.lead {
            Input::Owed | Input::Command => Lead::Command(decision.threshold()),
            Input::Gyro => Lead::Gyro(decision.threshold()),
            // An angle alone is too weak a leader to overtake anybody.
            _ => Lead::Itself,
        })
    }

    /// True where an input is judged by itself: the leading one, and one that a chip compares, an
    /// independent second opinion.
    pub(super) fn stands_alone(&self, input: Input) -> bool {
        input == self.lead || self.second_opinions().contains(input)
    }

    /// Inputs that a chip compares, where a budget leads: they count whatever it knows.
    fn second_opinions(&self) -> Inputs {
        if self.lead == Input::Owed {
            Inputs::OF_CHIPS
        } else {
            Inputs::NONE
        }
    }

    /// The evidence that an input's slope needs. A second opinion needs none: where its labels say
    /// little the slope is flat, and the threshold beyond what is met.
    pub(super) fn evidence_of(&self, input: Input) -> f32 {
        if self.second_opinions().contains(input) {
            0.0
        } else {
            EVIDENCE
        }
    }

    /// True once for an input whose shadow holds start anew.
    fn takes_stale(&mut self, input: Input) -> bool {
        let stale = self.stale_holds.contains(input);
        self.stale_holds = self.stale_holds.without(input);
        stale
    }

    /// Learning begins.
    pub(super) fn begin(&mut self, now: Instant) {
        for input in Input::ALL {
            self.lesson_mut(input).begin(now);
        }
    }

    pub(super) fn restart_holds(&mut self) {
        self.stale_holds = Inputs::ALL;
        self.course = None;
        self.budgeted = None;
        self.shadow_runs.restart();
        // Sums of a whole flight would lose the small angles that a hold turns by.
        self.turned_before = Vec3::ZERO;
        self.rearm(Input::Turned, Vec3::ZERO);
    }

    /// Forgets the models of the sensors that may ask beside a budget, and their labels.
    pub(super) fn silence(&mut self) {
        for input in Input::ALL {
            if !self.stands_alone(input) {
                self.lesson_mut(input).restart();
            }
        }
    }

    /// Forgets all labels and models.
    pub(super) fn restart(&mut self) {
        for input in Input::ALL {
            self.lesson_mut(input).restart();
        }
        self.return_to_crossings();
    }

    /// After a run: its samples and its command are the new references.
    ///
    /// `turned` is the angle that the run took, `learning` whether shadow holds look further
    /// back than to this run.
    pub(super) fn on_run(&mut self, turned: Vec3, learning: bool, command: &MotorShares) {
        // A second opinion is measured from the reference that its chip took.
        let second = self.second_opinions();
        for (input, learner) in Input::OF_AXES.into_iter().zip(&mut self.of_axes) {
            if !second.contains(input) {
                learner.on_run();
            }
        }
        self.command.on_run();
        self.owed.on_run();
        let last_run = self.rule.reference == Reference::LastRun;
        self.turned_before = if learning || !last_run {
            self.turned_before + turned
        } else {
            Vec3::ZERO
        };
        if last_run {
            self.rearm(Input::Turned, self.turned_before);
            self.command.rearm(*command);
        }
    }

    /// The graph took motion, but no run came of it: angles are still turned since the last run.
    pub(super) fn on_advance(&mut self, turned: Vec3) {
        self.turned_before += turned;
    }
}

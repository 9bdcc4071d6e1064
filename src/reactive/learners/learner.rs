//! One input: what it is measured against, what it learned, and how.

use crate::config::{
    Changes, FORGETTING, LABELS_OF_EACH_CLASS, LONGEST_REFIT_INTERVAL, LONGEST_WARM_UP, REFIT_NEWS,
    STABLE_CHANGE, of_input,
};
use crate::math::Vec3;
use crate::reactive::{
    Commanded, Decision, Fit, Held, Label, Labels, Lead, Logistic, Rest, Rule, Sample, ShadowHolds,
    Watch,
};
use crate::sensors::{Input, Unit};
use crate::settings::Settings;
use crate::time::{Duration, Instant, micros, seconds, span};

/// How long first crossings may teach an input too little before it learns from lags.
///
/// Half of the longest warm-up: as long again is left to learn from lags before that ends.
pub(super) const PATIENCE: Duration = micros(LONGEST_WARM_UP.ticks() / 2);

/// The ends of the bins of an input's changes, in the unit that the firmware counts in.
pub fn changes_of(input: Input, settings: &Settings) -> Changes {
    let changes = of_input(input).changes;
    match input.declaration().unit {
        Unit::Named(_) => changes,
        Unit::Quantum => changes.times(settings.quantum),
        Unit::QuantumTime => changes.times(settings.quantum * 1e-3),
    }
}

/// One input: what it is measured against, what it learned.
#[derive(Clone, Debug)]
pub(super) struct Learner<S = Vec3> {
    pub(super) watch: Watch<S>,
    pub(super) lesson: Lesson,
    holds: ShadowHolds<S>,
}

/// What one input learned, whatever its samples are.
#[derive(Clone, Debug)]
pub(in crate::reactive) struct Lesson {
    pub(in crate::reactive) decision: Decision,
    pub(in crate::reactive) labels: Labels,
    /// Its model may ask for a run.
    pub(in crate::reactive) triggers: bool,
    pub(in crate::reactive) refitted: Instant,
    /// Weight of the labels that the last refit left.
    fitted: f32,
    /// When its shadow holds began; none before their first sample.
    held_since: Option<Instant>,
    /// Refits in a row that left the threshold where it was.
    stable: u8,
}

/// What is shown to an input's shadow holds, besides its sample.
pub(super) struct Showing {
    pub(super) now: Instant,
    pub(super) command: Commanded,
    pub(super) rates: Vec3,
    pub(super) rule: Rule,
    pub(super) lead: Lead,
    /// What was held so far is to be forgotten.
    pub(super) anew: bool,
}

impl<S: Sample> Learner<S> {
    pub(super) fn new(input: Input, settings: &Settings, rest: Rest) -> Self {
        let changes = &changes_of(input, settings);
        Self {
            watch: Watch::new(settings.reference),
            lesson: Lesson {
                decision: Decision::new(settings.p_run, rest),
                labels: Labels::new(changes),
                triggers: settings.triggers.contains(input),
                refitted: Instant::from_ticks(0),
                fitted: 0.0,
                held_since: None,
                stable: 0,
            },
            holds: ShadowHolds::new(changes),
        }
    }

    /// Takes a sample; true where its change calls for a run.
    pub(super) fn calls(&mut self, sample: &S) -> bool {
        let x = self.watch.take(sample);
        self.lesson.decision.take(x) && self.lesson.triggers
    }

    pub(super) fn on_run(&mut self) {
        self.watch.on_run();
        self.lesson.decision.on_run();
    }

    /// What is measured against is this sample now.
    pub(super) fn rearm(&mut self, sample: S) {
        self.watch.rearm(sample);
        self.lesson.decision.on_run();
    }

    /// Shows a sample, where there is one, to the shadow holds.
    ///
    /// Not inlined, as only learning does it, and in many places.
    #[inline(never)]
    pub(super) fn hold(&mut self, sample: Option<S>, showing: &Showing, tell: impl FnMut(&Label)) {
        let &Showing {
            now,
            command,
            rates,
            ref rule,
            ref lead,
            anew,
        } = showing;
        if anew {
            self.holds.restart();
            self.lesson.held_since = None;
        }
        let Some(sample) = sample else {
            return;
        };
        self.lesson.held_since.get_or_insert(now);
        let newest = Held {
            sample,
            command,
            rates,
        };
        let labels = &mut self.lesson.labels;
        self.holds.take(now, &newest, rule, lead, labels, tell);
    }
}

impl Lesson {
    /// False where no change calls for a run.
    pub(super) fn may_call(&self) -> bool {
        self.triggers && self.decision.may_call()
    }

    /// Swaps a fit in and lets the labels fade a little; their weight until now.
    pub(in crate::reactive) fn on_refit(&mut self, now: Instant, fit: Fit) -> f32 {
        let since = seconds(span(self.refitted, now));
        self.refitted = now;
        self.swap(fit);
        let weight = self.labels.total();
        self.labels.fade(1.0 - since / seconds(FORGETTING));
        self.fitted = self.labels.total();
        weight
    }

    /// True where labels came since the last refit that may move the threshold, or it is long ago.
    pub(in crate::reactive) fn has_news(&self, now: Instant) -> bool {
        let new = self.labels.total() - self.fitted;
        new > REFIT_NEWS * self.fitted || span(self.refitted, now) >= LONGEST_REFIT_INTERVAL
    }

    /// Learning begins: what passed since the last refit makes no label older.
    pub(super) fn begin(&mut self, now: Instant) {
        self.refitted = now;
    }

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

    /// True where its shadow holds taught too little for long.
    pub(super) fn is_stuck(&self, now: Instant) -> bool {
        let long = |since| span(since, now) >= PATIENCE;
        self.triggers && self.decision.fit() == Fit::Unfit && self.held_since.is_some_and(long)
    }

    /// Forgets everything: what was learned elsewhere holds no longer.
    pub(super) fn restart(&mut self) {
        self.labels.fade(0.0);
        self.decision.set_fit(Fit::Unfit);
        self.stable = 0;
    }

    /// Counts what the change that a run met came to; nothing where none was measured.
    ///
    /// The run that is going on, or, `late`, the one before.
    #[inline(never)]
    pub(super) fn label(&mut self, changed: bool, weight: f32, late: bool) -> Option<Label> {
        let x = if late {
            self.decision.met()?
        } else {
            self.decision.change()?
        };
        let label = Label { x, changed, weight };
        self.labels.add(&label);
        Some(label)
    }
}

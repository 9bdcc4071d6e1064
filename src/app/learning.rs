//! Learning: labels from runs and shadow holds, refits, and what they change.

use super::outcome::Outcome;
use super::{Autopilot, Call, Fault, Reason, Recorder};
use crate::config::{FORGETTING, REFIT_INTERVAL};
use crate::graph::ControlLogic;
use crate::reactive::{Fit, Phase, Refit, RefitJob};
use crate::sensors::{Input, Inputs};
use crate::telemetry::Event;
use crate::time::{Instant, seconds, span};

impl<R: Recorder, L: ControlLogic> Autopilot<R, L> {
    /// What a run taught: `changed` says whether it moved the command by a quantum.
    pub(super) fn learn(&mut self, now: Instant, reason: Reason, asked: Inputs, changed: bool) {
        if matches!(reason, Reason::WarmUp | Reason::Fallback) {
            self.learners
                .hold_run(now, self.gate.applied(), &mut self.recorder);
        }
        if self.supervisor.phase() != Phase::Reactive {
            return;
        }
        let Some(outcome) = Outcome::of(reason, asked, changed) else {
            return;
        };
        if let Some(count) = self.outcomes.get_mut(outcome as usize) {
            *count = count.saturating_add(1);
        }
        match reason {
            Reason::Trigger => self.limits.triggered(now, changed),
            Reason::Failsafe => self.limits.failsafe(now, changed),
            _ => {}
        }
        let Some(teaching) = outcome.teaches(self.settings.feedback, asked) else {
            return;
        };
        for input in Input::ALL {
            if teaching.inputs.contains(input) {
                let lesson = self.learners.lesson_mut(input);
                if let Some(label) = lesson.label(teaching.changed, teaching.weight) {
                    self.recorder.label(input, &label);
                }
            }
        }
    }

    /// The labels of an input whose refit is due, copied: to be fitted in idle, without a lock.
    #[must_use]
    pub fn refit_due(&self, now: Instant) -> Option<RefitJob> {
        let learns = self.supervisor.is_learning() || self.supervisor.phase() == Phase::Reactive;
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

    /// Swaps a fit in and forgets a little; the next run judges what it means.
    ///
    /// A symbol of its own, so that the lock around it can be measured.
    #[inline(never)]
    pub fn on_refit(&mut self, now: Instant, refit: Refit) {
        self.note(now, Call::Refit(refit));
        let refit = if refit.fit.is_usable() {
            refit
        } else {
            self.count(Fault::NotFinite);
            Refit {
                fit: Fit::Unfit,
                ..refit
            }
        };
        let lesson = self.learners.lesson_mut(refit.input);
        lesson.refitted = now;
        lesson.swap(refit.fit);
        let event = Event::Refit {
            input: refit.input,
            fit: refit.fit,
            threshold: lesson.decision.threshold(),
            labels: lesson.labels.total(),
        };
        lesson
            .labels
            .fade(1.0 - seconds(REFIT_INTERVAL) / seconds(FORGETTING));
        self.events.push(event);
        self.unjudged = true;
    }

    /// What the newest refits mean: whether the phase ends, and the chips' thresholds.
    ///
    /// Done with the next run, not under the lock that swaps a model.
    pub(super) fn judge_refits(&mut self, now: Instant) {
        if !core::mem::take(&mut self.unjudged) {
            return;
        }
        let learned = Input::ALL
            .into_iter()
            .all(|input| self.learners.lesson(input).is_settled() || !self.chips.delivers(input));
        let lead = self.learners.lesson(self.learners.lead());
        let fitted = lead.decision.model().is_some();
        match self.supervisor.judge(learned, fitted, now) {
            // Brings the new phase's thresholds with it.
            Some(event) => self.move_phase(event),
            None => {
                self.help_stuck_inputs(now);
                self.want_thresholds();
            }
        }
    }

    /// Lets inputs that first crossings taught too little learn from pairs at several lags.
    fn help_stuck_inputs(&mut self, now: Instant) {
        if !self.supervisor.is_learning() {
            return;
        }
        let turning = self.learners.turn_to_lags(now);
        if !turning.is_empty() {
            self.events.push(Event::Lags(turning));
        }
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
}

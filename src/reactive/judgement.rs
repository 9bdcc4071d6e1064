//! What runs turn out to be: counted, compared with limits, taught to the inputs.

use super::outcome::Teaching;
use super::{FallbackReason, Limits, Outcome, Reason, differs};
use crate::airframe::MotorShares;
use crate::sensors::Inputs;
use crate::settings::{Feedback, Settings};
use crate::time::Instant;

/// Counts runs in reactive control by their outcome.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judgement {
    /// The change of a command that counts.
    quantum: f32,
    p_run: f32,
    feedback: Feedback,
    limits: Limits,
    outcomes: [u32; Outcome::COUNT],
}

impl Judgement {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            quantum: settings.quantum,
            p_run: settings.p_run,
            feedback: settings.feedback,
            limits: Limits::default(),
            outcomes: [0; Outcome::COUNT],
        }
    }

    /// True where a run moved the command by a quantum or more.
    pub(super) fn is_changed(&self, before: &MotorShares, after: &MotorShares) -> bool {
        differs(before, after, self.quantum)
    }

    /// Counts a run in reactive control; what it teaches.
    pub(super) fn judge(
        &mut self,
        now: Instant,
        reason: Reason,
        asked: Inputs,
        changed: bool,
    ) -> Option<Teaching> {
        let outcome = Outcome::of(reason, asked, changed)?;
        if let Some(count) = self.outcomes.get_mut(outcome as usize) {
            *count = count.saturating_add(1);
        }
        match reason {
            Reason::Trigger => self.limits.triggered(now, changed),
            Reason::Failsafe => self.limits.failsafe(now, changed),
            _ => {}
        }
        outcome.teaches(self.feedback, asked)
    }

    /// A run begins a hyperperiod or more after it was due.
    pub(super) fn on_late_run(&mut self, now: Instant) {
        self.limits.late(now);
    }

    /// The first limit that is passed.
    pub(super) fn passed_limit(&self) -> Option<FallbackReason> {
        self.limits.passed(self.p_run)
    }

    /// A new phase is judged by its own runs.
    pub(super) fn restart(&mut self) {
        self.limits.restart();
    }

    /// How often runs turned out this way.
    pub(super) fn count(&self, outcome: Outcome) -> u32 {
        self.outcomes.get(outcome as usize).copied().unwrap_or(0)
    }
}

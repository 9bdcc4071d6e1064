//! What runs turn out to be: counted, compared with limits, taught to the inputs.

use super::outcome::Teaching;
use super::owed::{Impulse, OfAxes, REPAYMENT};
use super::{FallbackReason, Limits, Outcome, Reason, differs};
use crate::airframe::MotorShares;
use crate::math::max;
use crate::sensors::{Input, Inputs};
use crate::settings::{Feedback, Settings};
use crate::time::{Instant, seconds, span};

/// Counts runs in reactive control by their outcome.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judgement {
    /// The change of a command that counts.
    quantum: f32,
    p_run: f32,
    feedback: Feedback,
    limits: Limits,
    outcomes: [u32; Outcome::COUNT],
    /// The impulse that a run is worth, where that is what counts.
    worth: Option<f32>,
    awaited: Option<Awaited>,
}

/// A run whose command has yet to show what it repays.
#[derive(Clone, Copy, Debug)]
struct Awaited {
    at: Instant,
    reason: Reason,
    asked: Inputs,
    /// The new command less the one that it replaced.
    gain: OfAxes,
}

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Verdict {
    /// Its command repaid what a run is worth.
    pub(super) changed: bool,
    /// What it teaches.
    pub(super) teaching: Option<Teaching>,
}

impl Judgement {
    pub(super) fn new(settings: &Settings, worth: Option<f32>) -> Self {
        Self {
            quantum: settings.quantum,
            p_run: settings.p_run,
            feedback: settings.feedback,
            limits: Limits::default(),
            outcomes: [0; Outcome::COUNT],
            worth,
            awaited: None,
        }
    }

    /// Waits for what a run repays, whose command moved by `gain`.
    pub(super) fn await_repayment(
        &mut self,
        at: Instant,
        reason: Reason,
        asked: Inputs,
        gain: OfAxes,
    ) {
        self.awaited = Some(Awaited {
            at,
            reason,
            asked,
            gain,
        });
    }

    /// What the last run repaid, once it had its time; `owed` since that run.
    pub(super) fn settle(&mut self, now: Instant, owed: &Impulse) -> Option<Verdict> {
        let since = self.awaited.as_ref()?.at;
        if span(since, now) < REPAYMENT {
            return None;
        }
        self.conclude(now, owed, seconds(span(since, now)))
    }

    /// What the last run repaid, where another one comes before it had its time: the new command,
    /// `off` from the old one, is what would have been computed for the rest of it.
    pub(super) fn settle_early(
        &mut self,
        now: Instant,
        owed: &Impulse,
        off: OfAxes,
    ) -> Option<Verdict> {
        let since = self.awaited.as_ref()?.at;
        let (given, whole) = (seconds(span(since, now)), seconds(REPAYMENT));
        self.conclude(
            now,
            &owed.grown(off, max(whole - given, 0.0)),
            max(given, whole),
        )
    }

    fn conclude(&mut self, now: Instant, owed: &Impulse, time: f32) -> Option<Verdict> {
        let run = self.awaited.take()?;
        let changed = owed.repaid(run.gain, time) >= self.worth?;
        let teaching = self.judge(now, run.reason, run.asked, changed);
        Some(Verdict { changed, teaching })
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
            Reason::Trigger if !self.is_promised(asked) => {}
            Reason::Trigger => self.limits.triggered(now, changed),
            Reason::Failsafe => self.limits.failsafe(now, changed),
            _ => {}
        }
        outcome.teaches(self.feedback, asked)
    }

    /// True where models promise that a run is worth it: where impulses count, a budget does not, and
    /// a chip is a second opinion.
    fn is_promised(&self, asked: Inputs) -> bool {
        let by_models = !asked.contains(Input::Owed) && asked.meets(Inputs::OF_IMU);
        self.worth.is_none() || by_models
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
        self.awaited = None;
    }

    /// How often runs turned out this way.
    pub(super) fn count(&self, outcome: Outcome) -> u32 {
        self.outcomes.get(outcome as usize).copied().unwrap_or(0)
    }
}

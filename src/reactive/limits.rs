//! Limits on how wrong the models may be, and how late runs may begin.
//!
//! What models promise is never kept exactly, and a share of few runs is chance. So runs are
//! counted in two halves of a window, and judged once there are enough of them.

use super::FallbackReason;
use crate::config::{FALSE_POSITIVE_EXCESS, JUDGED_RUNS, JUDGED_WINDOW, LATE_RUNS, MISSED_EXCESS};
use crate::time::{Instant, span};

/// Failsafe runs that a share is judged by: at ten a second a window holds few.
const JUDGED_FAILSAFE_RUNS: u32 = JUDGED_RUNS / 4;

/// Counts of a window that moves on by halves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    began: Option<Instant>,
    now: Tally,
    before: Tally,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tally {
    triggered: u32,
    false_positives: u32,
    failsafe: u32,
    missed: u32,
    late: u32,
}

impl Limits {
    /// Forgets all runs.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// A run that a model asked for; `changed` says whether it moved the command by a quantum.
    pub fn triggered(&mut self, now: Instant, changed: bool) {
        let tally = self.at(now);
        tally.triggered += 1;
        tally.false_positives += u32::from(!changed);
    }

    /// A failsafe run that no model asked for.
    pub fn failsafe(&mut self, now: Instant, changed: bool) {
        let tally = self.at(now);
        tally.failsafe += 1;
        tally.missed += u32::from(changed);
    }

    /// A run that began a hyperperiod or more late.
    pub fn late(&mut self, now: Instant) {
        self.at(now).late += 1;
    }

    /// The first limit that is passed.
    #[must_use]
    pub fn passed(&self, p_run: f32) -> Option<FallbackReason> {
        let sum = |of: fn(&Tally) -> u32| of(&self.now).saturating_add(of(&self.before));
        let triggered = sum(|tally| tally.triggered);
        let failsafe = sum(|tally| tally.failsafe);
        let past = |part: u32, whole: u32, share: f32| part as f32 > share * whole as f32;
        if sum(|tally| tally.late) > LATE_RUNS {
            Some(FallbackReason::Overrun)
        } else if triggered >= JUDGED_RUNS
            && past(
                sum(|tally| tally.false_positives),
                triggered,
                1.0 - p_run + FALSE_POSITIVE_EXCESS,
            )
        {
            Some(FallbackReason::FalsePositives)
        } else if failsafe >= JUDGED_FAILSAFE_RUNS
            && past(sum(|tally| tally.missed), failsafe, p_run + MISSED_EXCESS)
        {
            Some(FallbackReason::Missed)
        } else {
            None
        }
    }

    /// The half of the window that an instant belongs to.
    fn at(&mut self, now: Instant) -> &mut Tally {
        let began = *self.began.get_or_insert(now);
        let age = span(began, now);
        if age >= JUDGED_WINDOW / 2 {
            self.before = if age >= JUDGED_WINDOW {
                Tally::default()
            } else {
                self.now
            };
            self.now = Tally::default();
            self.began = Some(now);
        }
        &mut self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    const P_RUN: f32 = 0.6;

    fn seconds(seconds: f32) -> Instant {
        at_micros((seconds * 1e6) as u64)
    }

    /// 200 triggered runs in two seconds, of which so many change nothing.
    fn triggered(false_positives: u32) -> Limits {
        let mut limits = Limits::default();
        for run in 0..200 {
            limits.triggered(seconds(run as f32 * 0.01), run >= false_positives);
        }
        limits
    }

    #[test]
    fn false_positives_may_be_what_the_models_promise_and_some_more() {
        let allowed = (200.0 * (1.0 - P_RUN + FALSE_POSITIVE_EXCESS)) as u32;
        assert_eq!(triggered(allowed).passed(P_RUN), None);
        let more = triggered(allowed + 1).passed(P_RUN);
        assert_eq!(more, Some(FallbackReason::FalsePositives));
    }

    #[test]
    fn a_few_runs_are_not_judged() {
        let mut limits = Limits::default();
        for run in 0..JUDGED_RUNS - 1 {
            limits.triggered(seconds(run as f32 * 0.01), false);
        }
        assert_eq!(limits.passed(P_RUN), None);
        limits.triggered(seconds(1.0), false);
        assert_eq!(limits.passed(P_RUN), Some(FallbackReason::FalsePositives));
    }

    #[test]
    fn failsafe_runs_that_keep_changing_the_command_show_that_changes_are_missed() {
        let mut limits = Limits::default();
        for run in 0..60 {
            limits.failsafe(seconds(run as f32 * 0.1), run % 8 != 0);
        }
        assert_eq!(limits.passed(P_RUN), Some(FallbackReason::Missed));
        limits.restart();
        for run in 0..60 {
            limits.failsafe(seconds(run as f32 * 0.1), run % 2 != 0);
        }
        assert_eq!(limits.passed(P_RUN), None);
    }

    #[test]
    fn late_runs_are_counted_within_the_window_only() {
        let mut limits = Limits::default();
        for run in 0..=LATE_RUNS {
            limits.late(seconds(run as f32 * 20.0));
        }
        assert_eq!(limits.passed(P_RUN), None);
        for run in 0..=LATE_RUNS {
            limits.late(seconds(1000.0 + run as f32 * 0.1));
        }
        assert_eq!(limits.passed(P_RUN), Some(FallbackReason::Overrun));
    }

    #[test]
    fn a_window_that_is_over_is_forgotten() {
        let mut limits = triggered(200);
        limits.triggered(seconds(60.0), true);
        assert_eq!(limits.passed(P_RUN), None);
    }
}

//! Whether the samples of the gating sensor come, and often enough.
//!
//! Silent: none for `patience`. Starved: of the samples that were due over that time, half were
//! missing, again and again. Either is over once samples come as they should.

use crate::config::HYPERPERIOD;
use crate::math::max;
use crate::time::{Duration, Instant, at_micros, micros, seconds, span};

/// How long the gating sensor may take to deliver its first sample.
const WAKING: Duration = micros(1_000_000);
/// Two of the samples that are due, in s.
const TWO_PERIODS_S: f32 = HYPERPERIOD.ticks() as f32 * 2e-6;
/// Samples in a row that came in time: the flow is back.
const STEADY: u8 = 8;

/// When the gating sensor was last heard, and how much it owes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flow {
    heard: Option<Instant>,
    /// Time without a sample beyond every second one, in s.
    owed: f32,
    /// Samples in a row that came in time.
    steady: u8,
    stopped: bool,
    /// The silence was noticed and lasts.
    silent: bool,
}

/// What a sample says about the flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heard {
    /// Time since the sample before in s; 0 for the first.
    pub(super) dt: f32,
    /// Too few came; noticed with this one.
    pub(super) starved: bool,
}

impl Flow {
    /// False from silence or starvation on until samples come as they should.
    pub(super) fn flows(&self) -> bool {
        !self.stopped
    }

    /// The gating sensor delivered a sample.
    pub(super) fn take(&mut self, at: Instant, patience: Duration) -> Heard {
        let since = self.heard.map(|before| span(before, at));
        self.heard = Some(at);
        self.silent = false;
        let Some(since) = since else {
            return Heard {
                dt: 0.0,
                starved: false,
            };
        };
        let dt = seconds(since);
        if since <= HYPERPERIOD * 2 && self.owed == 0.0 && self.steady >= STEADY {
            self.stopped = false;
            return Heard { dt, starved: false };
        }
        self.weigh(since, dt, patience)
    }

    /// What becomes of a sample that came late, or behind one that did.
    #[inline(never)]
    fn weigh(&mut self, since: Duration, dt: f32, patience: Duration) -> Heard {
        let in_time = since <= HYPERPERIOD * 3;
        self.steady = if in_time {
            self.steady.saturating_add(1)
        } else {
            0
        };
        self.owed = max(self.owed + dt - TWO_PERIODS_S, 0.0);
        let mut starved = false;
        if self.stopped {
            self.stopped = self.steady < STEADY;
            self.owed = 0.0;
        } else if self.owed >= seconds(patience) {
            self.stopped = true;
            starved = true;
        }
        Heard { dt, starved }
    }

    /// When a silence is to be noticed; `None` while one lasts.
    pub(super) fn deadline(&self, patience: Duration) -> Option<Instant> {
        let due = self.heard.map_or(at_micros(0) + WAKING, |at| at + patience);
        (!self.silent).then_some(due)
    }

    /// True once per silence that is longer than `patience`.
    ///
    /// At start-up the sensor is given its time to wake.
    pub(super) fn notice(&mut self, now: Instant, patience: Duration) -> bool {
        let noticed = self.deadline(patience).is_some_and(|due| now >= due);
        self.silent |= noticed;
        self.stopped |= noticed;
        noticed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Duration = micros(100_000);

    /// A flow behind samples at these instants, in ms; how often it starved on the way.
    fn after(milliseconds: impl IntoIterator<Item = u64>) -> (Flow, usize) {
        let mut flow = Flow::default();
        let at = milliseconds.into_iter().map(|ms| at_micros(ms * 1000));
        let starved = at.filter(|at| flow.take(*at, PATIENCE).starved).count();
        (flow, starved)
    }

    #[test]
    fn silence_is_told_once_and_over_when_samples_flow_again() {
        let (mut flow, _) = after(0..50);
        assert!(!flow.notice(at_micros(148_000), PATIENCE));
        assert!(flow.notice(at_micros(149_000), PATIENCE));
        assert!(!flow.notice(at_micros(250_000), PATIENCE));
        for ms in 300..308 {
            flow.take(at_micros(ms * 1000), PATIENCE);
            assert!(!flow.flows(), "{ms}");
        }
        flow.take(at_micros(308_000), PATIENCE);
        assert!(flow.flows());
    }

    #[test]
    fn samples_at_five_hertz_starve_and_a_tenth_of_them_missing_does_not() {
        let (flow, starved) = after((0..10).map(|sample| sample * 200));
        assert!(!flow.flows() && starved == 1);
        let (flow, starved) = after((0..200).map(|sample| sample * 20));
        assert!(!flow.flows() && starved == 1);
        let (flow, starved) = after((0..5_000).filter(|ms| ms % 10 != 3));
        assert!(flow.flows() && starved == 0);
    }
}

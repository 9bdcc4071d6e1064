//! What the autopilot tells: events for the log, a state for the link.
//!
//! Events wait in a bounded queue for the lowest-priority task; a full queue drops the newest
//! and counts it, so that logging never holds control up. Runs are counted, and told one by one
//! for who asks for details; each carries its number, so a reader of the log sees gaps.

use super::demand::Silence;
use super::door::{ChipOrder, ChipSetting, Fault, OrderError};
use super::storage::StoreEvent;
use crate::math::Quaternion;
use crate::reactive::{FallbackReason, Fit, Phase, Reason};
use crate::reset::Mode;
use crate::safety::{Checks, FlightEvent, FlightState};
use crate::sensors::{Input, Inputs};
use crate::time::{Duration, Instant, micros, span};
use heapless::Deque;

/// Between two lines that count runs.
const SECOND: Duration = micros(1_000_000);

/// Something that happened, for the log.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Event {
    /// Control ran: a line each, only in a log that tells details.
    Ran {
        /// Counts runs since start.
        number: u32,
        /// Why.
        reason: Reason,
        /// Inputs that asked for it.
        asked: Inputs,
        /// The command moved by a quantum or more; `None` where time must show what it repays.
        changed: Option<bool>,
    },
    /// How often control ran since the last such line, a second ago or more.
    Runs(RunCounts),
    /// The way of running control changed.
    Phase(Phase),
    /// A model was fitted.
    Refit {
        /// Whose model.
        input: Input,
        /// What the labels say.
        fit: Fit,
        /// Change above which the input triggers, in its SI unit.
        threshold: f32,
        /// Weight of the labels behind it.
        labels: f32,
    },
    /// First crossings taught these inputs too little: they learn from pairs at several lags.
    Lags(Inputs),
    /// The chip of an input obeyed an order that changes its interrupts.
    Programmed(Input, ChipSetting),
    /// A chip did not obey an order.
    OrderFailed(ChipOrder, OrderError),
    /// The state of the flight changed, and why.
    Flight(FlightState, FlightEvent),
    /// A motor, from 0, gives no lift.
    MotorLost(u8),
    /// Motors were not armed: what failed.
    NotArmed(Checks),
    /// Motors were not disarmed: the drone is in the air.
    NotDisarmed,
    /// A fault was reported, or noticed; with how often so far.
    Fault(Fault, u32),
    /// Something that the drone is flown by stopped.
    Silent(Silence),
    /// The field (gauss, body axes, with the board's iron) of a drone that is turned by hand.
    Field([f32; 3]),
    /// What was stored, or is.
    Store(StoreEvent),
    /// The source of places moved its frame: places and goals are moved back into the drone's.
    PlaceReset,
}

/// How often control ran, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunCounts([u16; Reason::COUNT]);

#[cfg(target_os = "none")]
impl defmt::Format for RunCounts {
    fn format(&self, to: defmt::Formatter<'_>) {
        for (reason, count) in Reason::ALL.iter().zip(self.0) {
            if count > 0 {
                defmt::write!(to, "{} {=u16} ", reason, count);
            }
        }
    }
}

/// Counts runs, and tells their counts once a second.
#[derive(Debug)]
pub(super) struct RunCounter {
    since: Instant,
    counts: RunCounts,
}

impl RunCounter {
    pub(super) const fn new(since: Instant) -> Self {
        let counts = RunCounts([0; Reason::COUNT]);
        Self { since, counts }
    }

    /// Counts a run; the counts of the runs before it where a second has passed.
    pub(super) fn count(&mut self, at: Instant, reason: Reason) -> Option<RunCounts> {
        let due = span(self.since, at) >= SECOND;
        let told = due.then(|| {
            self.since = at;
            core::mem::take(&mut self.counts)
        });
        if let Some(count) = self.counts.0.get_mut(reason as usize) {
            *count = count.saturating_add(1);
        }
        told
    }
}

/// Room for events between two passes of idle.
const QUEUE: usize = 24;

/// Events that wait for the log.
#[derive(Debug, Default)]
pub struct Events {
    queue: Deque<Event, QUEUE>,
    dropped: u32,
}

impl Events {
    /// Queues an event, or counts it as dropped.
    pub fn push(&mut self, event: Event) {
        if self.queue.push_back(event).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// The oldest event.
    pub fn pop(&mut self) -> Option<Event> {
        self.queue.pop_front()
    }

    /// How many events found no room.
    #[must_use]
    pub fn dropped(&self) -> u32 {
        self.dropped
    }
}

/// The state in brief, for the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// Whether motors may turn, and who says what is flown.
    pub state: FlightState,
    /// How control runs.
    pub phase: Phase,
    /// Estimated attitude.
    pub attitude: Quaternion,
    /// Runs since start.
    pub runs: u32,
    /// Events that found no room in the queue.
    pub dropped_events: u32,
}

impl Telemetry {
    /// How the drone flies, in a word.
    #[must_use]
    pub fn mode(&self) -> Mode {
        match self.phase {
            Phase::Ground => Mode::Ground,
            Phase::WarmUp => Mode::WarmUp,
            Phase::Reactive => Mode::Reactive,
            Phase::Fallback(FallbackReason::ImuLost) => Mode::Blind,
            Phase::Fallback(_) => Mode::Fallback,
            Phase::Periodic => Mode::Periodic,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    #[test]
    fn runs_are_told_once_a_second_by_reason() {
        let mut counter = RunCounter::new(at_micros(0));
        let mut runs = (0..2_000).map(|ms| {
            let reason = [Reason::Trigger, Reason::Failsafe][usize::from(ms % 4 == 0)];
            counter.count(at_micros(1_000 * ms), reason)
        });
        let first = runs.by_ref().take(1_001).enumerate();
        let told: Vec<_> = first.filter_map(|(ms, told)| Some((ms, told?))).collect();
        let mut expected = RunCounts::default();
        expected.0[Reason::Trigger as usize] = 750;
        expected.0[Reason::Failsafe as usize] = 250;
        assert_eq!(told, [(1_000, expected)]);
        assert_eq!(runs.flatten().count(), 0);
    }
}

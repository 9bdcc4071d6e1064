//! What the autopilot tells: events for the log, a state for the link.
//!
//! Events wait in a bounded queue for the lowest-priority task; a full queue drops the newest
//! and counts it, so that logging never holds control up. Every run carries its number, so a
//! reader of the log sees gaps.

use super::door::{ChipOrder, ChipSetting, Fault, OrderError};
use crate::math::Quaternion;
use crate::reactive::{Fit, Phase, Reason};
use crate::safety::{Arming, Refusal};
use crate::sensors::{Input, Inputs};
use heapless::Deque;

/// Something that happened, for the log.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Event {
    /// Control ran.
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
    /// The arming state changed.
    Arming(Arming),
    /// An arm command was refused.
    Refused(Refusal),
    /// A fault was reported, or noticed; with how often so far.
    Fault(Fault, u32),
    /// The peer's setpoints stopped: level, heading free.
    SetpointLost,
    /// The peer's goals stopped: the last one's place is held.
    GoalHeld,
    /// Positions stopped while a goal was flown: level, heading free.
    PlaceLost,
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
    /// Whether motors may turn.
    pub arming: Arming,
    /// How control runs.
    pub phase: Phase,
    /// Estimated attitude.
    pub attitude: Quaternion,
    /// Runs since start.
    pub runs: u32,
    /// Events that found no room in the queue.
    pub dropped_events: u32,
}

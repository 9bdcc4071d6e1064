//! The record of what happened: calls, faults, events for the log.

use super::call::{Call, Ran, Recorder};
use super::door::Fault;
use super::telemetry::{Event, Events, RunCounter};
use crate::link::Notice;
use crate::reactive::{Label, Reason};
use crate::sensors::Input;
use crate::time::{Duration, Instant, micros, span};
use heapless::Deque;

/// Room for notices between two beats of the link.
const NOTICES: usize = 8;

/// How long a failure speaks against arming.
const SECOND: Duration = micros(1_000_000);

/// What happened so far, and when the newest of it did.
#[derive(Debug)]
pub(super) struct Record<R> {
    recorder: R,
    /// The newest instant that any call carried.
    clock: Instant,
    faults: [u32; Fault::COUNT],
    runs: RunCounter,
    events: Events,
    notices: Deque<Notice, NOTICES>,
    /// When a sensor's bus or configuration last failed.
    sensor_failed_at: Option<Instant>,
    /// When a run was last late.
    ran_late_at: Option<Instant>,
}

impl<R: Recorder> Record<R> {
    pub(super) fn new(recorder: R) -> Self {
        let start = Instant::from_ticks(0);
        Self {
            recorder,
            clock: start,
            faults: [0; Fault::COUNT],
            runs: RunCounter::new(start),
            events: Events::default(),
            notices: Deque::new(),
            sensor_failed_at: None,
            ran_late_at: None,
        }
    }

    /// Takes note of a call and its instant.
    #[inline(never)]
    pub(super) fn call(&mut self, at: Instant, call: Call) {
        self.frequent(at, call);
    }

    /// As [`Self::call`], for one that comes with every sample: encoding what is known where it is made
    /// takes few instructions, and room.
    #[inline(always)]
    pub(super) fn frequent(&mut self, at: Instant, call: Call) {
        self.clock = self.clock.max(at);
        self.recorder.record(at, &call);
    }

    /// Takes note of what became of the last run, where that is seen now.
    pub(super) fn judged(&mut self, at: Instant, changed: Option<bool>) {
        if let Some(changed) = changed {
            self.call(at, Call::Judged(changed));
        }
    }

    /// Takes note of a run, which `changed` the command or not, where that is known at once.
    pub(super) fn ran(&mut self, at: Instant, ran: Ran, changed: Option<bool>, number: u32) {
        self.recorder.record(at, &Call::Ran(ran));
        if let Some(counts) = self.runs.count(at, ran.reason) {
            self.events.push(Event::Runs(counts));
        }
        // On the ground a line every millisecond would tell nothing.
        if ran.reason != Reason::Ground {
            self.events.push(Event::Ran {
                number,
                reason: ran.reason,
                asked: ran.asked,
                changed,
            });
        }
    }

    /// Takes note of labels, one by one.
    pub(super) fn labels(&mut self) -> impl FnMut(Input, &Label) {
        |input, label| self.recorder.label(input, label)
    }

    /// Counts a fault. Not inlined: it is rare, and in many places.
    #[cold]
    #[inline(never)]
    pub(super) fn fault(&mut self, fault: Fault) {
        match fault {
            Fault::LateRun => self.ran_late_at = Some(self.clock),
            Fault::ImuBus
            | Fault::ImuOverrun
            | Fault::ImuStale
            | Fault::ImuConfiguration
            | Fault::ChipBus => self.sensor_failed_at = Some(self.clock),
            _ => {}
        }
        if let Some(count) = self.faults.get_mut(usize::from(fault.number())) {
            *count = count.saturating_add(1);
            let count = *count;
            // The first few of a kind, then at powers of two: a storm must not drown the log.
            if count.is_power_of_two() {
                self.events.push(Event::Fault(fault, count));
            }
        }
    }

    /// False where a sensor's bus or configuration failed within the last second.
    pub(super) fn are_sensors_sound(&self, now: Instant) -> bool {
        is_long_ago(self.sensor_failed_at, now)
    }

    /// False where a run was late within the last second.
    pub(super) fn are_runs_in_time(&self, now: Instant) -> bool {
        is_long_ago(self.ran_late_at, now)
    }

    /// Queues an event for the log.
    pub(super) fn event(&mut self, event: Event) {
        self.events.push(event);
    }

    /// Queues a notice for the pilot; where there is no room, the log still tells it.
    pub(super) fn notice(&mut self, notice: Notice) {
        let _ = self.notices.push_back(notice);
    }

    /// The oldest notice that waits for the pilot.
    pub(super) fn notice_due(&self) -> Option<Notice> {
        self.notices.front().copied()
    }

    /// The pilot was told the oldest notice.
    pub(super) fn on_told(&mut self) {
        self.notices.pop_front();
    }

    /// The newest instant that any call carried.
    pub(super) fn clock(&self) -> Instant {
        self.clock
    }

    /// How often a fault was counted.
    pub(super) fn faults(&self, fault: Fault) -> u32 {
        self.faults
            .get(usize::from(fault.number()))
            .copied()
            .unwrap_or(0)
    }

    /// The events that wait for the log.
    pub(super) fn events(&mut self) -> &mut Events {
        &mut self.events
    }

    /// How many events found no room.
    pub(super) fn dropped_events(&self) -> u32 {
        self.events.dropped()
    }

    /// The recorder itself.
    pub(super) fn recorder(&mut self) -> &mut R {
        &mut self.recorder
    }
}

fn is_long_ago(at: Option<Instant>, now: Instant) -> bool {
    at.is_none_or(|at| span(at, now) > SECOND)
}

//! What the native board does next, in order of virtual time.
//!
//! One place per kind of event: like a pending bit, an event that is raised twice happens once.
//! At the same instant the kinds take their turns in the order of their declaration, which is
//! roughly that of the firmware's priorities; so the same flight is played the same way.

/// What can be due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// The MPU6050's interrupt pin may change.
    ImuInterrupt,
    /// An edge of that pin is missed.
    ImuMissed,
    /// The interrupt pin of a die with a clock of its own may change.
    DieInterrupt,
    /// A burst of the MPU6050 has been received.
    Burst,
    /// The MPU6050 was configured anew.
    Repaired,
    /// The hyperperiod ended.
    Hyperperiod,
    /// A hyperperiod in which a gating sample is missing ends.
    LateHyperperiod,
    /// The failsafe timer.
    Timer,
    /// The owner of those dies goes on.
    Chips,
    /// A frame of the link has been received.
    Frame,
    /// A second has passed.
    Beat,
    /// The battery is measured.
    Gauge,
    /// A model was refitted.
    Refit,
}

impl Event {
    const ALL: [Self; 13] = [
        Self::ImuInterrupt,
        Self::ImuMissed,
        Self::DieInterrupt,
        Self::Burst,
        Self::Repaired,
        Self::Hyperperiod,
        Self::LateHyperperiod,
        Self::Timer,
        Self::Chips,
        Self::Frame,
        Self::Beat,
        Self::Gauge,
        Self::Refit,
    ];
}

/// When each event is due, in ns; `u64::MAX` for never.
#[derive(Clone, Debug)]
pub(super) struct Agenda {
    due_ns: [u64; Event::ALL.len()],
}

impl Agenda {
    pub(super) fn new() -> Self {
        Self {
            due_ns: [u64::MAX; Event::ALL.len()],
        }
    }

    /// The event happens at this instant, whatever was noted before.
    pub(super) fn set(&mut self, event: Event, at_ns: u64) {
        self.due_ns[event as usize] = at_ns;
    }

    /// The event happens at this instant, unless it is noted already.
    pub(super) fn pend(&mut self, event: Event, at_ns: u64) {
        if !self.is_noted(event) {
            self.set(event, at_ns);
        }
    }

    pub(super) fn is_noted(&self, event: Event) -> bool {
        self.due_ns[event as usize] != u64::MAX
    }

    /// When the event is due, ns; `u64::MAX` for never.
    pub(super) fn due_ns(&self, event: Event) -> u64 {
        self.due_ns[event as usize]
    }

    /// Takes the next event due until `until_ns`, with its instant.
    pub(super) fn take(&mut self, until_ns: u64) -> Option<(u64, Event)> {
        let mut place = 0;
        let mut at_ns = self.due_ns[0];
        for (later, due_ns) in self.due_ns.iter().enumerate().skip(1) {
            if *due_ns < at_ns {
                (place, at_ns) = (later, *due_ns);
            }
        }
        if at_ns > until_ns {
            return None;
        }
        self.due_ns[place] = u64::MAX;
        Some((at_ns, Event::ALL[place]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_come_in_order_of_time_and_then_of_rank() {
        let mut agenda = Agenda::new();
        agenda.set(Event::Timer, 20);
        agenda.set(Event::Burst, 20);
        agenda.set(Event::Refit, 10);
        agenda.pend(Event::Refit, 5);
        assert_eq!(agenda.take(30), Some((10, Event::Refit)));
        assert_eq!(agenda.take(30), Some((20, Event::Burst)));
        assert_eq!(agenda.take(19), None);
        assert_eq!(agenda.take(20), Some((20, Event::Timer)));
        assert_eq!(agenda.take(u64::MAX - 1), None);
    }

    #[test]
    fn every_event_has_the_place_of_its_number() {
        for (place, event) in Event::ALL.into_iter().enumerate() {
            assert_eq!(event as usize, place);
        }
    }
}

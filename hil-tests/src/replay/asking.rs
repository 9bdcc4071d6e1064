//! Who asked for runs: first, alone, rightly; and what that took of a bus.
//!
//! A chip asks when its sample is fetched, all other inputs with the sample that ends a hyperperiod.

use reflex::app::{Call, Reason, Stamped};
use reflex::sensors::{Cause, Input, Inputs};

use super::timeline::Verdicts;

/// Counts of one input over the calls behind an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Asking {
    /// Runs that it asked for, alone or with others.
    pub(super) runs: u64,
    /// Those that it asked for first, or with the first.
    pub(super) first: u64,
    /// Those that it alone asked for.
    pub(super) alone: u64,
    /// Those of `alone` that were changed.
    pub(super) rightly: u64,
    /// Orders that were carried out for it.
    pub(super) orders: u64,
}

impl Asking {
    pub(super) fn of(input: Input, calls: &[Stamped], verdicts: &Verdicts, from_us: u64) -> Self {
        let mut counts = Self::default();
        // The chip whose sample came first since the last run, of those that may have asked.
        let mut sampled = Vec::new();
        for (place, stamped) in calls.iter().enumerate() {
            let scored = stamped.at.ticks() > from_us;
            match &stamped.call {
                Call::Chip(sample) if sample.cause != Cause::Rearm => sampled.push(sample.input),
                Call::OrderDone(order, Ok(_)) if scored && order.input == input => {
                    counts.orders += 1;
                }
                Call::Ran(ran) => {
                    let first = sampled.iter().find(|chip| ran.asked.contains(**chip));
                    let first = first.map_or(ran.asked, |chip| Inputs::NONE.with(*chip));
                    sampled.clear();
                    if !(scored && ran.reason == Reason::Trigger && ran.asked.contains(input)) {
                        continue;
                    }
                    let alone = ran.asked.sole() == Some(input);
                    counts.runs += 1;
                    counts.first += u64::from(first.contains(input));
                    counts.alone += u64::from(alone);
                    counts.rightly += u64::from(alone && verdicts.changed(place) == Some(true));
                }
                _ => {}
            }
        }
        counts
    }
}

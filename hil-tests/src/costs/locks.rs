//! How long idle holds a lock: the time that BASEPRI keeps handlers away.

use anyhow::Result;

use super::activations::Instant;
use emulated_board::Elf;

/// First half-words of `msr BASEPRI, rN`, less the register, and the second ones.
const MSR: u16 = 0xF380;
const RAISE: u16 = 0x8812;
const LOWER: u16 = 0x8811;

/// Places in idle at which locks are taken and given back.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct LockPlaces {
    pub(super) raise: Vec<u32>,
    pub(super) lower: Vec<u32>,
}

impl LockPlaces {
    /// Those of the function at an address.
    pub(super) fn of(elf: &Elf, function: u32) -> Result<Self> {
        Ok(Self::among(&elf.half_words(function)?))
    }

    fn among(halves: &[(u32, u16)]) -> Self {
        let writes = |second: u16| {
            let pairs = halves.windows(2);
            let pairs = pairs.filter(|pair| pair[0].1 & 0xFFF0 == MSR && pair[1].1 == second);
            pairs.map(|pair| pair[0].0).collect()
        };
        Self {
            raise: writes(RAISE),
            lower: writes(LOWER),
        }
    }
}

/// The locks of idle: those under which models were swapped, and the others.
#[derive(Debug, Default)]
pub(super) struct Locks {
    held: Option<Held>,
    pub(super) swaps: Vec<u64>,
    pub(super) others: Vec<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Held {
    since: u64,
    handled: u64,
    swaps: bool,
}

impl Locks {
    /// Handlers took `handled` instructions so far.
    pub(super) fn raise(&mut self, at: Instant, handled: u64) {
        self.held = Some(Held {
            since: at.instructions,
            handled,
            swaps: false,
        });
    }

    /// A model is swapped in.
    pub(super) fn swap(&mut self) {
        if let Some(held) = &mut self.held {
            held.swaps = true;
        }
    }

    /// Counts what idle executed since the lock was taken.
    pub(super) fn lower(&mut self, at: Instant, handled: u64) {
        let Some(held) = self.held.take() else {
            return;
        };
        let own = at.instructions - held.since - (handled - held.handled);
        if held.swaps {
            self.swaps.push(own);
        } else {
            self.others.push(own);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(instructions: u64) -> Instant {
        Instant {
            ns: 0,
            instructions,
        }
    }

    #[test]
    fn a_lock_is_held_without_what_preempts_it() {
        let mut locks = Locks::default();
        locks.raise(at(100), 50);
        locks.swap();
        locks.lower(at(400), 150);
        locks.raise(at(500), 150);
        locks.lower(at(510), 150);
        locks.lower(at(600), 150);
        assert_eq!((locks.swaps, locks.others), (vec![200], vec![10]));
    }

    #[test]
    fn locks_are_found_by_the_instructions_that_take_them() {
        let halves = [0x2080, 0xF380, 0x8812, 0xF3BF, 0x8F6F, 0xF385, 0x8811];
        let halves: Vec<_> = (0x100..).step_by(2).zip(halves).collect();
        let places = LockPlaces {
            raise: vec![0x102],
            lower: vec![0x10A],
        };
        assert_eq!(LockPlaces::among(&halves), places);
    }
}

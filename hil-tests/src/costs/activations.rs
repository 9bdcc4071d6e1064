//! Handlers as they interrupt one another: who executed which instructions.

use anyhow::Result;

use emulated_board::Elf;

/// A handler that has been entered and has not returned.
#[derive(Clone, Copy, Debug)]
struct Open {
    handler: usize,
    entered: Instant,
    /// Instructions of handlers that interrupted it.
    others: u64,
}

/// A point of a run: in time, and in instructions executed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Instant {
    pub(super) ns: u64,
    pub(super) instructions: u64,
}

/// One call of a handler, from its entry to its return.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Activation {
    /// Its number among the handlers.
    pub(super) handler: usize,
    pub(super) entered: Instant,
    pub(super) left_ns: u64,
    /// Its own instructions, without those of handlers that interrupted it.
    pub(super) own: u64,
}

/// The handlers that are open, the newest last.
#[derive(Debug, Default)]
pub(super) struct Activations {
    open: Vec<Open>,
    /// Instructions of all handlers that returned to idle.
    handled: u64,
}

impl Activations {
    /// Instructions that handlers took from idle so far.
    pub(super) fn handled(&self) -> u64 {
        self.handled
    }

    /// How many handlers are open.
    pub(super) fn depth(&self) -> usize {
        self.open.len()
    }

    /// True where no handler is open.
    pub(super) fn is_idle(&self) -> bool {
        self.open.is_empty()
    }

    /// The core arrived at the first instruction of a handler.
    pub(super) fn enter(&mut self, handler: usize, at: Instant) {
        self.open.push(Open {
            handler,
            entered: at,
            others: 0,
        });
    }

    /// The core arrived at a return of a handler; `None` where that is not the newest.
    pub(super) fn leave(&mut self, handler: usize, at: Instant) -> Option<Activation> {
        let Open {
            entered, others, ..
        } = self.open.pop_if(|open| open.handler == handler)?;
        // The return itself is still to come.
        let all = at.instructions + 1 - entered.instructions;
        match self.open.last_mut() {
            Some(interrupted) => interrupted.others += all,
            None => self.handled += all,
        }
        Some(Activation {
            handler,
            entered,
            left_ns: at.ns,
            own: all - others,
        })
    }
}

/// Addresses at which a function may return.
///
/// A half-word that only looks like a return is the second of an instruction, or data: the core
/// never arrives there.
pub(super) fn returns(elf: &Elf, function: u32) -> Result<Vec<u32>> {
    let halves = elf.half_words(function)?;
    let mut next = halves.iter().skip(1).map(|half| half.1);
    let returns = halves.iter().filter_map(|&(address, half)| {
        let second = next.next().unwrap_or(0);
        let pops_pc = half >> 8 == 0xBD;
        let branches_to_lr = half == 0x4770;
        let loads_pc = half == 0xE8BD && second & 0x8000 != 0 || [half, second] == [0xF85D, 0xFB04];
        (pops_pc || branches_to_lr || loads_pc).then_some(address)
    });
    Ok(returns.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(instructions: u64) -> Instant {
        Instant {
            ns: 6 * instructions,
            instructions,
        }
    }

    #[test]
    fn a_handler_is_not_charged_for_the_one_that_interrupts_it() {
        let mut activations = Activations::default();
        activations.enter(0, at(100));
        activations.enter(1, at(110));
        assert_eq!(activations.leave(0, at(115)), None, "not the newest");
        assert_eq!(activations.leave(1, at(119)).map(|a| a.own), Some(10));
        assert!(!activations.is_idle());
        assert_eq!(activations.leave(0, at(129)).map(|a| a.own), Some(20));
        assert!(activations.is_idle());
        assert_eq!(activations.handled(), 30);
    }
}

//! What the core executed: instructions by address, and by how the core came there.

use std::collections::BTreeMap;

/// The way of calls and exceptions that led the core to a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Came {
    /// By an exception of this number; 0 is none, the thread that the others interrupt.
    Exception(u16),
    /// By a call.
    Call {
        /// The way that led to the caller: its place in [`Tally::ways`].
        caller: usize,
        /// Address of the call.
        at: u32,
    },
}

/// Every instruction that the core executed from an instant on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// When counting began, in ns.
    pub from_ns: u64,
    /// When it ended, in ns.
    pub to_ns: u64,
    /// Instructions in between by the board's own count.
    pub executed: u64,
    /// Every way that led the core to some function.
    pub ways: Vec<Came>,
    /// Instructions by way and address.
    pub counts: BTreeMap<(usize, u32), u64>,
    /// How often each exception was entered.
    pub entries: BTreeMap<u16, u64>,
}

impl Tally {
    /// Instructions in all.
    #[must_use]
    pub fn instructions(&self) -> u64 {
        self.counts.values().sum()
    }
}

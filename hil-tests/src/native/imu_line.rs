//! The MPU6050's interrupt line, and the timer behind edges that are missed.
//!
//! As the board's: `src/board/reflex_f427/imu_line.rs`.

use reflex::tasks::imu::{FIRST_MISSED_US, SAMPLE_US};

use crate::faults::Fault;

/// The line with its timer.
#[derive(Debug)]
pub(super) struct ImuLine {
    counted_from_ns: u64,
    /// Edges stay away.
    dead: bool,
    /// While one of them holds the line is stuck.
    pub(super) stuck: Vec<Fault>,
}

impl ImuLine {
    /// Counts from an instant on.
    pub(super) fn new(from_ns: u64) -> Self {
        Self {
            counted_from_ns: from_ns,
            dead: false,
            stuck: Vec::new(),
        }
    }

    /// An edge of the chip; false where the line does not carry it.
    pub(super) fn hears(&mut self, at_ns: u64) -> bool {
        if self.stuck.iter().any(|fault| fault.holds(at_ns)) {
            return false;
        }
        self.counted_from_ns = at_ns;
        self.dead = false;
        true
    }

    /// When the next edge counts as missed, ns.
    pub(super) fn due_ns(&self) -> u64 {
        let due_us = if self.dead {
            SAMPLE_US
        } else {
            FIRST_MISSED_US
        };
        self.counted_from_ns + u64::from(due_us) * 1_000
    }

    /// An edge was missed; true for the first of a row.
    pub(super) fn misses(&mut self, at_ns: u64) -> bool {
        self.counted_from_ns = at_ns;
        !std::mem::replace(&mut self.dead, true)
    }
}

//! The bus itself: its two wires, and the chip that may hold one of them.
//!
//! While the peripheral is the master, bytes cross whole. A transfer that it drops in the middle of a
//! byte leaves the chip there: it holds SDA where its bit is a zero, and shifts with every clock that
//! the pins give it by hand, until it sees a STOP. A START by hand is not played.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use chip_models::I2cChip;

use crate::bus_fault::{Disturbance, Script};

/// Bits of a byte, without the acknowledge bit.
const BITS: u8 = 8;

/// Where the chip is that was left in the middle of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Left {
    /// Not addressed: it waits for a START.
    Free,
    /// It sends: this bit of this byte is on SDA.
    Sending { byte: u8, bit: u8 },
    /// It sent a byte and reads the acknowledge bit.
    Sent,
    /// Its byte was acknowledged: the next one follows as the clock falls.
    Acknowledged,
    /// It has taken so many bits.
    Receiving { bits: u8 },
    /// It acknowledges, until the clock falls.
    Acknowledging,
    /// It waits for a START or STOP.
    Done,
}

/// The levels that somebody gives the two wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::emulated) struct Levels {
    pub(in crate::emulated) scl: bool,
    pub(in crate::emulated) sda: bool,
}

/// Both wires are let go.
pub(in crate::emulated) const RELEASED: Levels = Levels {
    scl: true,
    sda: true,
};

/// The two wires with the chip on them, shared by the peripheral and the pins.
#[derive(Clone)]
pub(in crate::emulated) struct SharedWires(Arc<Mutex<Wires>>);

impl fmt::Debug for SharedWires {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SharedWires")
    }
}

impl SharedWires {
    pub(in crate::emulated) fn new(chip: Arc<Mutex<dyn I2cChip>>, script: Arc<Script>) -> Self {
        Self(Arc::new(Mutex::new(Wires {
            chip,
            script,
            left: Left::Free,
            clocks_missing: 0,
            by_hand: RELEASED,
        })))
    }

    /// A model that panicked is reported by that panic, not by its lock.
    pub(in crate::emulated) fn lock(&self) -> MutexGuard<'_, Wires> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

pub(in crate::emulated) struct Wires {
    chip: Arc<Mutex<dyn I2cChip>>,
    pub(super) script: Arc<Script>,
    left: Left,
    /// Clocks that a chip still needs which lost count.
    clocks_missing: u8,
    /// What the pins drive while they belong to the port.
    by_hand: Levels,
}

impl Wires {
    fn chip(&self) -> MutexGuard<'_, dyn I2cChip + 'static> {
        self.chip.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The levels where the peripheral lets go of both.
    pub(in crate::emulated) fn levels(&self, now_ns: u64) -> Levels {
        Levels {
            scl: self.by_hand.scl && !self.script.has(Disturbance::ClockHeld, now_ns),
            sda: self.by_hand.sda && !self.is_data_held(now_ns),
        }
    }

    /// Whether a chip or a short holds SDA.
    pub(super) fn is_data_held(&self, now_ns: u64) -> bool {
        let sends_zero = match self.left {
            Left::Sending { byte, bit } => byte << bit & 0x80 == 0,
            left => left == Left::Acknowledging,
        };
        sends_zero || self.clocks_missing > 0 || self.script.has(Disturbance::DataHeld, now_ns)
    }

    /// What the script begins at this instant.
    pub(super) fn begin(&mut self, now_ns: u64) {
        self.clocks_missing = self
            .script
            .lost_count(now_ns)
            .unwrap_or(self.clocks_missing);
    }

    pub(super) fn start(&mut self, now_ns: u64, address: u8, read: bool) -> bool {
        self.count_byte();
        self.left = Left::Free;
        self.acknowledges(now_ns) && self.chip().start(now_ns, address, read)
    }

    pub(super) fn write(&mut self, now_ns: u64, byte: u8) -> bool {
        self.count_byte();
        self.acknowledges(now_ns) && self.chip().write(now_ns, byte)
    }

    pub(super) fn read(&mut self, now_ns: u64, last: bool) -> u8 {
        let held = self.clocks_missing > 0;
        self.count_byte();
        let byte = self.chip().read(now_ns, last);
        if held { 0 } else { byte }
    }

    pub(super) fn stop(&mut self, now_ns: u64) {
        self.left = Left::Free;
        self.chip().stop(now_ns);
    }

    /// The master let go after so many bits that it took from the chip.
    pub(super) fn cut_reading(&mut self, now_ns: u64, bits: u8) {
        let byte = self.chip().read(now_ns, false);
        self.left = match bits {
            0..BITS => Left::Sending { byte, bit: bits },
            _ => Left::Sent,
        };
    }

    /// The master let go after so many bits that it gave to the chip.
    pub(super) fn cut_writing(&mut self, bits: u8) {
        self.left = match bits {
            0..BITS => Left::Receiving { bits },
            _ => Left::Acknowledging,
        };
    }

    fn acknowledges(&self, now_ns: u64) -> bool {
        !self.script.has(Disturbance::NoAcknowledge, now_ns)
    }

    /// Nine clocks of the peripheral have passed.
    fn count_byte(&mut self) {
        self.clocks_missing = self.clocks_missing.saturating_sub(BITS + 1);
    }

    /// The pins drive the wires by hand; what the chip makes of it.
    pub(in crate::emulated) fn drive(&mut self, now_ns: u64, by_hand: Levels) {
        if by_hand == self.by_hand {
            return;
        }
        let before = self.levels(now_ns);
        self.by_hand = by_hand;
        let after = self.levels(now_ns);
        match (before.scl, after.scl) {
            (false, true) => self.clock_rises(after.sda),
            (true, false) => self.clock_falls(now_ns),
            (true, true) if !before.sda && after.sda => self.stop(now_ns),
            _ => {}
        }
    }

    fn clock_rises(&mut self, sda: bool) {
        self.left = match self.left {
            Left::Sent if sda => Left::Done,
            Left::Sent => Left::Acknowledged,
            Left::Receiving { bits } => Left::Receiving { bits: bits + 1 },
            left => left,
        };
    }

    fn clock_falls(&mut self, now_ns: u64) {
        self.clocks_missing = self.clocks_missing.saturating_sub(1);
        self.left = match self.left {
            Left::Acknowledged => Left::Sending {
                byte: self.chip().read(now_ns, false),
                bit: 0,
            },
            Left::Sending { bit, .. } if bit + 1 == BITS => Left::Sent,
            Left::Sending { byte, bit } => Left::Sending { byte, bit: bit + 1 },
            Left::Receiving { bits: BITS } => Left::Acknowledging,
            Left::Acknowledging => Left::Receiving { bits: 0 },
            left => left,
        };
    }
}

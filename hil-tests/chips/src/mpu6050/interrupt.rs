//! INT_STATUS and the INT pin of the MPU6050.
//!
//! Without a latch the pin pulses for 50 us per event; with it the pin holds
//! until the status is cleared (RM-MPU-6000A, registers 55 to 58). A status bit
//! is set only when its interrupt is enabled.

use super::registers::{INT_ENABLE, INT_PIN_CFG, Registers};

/// Length of an unlatched pulse, RM-MPU-6000A register 55.
const PULSE_NS: u64 = 50_000;
const ACTIVE_LOW: u8 = 0x80;
const LATCH: u8 = 0x20;
const CLEAR_ON_ANY_READ: u8 = 0x10;

/// Status bits and pin.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interrupt {
    status: u8,
    latched: bool,
    pulse_ends_ns: Option<u64>,
    events: u64,
}

impl Interrupt {
    /// Raises `bit` at `at_ns` if it is enabled.
    pub fn raise(&mut self, at_ns: u64, bit: u8, registers: &Registers) {
        if !registers.has(INT_ENABLE, bit) {
            return;
        }
        self.status |= bit;
        self.events += 1;
        if registers.has(INT_PIN_CFG, LATCH) {
            self.latched = true;
        } else {
            self.pulse_ends_ns = Some(at_ns + PULSE_NS);
        }
    }

    /// Ends a pulse that is over at `now_ns`.
    pub fn advance(&mut self, now_ns: u64) {
        if self.pulse_ends_ns.is_some_and(|end| end <= now_ns) {
            self.pulse_ends_ns = None;
        }
    }

    /// When a running pulse ends, in ns.
    pub fn next_event(&self) -> u64 {
        self.pulse_ends_ns.unwrap_or(u64::MAX)
    }

    /// Level of the pin: INT_LEVEL set means active low.
    ///
    /// An open-drain output (INT_OPEN) is assumed to have its pull-up.
    pub fn level(&self, registers: &Registers) -> bool {
        let active = self.latched || self.pulse_ends_ns.is_some();
        active != registers.has(INT_PIN_CFG, ACTIVE_LOW)
    }

    /// INT_STATUS without clearing it.
    pub fn status(&self) -> u8 {
        self.status
    }

    /// Interrupts raised so far.
    pub fn events(&self) -> u64 {
        self.events
    }

    /// Clears what a read clears: INT_STATUS itself, or any with INT_RD_CLEAR.
    pub fn after_read(&mut self, of_status: bool, registers: &Registers) {
        if of_status || registers.has(INT_PIN_CFG, CLEAR_ON_ANY_READ) {
            self.status = 0;
            self.latched = false;
        }
    }
}

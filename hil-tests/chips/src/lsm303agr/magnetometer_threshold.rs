//! The magnetometer's threshold comparison and its interrupt.
//!
//! One threshold is compared with every enabled axis, in both directions, with
//! or without the hard-iron offsets taken off. The offsets make it an exact
//! detector of change: written with a sample, the comparison sees the
//! difference from that sample.

use super::magnetometer_registers::{INT_CTRL_REG_M, Registers};

/// INT_CTRL_REG_M: the interrupt is enabled.
const ENABLED: u8 = 0x01;
/// INT_CTRL_REG_M: hold until INT_SOURCE_REG_M is read.
const LATCHED: u8 = 0x02;
/// INT_CTRL_REG_M: INT is high when active, else low when active.
const ACTIVE_HIGH: u8 = 0x04;
/// INT_SOURCE_REG_M: the converter's range was exceeded.
const RANGE_EXCEEDED: u8 = 0x02;

/// State of the comparison.
#[derive(Clone, Copy, Debug, Default)]
pub struct Threshold {
    flags: u8,
    active: bool,
    range_exceeded: bool,
}

impl Threshold {
    /// One sample in counts; whether an interrupt begins.
    pub fn step(&mut self, value: [i32; 3], range_exceeded: bool, registers: &Registers) -> bool {
        self.range_exceeded |= range_exceeded;
        let control = registers.get(INT_CTRL_REG_M);
        let flags = flags(value, i32::from(registers.threshold())) & enabled_axes(control);
        let firing = control & ENABLED != 0 && flags != 0;
        let was_active = self.active;
        if control & LATCHED == 0 {
            self.flags = flags;
            self.active = firing;
        } else if firing && !was_active {
            self.flags = flags;
            self.active = true;
        }
        self.active && !was_active
    }

    /// INT_SOURCE_REG_M without the effects of reading it.
    pub fn source(&self, registers: &Registers) -> u8 {
        let range = if self.range_exceeded {
            RANGE_EXCEEDED
        } else {
            0
        };
        self.flags | range | u8::from(self.level(registers))
    }

    /// What reading INT_SOURCE_REG_M releases.
    pub fn after_read(&mut self, registers: &Registers) {
        self.range_exceeded = false;
        if registers.has(INT_CTRL_REG_M, LATCHED) {
            self.flags = 0;
            self.active = false;
        }
    }

    /// The INT bit, and the pin when it is routed there.
    pub fn level(&self, registers: &Registers) -> bool {
        let active = self.active && registers.has(INT_CTRL_REG_M, ENABLED);
        active == registers.has(INT_CTRL_REG_M, ACTIVE_HIGH)
    }
}

/// Bits X+ Y+ Z+ X- Y- Z- from bit 7 down.
fn flags(value: [i32; 3], threshold: i32) -> u8 {
    let mut bits = 0;
    for (axis, value) in value.into_iter().enumerate() {
        if value > threshold {
            bits |= 0x80 >> axis;
        } else if value < -threshold {
            bits |= 0x10 >> axis;
        }
    }
    bits
}

/// The flags of the axes enabled by XIEN, YIEN and ZIEN.
fn enabled_axes(control: u8) -> u8 {
    let axes = control & 0xE0;
    axes | axes >> 3
}

//! Register map of the magnetometer die and what its configuration means.

use crate::register_file::{Map, RegisterFile};

pub const OFFSET_X_REG_L_M: u8 = 0x45;
pub const OFFSET_Z_REG_H_M: u8 = 0x4A;
pub const WHO_AM_I_M: u8 = 0x4F;
pub const CFG_REG_A_M: u8 = 0x60;
pub const CFG_REG_B_M: u8 = 0x61;
pub const CFG_REG_C_M: u8 = 0x62;
pub const INT_CTRL_REG_M: u8 = 0x63;
pub const INT_SOURCE_REG_M: u8 = 0x64;
pub const INT_THS_L_REG_M: u8 = 0x65;
pub const INT_THS_H_REG_M: u8 = 0x66;
pub const STATUS_REG_M: u8 = 0x67;
pub const OUTX_L_REG_M: u8 = 0x68;
pub const OUTZ_H_REG_M: u8 = 0x6D;

/// WHO_AM_I_M.
pub const IDENTITY: u8 = 0x40;
/// Gauss per count of data, offset and threshold registers.
pub const GAUSS_PER_COUNT: f64 = 1.5e-3;
/// CFG_REG_A_M: user registers back to their reset values; clears itself.
pub const SOFT_RESET: u8 = 0x20;

/// CFG_REG_A_M: the mode bits of idle, where a single measurement ends too.
const IDLE: u8 = 0x03;

/// The map of the magnetometer's die.
#[derive(Clone, Debug)]
pub struct MagnetometerMap;

/// The registers that a master sees.
pub type Registers = RegisterFile<MagnetometerMap>;

impl Map for MagnetometerMap {
    const ADDRESSES: u8 = 0x7F;

    /// Idle.
    const AT_RESET: &'static [(u8, u8)] = &[
        (WHO_AM_I_M, IDENTITY),
        (CFG_REG_A_M, IDLE),
        (INT_CTRL_REG_M, 0xE0),
    ];

    fn writable(address: u8) -> u8 {
        match address {
            OFFSET_X_REG_L_M..=OFFSET_Z_REG_H_M => 0xFF,
            // SOFT_RST and REBOOT (a reload of the trimming) clear themselves.
            CFG_REG_A_M => 0x9F,
            CFG_REG_B_M => 0x1F,
            CFG_REG_C_M => 0x7F,
            INT_CTRL_REG_M => 0xE7,
            INT_THS_L_REG_M | INT_THS_H_REG_M => 0xFF,
            _ => 0,
        }
    }
}

impl Registers {
    /// What follows a single measurement: idle.
    pub fn fall_idle(&mut self) {
        self.put(CFG_REG_A_M, self.get(CFG_REG_A_M) | IDLE);
    }

    /// The hard-iron offsets in counts.
    pub fn offsets(&self) -> [i16; 3] {
        [0, 2, 4].map(|index| {
            let low = OFFSET_X_REG_L_M + index;
            i16::from_le_bytes([self.get(low), self.get(low + 1)])
        })
    }

    /// The threshold in counts.
    pub fn threshold(&self) -> u16 {
        u16::from_le_bytes([self.get(INT_THS_L_REG_M), self.get(INT_THS_H_REG_M)])
    }
}

/// What the die is told to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// No measurements.
    Idle,
    /// One measurement, then idle.
    Single,
    /// Measurements at a rate in Hz.
    Continuous(f64),
}

/// The mode in CFG_REG_A_M.
pub fn mode(registers: &Registers) -> Mode {
    let config = registers.get(CFG_REG_A_M);
    match config & 0x03 {
        0 => Mode::Continuous([10.0, 20.0, 50.0, 100.0][usize::from(config >> 2 & 0x03)]),
        1 => Mode::Single,
        _ => Mode::Idle,
    }
}

//! Register map of the accelerometer die and what its configuration means.
//!
//! Addresses, bits, sensitivities and the weights of THS and REFERENCE are
//! those ST publishes in its register driver (lsm303agr-pid); the high-pass
//! corners are the family's table (AN4825, like AN3308 for the LIS3DH).

use crate::register_file::{Map, RegisterFile};

pub const STATUS_REG_AUX_A: u8 = 0x07;
pub const OUT_TEMP_L_A: u8 = 0x0C;
pub const OUT_TEMP_H_A: u8 = 0x0D;
pub const WHO_AM_I_A: u8 = 0x0F;
pub const TEMP_CFG_REG_A: u8 = 0x1F;
pub const CTRL_REG1_A: u8 = 0x20;
pub const CTRL_REG2_A: u8 = 0x21;
pub const CTRL_REG3_A: u8 = 0x22;
pub const CTRL_REG4_A: u8 = 0x23;
pub const CTRL_REG5_A: u8 = 0x24;
pub const CTRL_REG6_A: u8 = 0x25;
pub const REFERENCE_A: u8 = 0x26;
pub const STATUS_REG_A: u8 = 0x27;
pub const OUT_X_L_A: u8 = 0x28;
pub const OUT_Z_H_A: u8 = 0x2D;
pub const FIFO_CTRL_REG_A: u8 = 0x2E;
pub const FIFO_SRC_REG_A: u8 = 0x2F;
pub const INT1_CFG_A: u8 = 0x30;
pub const INT1_SRC_A: u8 = 0x31;
pub const INT1_THS_A: u8 = 0x32;
pub const INT1_DURATION_A: u8 = 0x33;
pub const INT2_CFG_A: u8 = 0x34;
pub const INT2_SRC_A: u8 = 0x35;
pub const INT2_THS_A: u8 = 0x36;
pub const INT2_DURATION_A: u8 = 0x37;

/// WHO_AM_I_A.
pub const IDENTITY: u8 = 0x33;
/// CTRL_REG5_A: reload the trimming; clears itself.
pub const BOOT: u8 = 0x80;

/// Nominal rates of ODR codes 1..=7 in Hz.
const RATES: [f64; 7] = [1.0, 10.0, 25.0, 50.0, 100.0, 200.0, 400.0];
/// mg per digit by mode (high resolution, normal, low power) and full scale.
const SENSITIVITY: [[f64; 4]; 3] = [
    [0.98, 1.95, 3.9, 11.72],
    [3.9, 7.82, 15.63, 46.9],
    [15.63, 31.26, 62.52, 187.58],
];
/// mg per count of INTx_THS_A by full scale.
const THRESHOLD_MG: [f64; 4] = [16.0, 32.0, 62.0, 186.0];
/// mg per count of REFERENCE_A by full scale.
const REFERENCE_MG: [f64; 4] = [16.0, 31.0, 63.0, 127.0];
/// High-pass corners in Hz by HPCF at 1, 10 .. 400, 1344 or 1620, 5376 Hz.
const CORNERS: [[f64; 4]; 9] = [
    [0.02, 0.008, 0.004, 0.002],
    [0.2, 0.08, 0.04, 0.02],
    [0.5, 0.2, 0.1, 0.05],
    [1.0, 0.5, 0.2, 0.1],
    [2.0, 1.0, 0.5, 0.2],
    [4.0, 2.0, 1.0, 0.5],
    [8.0, 4.0, 2.0, 1.0],
    [32.0, 16.0, 8.0, 4.0],
    [100.0, 50.0, 25.0, 12.0],
];

/// The map of the accelerometer's die.
#[derive(Clone, Debug)]
pub struct AccelerometerMap;

/// The registers that a master sees.
pub type Registers = RegisterFile<AccelerometerMap>;

impl Map for AccelerometerMap {
    const ADDRESSES: u8 = 0x3F;

    /// Powered down with all axes enabled. No FIFO is modelled: it is always empty.
    const AT_RESET: &'static [(u8, u8)] = &[
        (WHO_AM_I_A, IDENTITY),
        (CTRL_REG1_A, 0x07),
        (FIFO_SRC_REG_A, 0x20),
    ];

    fn writable(address: u8) -> u8 {
        match address {
            TEMP_CFG_REG_A => 0xC0,
            CTRL_REG1_A | CTRL_REG2_A | CTRL_REG4_A | REFERENCE_A => 0xFF,
            CTRL_REG3_A => 0xFE,
            CTRL_REG5_A => 0x4F,
            CTRL_REG6_A => 0xFA,
            FIFO_CTRL_REG_A | INT1_CFG_A | INT2_CFG_A => 0xFF,
            INT1_THS_A | INT1_DURATION_A | INT2_THS_A | INT2_DURATION_A => 0x7F,
            // Click and activity: stored only.
            0x38 => 0x3F,
            0x3A | 0x3B | 0x3E => 0x7F,
            0x3C | 0x3D | 0x3F => 0xFF,
            _ => 0,
        }
    }
}

/// Power and resolution mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// 12 bits, bandwidth a ninth of the rate.
    HighResolution,
    /// 10 bits, bandwidth half the rate.
    Normal,
    /// 8 bits, bandwidth half the rate.
    LowPower,
}

impl Mode {
    /// Zero bits below the left-justified value.
    pub fn shift(self) -> u32 {
        match self {
            Self::HighResolution => 4,
            Self::Normal => 6,
            Self::LowPower => 8,
        }
    }
}

/// How the high-pass filter is reset (HPM).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HighPassMode {
    /// Reading REFERENCE_A takes the present sample as zero.
    ResetByReading,
    /// The value in REFERENCE_A is subtracted; nothing is forgotten.
    Reference,
    /// Nothing resets it.
    Normal,
    /// An interrupt takes the present sample as zero.
    ResetByInterrupt,
}

/// The configuration that sampling works with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Nominal data rate in Hz; `None` in power-down.
    pub rate_hz: Option<f64>,
    /// Power and resolution mode.
    pub mode: Mode,
    /// Enabled axes; a disabled one reads as zero.
    pub axes: [bool; 3],
    /// g per digit at the mode's resolution.
    pub sensitivity: f64,
    /// g per count of a threshold register.
    pub threshold: f64,
    /// g per count of REFERENCE_A.
    pub reference: f64,
    /// Reset of the high-pass filter.
    pub high_pass: HighPassMode,
    /// Corner of the high-pass filter in Hz.
    pub corner_hz: f64,
    /// Filtered data goes to the output registers (FDS).
    pub filtered_output: bool,
    /// Filtered data goes to generator 1, 2 (HPIS1, HPIS2).
    pub filtered_generator: [bool; 2],
}

impl Setup {
    /// Reads the configuration out of the registers.
    pub fn of(registers: &Registers) -> Self {
        let control = registers.get(CTRL_REG1_A);
        let filter = registers.get(CTRL_REG2_A);
        let scale = usize::from(registers.get(CTRL_REG4_A) >> 4 & 0x03);
        let mode = mode(registers);
        let (rate_hz, row) = rate(control >> 4, mode);
        Self {
            rate_hz,
            mode,
            axes: [0x01, 0x02, 0x04].map(|bit| control & bit != 0),
            sensitivity: SENSITIVITY[mode as usize][scale] / 1000.0,
            threshold: THRESHOLD_MG[scale] / 1000.0,
            reference: REFERENCE_MG[scale] / 1000.0,
            high_pass: match filter >> 6 {
                0 => HighPassMode::ResetByReading,
                1 => HighPassMode::Reference,
                2 => HighPassMode::Normal,
                _ => HighPassMode::ResetByInterrupt,
            },
            corner_hz: CORNERS[row][usize::from(filter >> 4 & 0x03)],
            filtered_output: filter & 0x08 != 0,
            filtered_generator: [filter & 0x01 != 0, filter & 0x02 != 0],
        }
    }
}

/// LPen and HR together are forbidden; the model lets low power win.
fn mode(registers: &Registers) -> Mode {
    if registers.has(CTRL_REG1_A, 0x08) {
        Mode::LowPower
    } else if registers.has(CTRL_REG4_A, 0x08) {
        Mode::HighResolution
    } else {
        Mode::Normal
    }
}

/// The rate of an ODR code and its row in the table of corners.
fn rate(code: u8, mode: Mode) -> (Option<f64>, usize) {
    match (code, mode) {
        (1..=7, _) => {
            let row = usize::from(code) - 1;
            (Some(RATES[row]), row)
        }
        (8, Mode::LowPower) => (Some(1620.0), 7),
        (9, Mode::LowPower) => (Some(5376.0), 8),
        (9, _) => (Some(1344.0), 7),
        _ => (None, 0),
    }
}

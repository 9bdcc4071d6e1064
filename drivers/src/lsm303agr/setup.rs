//! Plain configuration of both halves and its register values.

use super::{
    AccelFullScale, AccelThreshold, MagThreshold, ThresholdDuration,
    register::{
        CTRL_REG1_A, CTRL_REG2_A, CTRL_REG3_A, CTRL_REG4_A, CTRL_REG5_A, INT1_CFG_A,
        INT1_DURATION_A, INT1_THS_A,
    },
};
use crate::quantity::Hertz;

/// Axes that a comparator watches; any one of them interrupts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Axes {
    /// X axis.
    pub x: bool,
    /// Y axis.
    pub y: bool,
    /// Z axis.
    pub z: bool,
}

impl Axes {
    /// All three: the chip then compares the largest change per axis.
    pub const ALL: Self = Self {
        x: true,
        y: true,
        z: true,
    };

    const fn bits(self, x: u8, y: u8, z: u8) -> u8 {
        (if self.x { x } else { 0 }) | (if self.y { y } else { 0 }) | (if self.z { z } else { 0 })
    }
}

/// Data rate of the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum AccelDataRate {
    /// 1 Hz.
    Hz1,
    /// 10 Hz.
    Hz10,
    /// 25 Hz.
    Hz25,
    /// 50 Hz.
    Hz50,
    /// 100 Hz.
    Hz100,
    /// 200 Hz.
    Hz200,
    /// 400 Hz.
    Hz400,
    /// 1344 Hz, not in low-power mode.
    Hz1344,
}

impl AccelDataRate {
    /// Nominal rate; the chip's oscillator may be off by a few per cent.
    #[must_use]
    pub const fn nominal(self) -> Hertz {
        Hertz(match self {
            Self::Hz1 => 1.0,
            Self::Hz10 => 10.0,
            Self::Hz25 => 25.0,
            Self::Hz50 => 50.0,
            Self::Hz100 => 100.0,
            Self::Hz200 => 200.0,
            Self::Hz400 => 400.0,
            Self::Hz1344 => 1344.0,
        })
    }

    const fn code(self) -> u8 {
        match self {
            Self::Hz1 => 1,
            Self::Hz10 => 2,
            Self::Hz25 => 3,
            Self::Hz50 => 4,
            Self::Hz100 => 5,
            Self::Hz200 => 6,
            Self::Hz400 => 7,
            Self::Hz1344 => 9,
        }
    }
}

/// Resolution of the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum AccelMode {
    /// 8 bits.
    LowPower,
    /// 10 bits.
    Normal,
    /// 12 bits.
    HighResolution,
}

/// What the crate `lsm303agr` was told to set.
///
/// For [`super::Accelerometer::verify_output`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct AccelOutput {
    /// Data rate.
    pub data_rate: AccelDataRate,
    /// Full scale.
    pub full_scale: AccelFullScale,
    /// Resolution.
    pub mode: AccelMode,
}

impl AccelOutput {
    /// Addresses and values: all axes on, block update and SPI enabled.
    pub(super) const fn registers(self) -> [(u8, u8); 2] {
        let low_power = matches!(self.mode, AccelMode::LowPower) as u8;
        let high_resolution = matches!(self.mode, AccelMode::HighResolution) as u8;
        [
            (
                CTRL_REG1_A,
                self.data_rate.code() << 4 | low_power << 3 | 0x07,
            ),
            (
                CTRL_REG4_A,
                0x80 | self.full_scale.code() << 4 | high_resolution << 3 | 0x01,
            ),
        ]
    }
}

/// What drives the pin INT_1_XL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum AccelPin {
    /// Nothing: the pin stays low.
    Nothing,
    /// A new sample.
    DataReady,
    /// The threshold of generator 1.
    Threshold,
    /// Both.
    DataReadyAndThreshold,
}

impl AccelPin {
    pub(super) const fn bits(self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::DataReady => 0x10,
            Self::Threshold => 0x40,
            Self::DataReadyAndThreshold => 0x50,
        }
    }
}

/// How the high-pass filter takes a new reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum HighPassMode {
    /// It snaps to the present sample when REFERENCE_A is read.
    ResetByReading,
    /// It subtracts REFERENCE_A, one 8-bit value for all axes.
    Reference,
    /// It runs free.
    Normal,
    /// It snaps at every interrupt; not together with the high-resolution mode.
    ResetAtInterrupt,
}

/// Corner of the high-pass filter as a share of the data rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum HighPassCorner {
    /// Data rate / 50: forgets fastest.
    Fiftieth,
    /// Data rate / 100.
    Hundredth,
    /// Data rate / 200.
    TwoHundredth,
    /// Data rate / 400: forgets slowest.
    FourHundredth,
}

impl HighPassCorner {
    /// Corner frequency at a data rate.
    ///
    /// AN4825's table rounds it: 0.2 Hz for the slowest at 100 Hz.
    #[must_use]
    pub const fn frequency(self, data_rate: AccelDataRate) -> Hertz {
        let divider = match self {
            Self::Fiftieth => 50.0,
            Self::Hundredth => 100.0,
            Self::TwoHundredth => 200.0,
            Self::FourHundredth => 400.0,
        };
        Hertz(data_rate.nominal().0 / divider)
    }

    const fn code(self) -> u8 {
        match self {
            Self::Fiftieth => 0,
            Self::Hundredth => 1,
            Self::TwoHundredth => 2,
            Self::FourHundredth => 3,
        }
    }
}

/// High-pass filter before generator 1; the output registers stay unfiltered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct HighPass {
    /// How it takes a new reference.
    pub mode: HighPassMode,
    /// How fast it forgets.
    pub corner: HighPassCorner,
}

impl HighPass {
    /// CTRL_REG2_A: filter on generator 1 only (HPIS1), not on the output (FDS).
    const fn bits(self) -> u8 {
        let mode = match self.mode {
            HighPassMode::ResetByReading => 0,
            HighPassMode::Reference => 1,
            HighPassMode::Normal => 2,
            HighPassMode::ResetAtInterrupt => 3,
        };
        mode << 6 | self.corner.code() << 4 | 0x01
    }
}

/// The accelerometer's threshold interrupt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct AccelInterrupt {
    /// Filter before the comparison; `None` compares the acceleration itself.
    pub high_pass: Option<HighPass>,
    /// Axes compared.
    pub axes: Axes,
    /// Magnitude to exceed on one of them.
    pub threshold: AccelThreshold,
    /// Samples above it before the interrupt.
    pub duration: ThresholdDuration,
    /// Hold the request until the source is read.
    pub latch: bool,
    /// What drives INT_1_XL.
    pub pin: AccelPin,
}

impl AccelInterrupt {
    /// Addresses and values in the order of writing: the pin last.
    pub(super) fn registers(self) -> [(u8, u8); 6] {
        [
            (CTRL_REG2_A, self.high_pass.map_or(0, HighPass::bits)),
            (CTRL_REG5_A, if self.latch { 0x08 } else { 0 }),
            (INT1_THS_A, self.threshold.code()),
            (INT1_DURATION_A, self.duration.code()),
            (INT1_CFG_A, self.axes.bits(0x02, 0x08, 0x20)),
            (CTRL_REG3_A, self.pin.bits()),
        ]
    }
}

/// What the magnetometer's comparator sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum MagCompare {
    /// The field itself.
    Field,
    /// The change since the OFFSET registers were written (INT_on_DataOFF).
    ChangeFromOffset,
}

/// What drives the pin INT_MAG.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum MagPin {
    /// Nothing.
    Nothing,
    /// A new sample.
    DataReady,
    /// The comparator.
    Threshold,
}

impl MagPin {
    pub(super) const MASK: u8 = 0x41;

    pub(super) const fn bits(self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::DataReady => 0x01,
            Self::Threshold => 0x40,
        }
    }
}

/// The magnetometer's threshold interrupt, active high.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct MagInterrupt {
    /// What is compared.
    pub compare: MagCompare,
    /// Axes compared.
    pub axes: Axes,
    /// Magnitude to exceed on one of them, of either sign.
    pub threshold: MagThreshold,
    /// Hold the request until the source is read.
    pub latch: bool,
    /// What drives INT_MAG.
    pub pin: MagPin,
}

impl MagInterrupt {
    pub(super) const COMPARE_MASK: u8 = 0x08;

    pub(super) const fn compare_bits(self) -> u8 {
        match self.compare {
            MagCompare::Field => 0,
            MagCompare::ChangeFromOffset => Self::COMPARE_MASK,
        }
    }

    /// INT_CTRL_REG_M: axes, active high (IEA), latch (IEL), enable (IEN).
    pub(super) const fn control(self) -> u8 {
        self.axes.bits(0x80, 0x40, 0x20) | 0x04 | (self.latch as u8) << 1 | 0x01
    }
}

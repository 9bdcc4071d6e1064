//! Threshold and duration codes of the two comparators.

use super::{AccelFullScale, MAG_STEP};
use crate::{
    quantity::{Gauss, MetersPerSecondSquared},
    threshold::{ThresholdError, checked_code, round_down},
};

/// Threshold of the accelerometer's generator 1: code 1 to 127 of INT1_THS_A.
///
/// One step is 16, 32, 62 or 186 mg at a full scale of 2, 4, 8 or 16 g.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct AccelThreshold(u8);

impl AccelThreshold {
    /// The largest code.
    pub const MAX: Self = Self(0x7F);

    /// The highest threshold not above `value`, at most [`Self::MAX`].
    ///
    /// # Errors
    /// `BelowOneStep` for less than one step (code 0), `NotANumber`.
    pub fn round_down(
        value: MetersPerSecondSquared,
        full_scale: AccelFullScale,
    ) -> Result<Self, ThresholdError> {
        round_down(value.0, 0x7F, |code| level(code, full_scale)).map(Self::from_checked)
    }

    /// A raw code.
    ///
    /// # Errors
    /// `BelowOneStep` for 0, `CodeTooLarge` above 127.
    pub fn from_code(code: u8) -> Result<Self, ThresholdError> {
        checked_code(u16::from(code), 0x7F).map(Self::from_checked)
    }

    /// What INT1_THS_A holds.
    #[must_use]
    pub const fn code(self) -> u8 {
        self.0
    }

    /// The change that this code stands for.
    ///
    /// [`Self::round_down`] turns it into the same code.
    #[must_use]
    pub fn level(self, full_scale: AccelFullScale) -> MetersPerSecondSquared {
        MetersPerSecondSquared(level(u16::from(self.0), full_scale))
    }

    fn from_checked(code: u16) -> Self {
        // Both callers limit the code to 7 bits.
        Self((code & 0x7F) as u8)
    }
}

fn level(code: u16, full_scale: AccelFullScale) -> f32 {
    f32::from(code) * full_scale.threshold_step().0
}

/// Threshold of the magnetometer: code 1 to 65535, 1.5 milligauss each.
///
/// Codes above 32767 lie outside the output's range of 16 bits with sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct MagThreshold(u16);

impl MagThreshold {
    /// The largest code.
    pub const MAX: Self = Self(u16::MAX);

    /// The largest code that an output of 16 bits with sign can exceed.
    pub const LARGEST_USEFUL: Self = Self(i16::MAX as u16);

    /// The highest threshold not above `value`, at most [`Self::MAX`].
    ///
    /// # Errors
    /// `BelowOneStep` for less than one step (code 0), `NotANumber`.
    pub fn round_down(value: Gauss) -> Result<Self, ThresholdError> {
        round_down(value.0, u16::MAX, |code| f32::from(code) * MAG_STEP.0).map(Self)
    }

    /// A raw code.
    ///
    /// # Errors
    /// `BelowOneStep` for 0.
    pub fn from_code(code: u16) -> Result<Self, ThresholdError> {
        checked_code(code, u16::MAX).map(Self)
    }

    /// What INT_THS holds.
    #[must_use]
    pub const fn code(self) -> u16 {
        self.0
    }

    /// The change that this code stands for.
    ///
    /// [`Self::round_down`] turns it into the same code.
    #[must_use]
    pub fn level(self) -> Gauss {
        Gauss(f32::from(self.0) * MAG_STEP.0)
    }
}

/// Data periods above the threshold before the interrupt: 0 to 127.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct ThresholdDuration(u8);

impl ThresholdDuration {
    /// The first sample above the threshold interrupts.
    pub const IMMEDIATE: Self = Self(0);

    /// `samples` data periods; `None` above 127.
    #[must_use]
    pub const fn samples(samples: u8) -> Option<Self> {
        if samples <= 0x7F {
            Some(Self(samples))
        } else {
            None
        }
    }

    /// What INT1_DURATION_A holds.
    #[must_use]
    pub const fn code(self) -> u8 {
        self.0
    }
}

//! Motion detector: a threshold on high-passed acceleration, never the gyro.

use crate::{
    quantity::{MetersPerSecondSquared, STANDARD_GRAVITY},
    threshold::{ThresholdError, checked_code, round_down},
};

/// One step of MOT_THR where it was not calibrated: 32 mg.
///
/// Sources disagree: 2 mg (register map before revision 3, and the driver libraries made from it),
/// 32 mg (product specification), 8 to 32 mg by die (public measurements). The largest gives the
/// smallest code for a threshold, so an error here fires too often and never too rarely.
pub const NOMINAL_MOTION_STEP: MetersPerSecondSquared =
    MetersPerSecondSquared(32.0e-3 * STANDARD_GRAVITY);

/// Threshold of the motion detector: code 1 to 255 of MOT_THR.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct MotionThreshold(u8);

impl MotionThreshold {
    /// The largest code.
    pub const MAX: Self = Self(u8::MAX);

    /// The highest threshold not above `value`, at most [`Self::MAX`].
    ///
    /// `step` is what one code is worth on this very chip.
    ///
    /// # Errors
    /// `BelowOneStep` for less than one step (code 0), `NotANumber`, also for a `step` that is not
    /// a positive, finite number.
    pub fn round_down(
        value: MetersPerSecondSquared,
        step: MetersPerSecondSquared,
    ) -> Result<Self, ThresholdError> {
        if !step.0.is_normal() || step.0 < 0.0 {
            return Err(ThresholdError::NotANumber);
        }
        round_down(value.0, 0xFF, |code| f32::from(code) * step.0).map(Self::from_checked)
    }

    /// A raw code.
    ///
    /// # Errors
    /// `BelowOneStep` for 0.
    pub fn from_code(code: u8) -> Result<Self, ThresholdError> {
        checked_code(u16::from(code), 0xFF).map(Self::from_checked)
    }

    /// What MOT_THR holds.
    #[must_use]
    pub const fn code(self) -> u8 {
        self.0
    }

    /// The change that this code stands for, with the same `step`.
    #[must_use]
    pub fn level(self, step: MetersPerSecondSquared) -> MetersPerSecondSquared {
        MetersPerSecondSquared(f32::from(self.0) * step.0)
    }

    fn from_checked(code: u16) -> Self {
        // Both callers limit the code to 8 bits.
        Self((code & 0xFF) as u8)
    }
}

/// High-pass filter (ACCEL_HPF) before the motion detector only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum MotionHighPass {
    /// Output always 0: the detector never fires.
    Reset,
    /// Corner at 5 Hz.
    Hz5,
    /// Corner at 2.5 Hz.
    Hz2_5,
    /// Corner at 1.25 Hz.
    Hz1_25,
    /// Corner at 0.63 Hz.
    Hz0_63,
    /// Difference from the sample held on entering: it does not forget.
    Hold,
}

impl MotionHighPass {
    pub(super) const fn bits(self) -> u8 {
        match self {
            Self::Reset => 0,
            Self::Hz5 => 1,
            Self::Hz2_5 => 2,
            Self::Hz1_25 => 3,
            Self::Hz0_63 => 4,
            Self::Hold => 7,
        }
    }
}

/// How the duration counter falls below the threshold (MOT_COUNT).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum MotionDecrement {
    /// To 0 at once.
    Reset,
    /// By 1 per millisecond.
    One,
    /// By 2 per millisecond.
    Two,
    /// By 4 per millisecond.
    Four,
}

/// Configuration of the motion detector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct MotionDetector {
    /// Filter before the comparison.
    pub high_pass: MotionHighPass,
    /// Magnitude to exceed on any axis.
    pub threshold: MotionThreshold,
    /// Time above it before the interrupt, in ms of the chip's counter.
    pub duration_ms: u8,
    /// How the counter falls.
    pub decrement: MotionDecrement,
}

impl MotionDetector {
    /// MOT_THR, MOT_DUR and MOT_DETECT_CTRL (no additional start-up delay).
    pub(super) const fn bytes(self) -> [u8; 3] {
        [
            self.threshold.code(),
            self.duration_ms,
            self.decrement as u8,
        ]
    }
}

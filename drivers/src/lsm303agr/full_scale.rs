//! Full scale of the accelerometer: what a step of its codes is worth.

use crate::quantity::{MetersPerSecondSquared, STANDARD_GRAVITY};

/// Full scale of the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum AccelFullScale {
    /// +-2 g.
    G2,
    /// +-4 g.
    G4,
    /// +-8 g.
    G8,
    /// +-16 g.
    G16,
}

impl AccelFullScale {
    /// One step of the threshold register.
    #[must_use]
    pub const fn threshold_step(self) -> MetersPerSecondSquared {
        let milli_g = match self {
            Self::G2 => 16.0,
            Self::G4 => 32.0,
            Self::G8 => 62.0,
            Self::G16 => 186.0,
        };
        MetersPerSecondSquared(milli_g * 1.0e-3 * STANDARD_GRAVITY)
    }

    /// One count of the left-justified output in high resolution.
    #[must_use]
    pub const fn count_step(self) -> MetersPerSecondSquared {
        // Sensitivity in mg per 12-bit digit, of which one is 16 counts.
        let milli_g_per_digit = match self {
            Self::G2 => 0.98,
            Self::G4 => 1.95,
            Self::G8 => 3.9,
            Self::G16 => 11.72,
        };
        MetersPerSecondSquared(milli_g_per_digit / 16.0 * 1.0e-3 * STANDARD_GRAVITY)
    }

    pub(super) const fn code(self) -> u8 {
        match self {
            Self::G2 => 0,
            Self::G4 => 1,
            Self::G8 => 2,
            Self::G16 => 3,
        }
    }
}

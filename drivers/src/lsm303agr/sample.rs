//! What the chip reports: output counts, status bits, interrupt sources.

use super::AccelFullScale;
use crate::quantity::{Gauss, MetersPerSecondSquared};

/// One count of the magnetometer's output, offset and threshold.
pub const MAG_STEP: Gauss = Gauss(1.5e-3);

/// Acceleration as the chip holds it: left-justified, 16 bits with sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct AccelCounts(pub [i16; 3]);

impl AccelCounts {
    /// Specific force along the chip's axes.
    ///
    /// With the sensitivity of the high-resolution mode; the other modes differ by under 0.6 %.
    #[must_use]
    pub fn specific_force(self, full_scale: AccelFullScale) -> [MetersPerSecondSquared; 3] {
        let step = full_scale.count_step().0;
        self.0
            .map(|count| MetersPerSecondSquared(f32::from(count) * step))
    }
}

/// Magnetic field as the chip holds it: less the offset registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct MagCounts(pub [i16; 3]);

impl MagCounts {
    /// Field along the chip's axes, less the offset registers.
    #[must_use]
    pub fn field(self) -> [Gauss; 3] {
        self.0.map(|count| Gauss(f32::from(count) * MAG_STEP.0))
    }

    /// The field's counts with the offset that was in force added back.
    #[must_use]
    pub fn with_offset_restored(self, offset: MagOffset) -> Self {
        let ([x, y, z], [dx, dy, dz]) = (self.0, offset.0);
        Self([
            x.saturating_add(dx),
            y.saturating_add(dy),
            z.saturating_add(dz),
        ])
    }
}

/// The OFFSET registers, which the chip subtracts from every sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct MagOffset(pub [i16; 3]);

impl MagOffset {
    /// Makes `sample` the new zero; its own offset must have been restored.
    #[must_use]
    pub const fn at(sample: MagCounts) -> Self {
        Self(sample.0)
    }
}

/// STATUS_REG_A or STATUS_REG_M: both use the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Status(pub u8);

impl Status {
    /// All three axes have a sample that was not read yet.
    #[must_use]
    pub const fn new_sample(self) -> bool {
        self.0 & 0x08 != 0
    }
}

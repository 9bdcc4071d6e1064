//! Roll and pitch as level mode sees them: two angles.

use crate::math::{Quaternion, atan2, limited, sqrt};
use crate::settings::gains::cleanflight::Level;

/// Roll and pitch as angles, in rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lean {
    /// To the right, -pi to pi.
    pub roll: f32,
    /// Nose up, -pi/2 to pi/2.
    pub pitch: f32,
}

impl Lean {
    /// The angles of an attitude.
    #[must_use]
    pub fn of(attitude: Quaternion) -> Self {
        let down = attitude.down_in_body();
        Self {
            roll: atan2(down.y, down.z),
            pitch: atan2(-down.x, sqrt(down.y * down.y + down.z * down.z)),
        }
    }

    /// As far as level mode may lean.
    #[must_use]
    pub(super) fn within_limits(self, gains: &Level) -> Self {
        Self {
            roll: limited(self.roll, gains.max_lean_rad),
            pitch: limited(self.pitch, gains.max_lean_rad),
        }
    }
}

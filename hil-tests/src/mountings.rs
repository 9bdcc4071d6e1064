//! How the simulated chips lie: as the firmware was built to have them.

use chip_models::Axes;
use reflex::config::{CHIP_MOUNTING, IMU_MOUNTING};
use reflex::settings::Mounting;

/// Axes of the inertial sensor and of the other chip, as options of the chips want them.
pub(crate) fn mountings() -> [Axes; 2] {
    [IMU_MOUNTING, CHIP_MOUNTING].map(Mounting::axes)
}

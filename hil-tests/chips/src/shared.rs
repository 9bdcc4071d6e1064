//! All chips of the board around one source, shared with who looks into them.

use std::sync::{Arc, Mutex};

use super::lsm303agr::{Accelerometer, Magnetometer};
use super::{ChipOptions, Mpu6050, StimulusSource};

/// The chips, for the emulated buses and for their owner.
#[derive(Clone)]
pub struct SharedChips {
    /// The inertial sensor.
    pub imu: Arc<Mutex<Mpu6050>>,
    /// Accelerometer die of the LSM303AGR.
    pub accel: Arc<Mutex<Accelerometer>>,
    /// Magnetometer die of the LSM303AGR.
    pub mag: Arc<Mutex<Magnetometer>>,
}

impl SharedChips {
    /// New chips that feel a source.
    #[must_use]
    pub fn feeling(source: &Arc<dyn StimulusSource>, options: ChipOptions) -> Self {
        Self {
            imu: Arc::new(Mutex::new(Mpu6050::new(Arc::clone(source), options))),
            accel: Arc::new(Mutex::new(Accelerometer::new(Arc::clone(source), options))),
            mag: Arc::new(Mutex::new(Magnetometer::new(Arc::clone(source), options))),
        }
    }
}

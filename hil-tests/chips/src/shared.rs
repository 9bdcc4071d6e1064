//! All chips of the board around one source, shared with who looks into them.

use std::sync::{Arc, Mutex};

use super::{ChipOptions, DIES, Mpu6050, OfDies, OwnClock, StimulusSource};

/// The chips, for the emulated buses and for their owner.
#[derive(Clone)]
pub struct SharedChips {
    /// The inertial sensor.
    pub imu: Arc<Mutex<Mpu6050>>,
    /// The others.
    pub dies: OfDies<Arc<Mutex<Box<dyn OwnClock>>>>,
}

impl SharedChips {
    /// New chips that feel a source.
    #[must_use]
    pub fn feeling(source: &Arc<dyn StimulusSource>, options: ChipOptions) -> Self {
        Self {
            imu: Arc::new(Mutex::new(Mpu6050::new(Arc::clone(source), options))),
            dies: DIES.map(|die| Arc::new(Mutex::new((die.model)(Arc::clone(source), options)))),
        }
    }
}

//! All chips of the board around one source, shared with who looks into them.

use std::sync::{Arc, Mutex};

use super::lsm303agr::{Accelerometer, Magnetometer};
use super::{ChipOptions, Mpu6050, Present, SpiChip, StimulusSource};

/// A die on SPI with a clock and an interrupt pin of its own, as both tiers look at it.
pub trait OwnClock: SpiChip {
    /// Output samples produced so far, across resets.
    fn samples(&self) -> u64;
    /// The threshold code that the interrupt pin follows; `None` where it follows every sample.
    fn pin_threshold(&self) -> Option<u32>;
    /// Nominal data rate in Hz; `None` where it does not sample.
    fn rate_hz(&self) -> Option<f64>;
    /// A supply dip at `now_ns`: every register back to its reset value.
    fn brown_out(&mut self, now_ns: u64);
}

macro_rules! own_clock {
    ($($die:ty),*) => {
        $(impl OwnClock for $die {
            fn samples(&self) -> u64 {
                self.samples()
            }

            fn pin_threshold(&self) -> Option<u32> {
                self.pin_threshold()
            }

            fn rate_hz(&self) -> Option<f64> {
                self.rate_hz()
            }

            fn brown_out(&mut self, now_ns: u64) {
                self.brown_out(now_ns);
            }
        })*
    };
}

own_clock!(Accelerometer, Magnetometer);

/// The dies with a clock of their own that both tiers play.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Die {
    /// Accelerometer of the LSM303AGR.
    Accel,
    /// Magnetometer of the LSM303AGR.
    Mag,
}

/// A value for each die, in the order of [`Die::ALL`].
pub type OfDies<T> = [T; Die::ALL.len()];

impl Die {
    /// All of them: both tiers play this list.
    pub const ALL: [Self; 2] = [Self::Accel, Self::Mag];

    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accel => "lsm303agr_accel",
            Self::Mag => "lsm303agr_mag",
        }
    }

    /// True where the sensor exists.
    #[must_use]
    pub const fn is_present(self, present: Present) -> bool {
        match self {
            Self::Accel => present.accelerometer,
            Self::Mag => present.magnetometer,
        }
    }

    /// A new one that feels a source.
    #[must_use]
    pub fn model(
        self,
        source: &Arc<dyn StimulusSource>,
        options: ChipOptions,
    ) -> Box<dyn OwnClock> {
        let source = Arc::clone(source);
        match self {
            Self::Accel => Box::new(Accelerometer::new(source, options)),
            Self::Mag => Box::new(Magnetometer::new(source, options)),
        }
    }
}

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
            dies: Die::ALL.map(|die| Arc::new(Mutex::new(die.model(source, options)))),
        }
    }
}

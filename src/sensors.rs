//! What the sensors deliver: raw counts with their scale, and samples in SI units.
//!
//! Counts enter here and nowhere else become physical quantities. Scales are those of the
//! ranges the firmware programs: MPU6050 +-2000 deg/s and +-16 g, LSM303AGR +-2 g
//! high-resolution and 1.5 mG.

use crate::math::Vec3;
use crate::time::Instant;
use crate::units::{BodyRates, MagneticField, SpecificForce};

pub use reflex_settings::{Input, Inputs};

/// Standard gravity in m/s2.
pub const GRAVITY: f32 = 9.806_65;

/// Length of one MPU6050 burst: INT_STATUS (0x3A) and the 14 data registers behind it.
pub const IMU_BURST_LENGTH: usize = 15;

/// rad/s per count at +-2000 deg/s (PS-MPU-6000A, table 6.1: 16.4 counts per deg/s).
pub const GYRO_SCALE: f32 = core::f32::consts::PI / (180.0 * 16.4);

/// m/s2 per count at +-16 g (PS-MPU-6000A, table 6.2: 2048 counts per g).
pub const IMU_ACCEL_SCALE: f32 = GRAVITY / 2048.0;

/// m/s2 per count at +-2 g: 12 bits left-justified, 0.98 mg a digit (LSM303AGR, table 3).
///
/// The finest range, because its threshold has the finest step, and because the MPU6050 sees
/// what lies beyond it.
pub const CHIP_ACCEL_SCALE: f32 = GRAVITY * 0.000_98 / 16.0;

/// Gauss per count (LSM303AGR, table 3: 1.5 mG).
pub const MAG_SCALE: f32 = 0.0015;

/// Why a sample of the LSM303AGR was fetched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[repr(u8)]
pub enum Cause {
    /// Its data-ready interrupt: every sample arrives.
    DataReady = 0,
    /// Its threshold interrupt: the chip compared, the change was past the threshold.
    Threshold = 1,
    /// A heartbeat read at the failsafe rate, independent of its interrupts.
    Heartbeat = 2,
    /// The chip's reference was set to this very sample.
    Rearm = 3,
}

impl Cause {
    /// The cause of a number, `None` past the last.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        [
            Self::DataReady,
            Self::Threshold,
            Self::Heartbeat,
            Self::Rearm,
        ]
        .get(usize::from(number))
        .copied()
    }
}

/// One reading of the MPU6050 in SI units, stamped when its interrupt arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuSample {
    /// When the data-ready interrupt arrived.
    pub at: Instant,
    /// Angular rates, bias not removed.
    pub rates: BodyRates,
    /// Specific force.
    pub force: SpecificForce,
}

impl ImuSample {
    /// Decodes a burst: INT_STATUS, accelerometer, temperature, gyroscope, big-endian.
    ///
    /// `None` where the chip says that no new data were ready (INT_STATUS bit 0 clear): the
    /// burst repeats an old sample.
    #[must_use]
    pub fn from_burst(at: Instant, burst: &[u8; IMU_BURST_LENGTH]) -> Option<Self> {
        let &[
            status,
            ax,
            axl,
            ay,
            ayl,
            az,
            azl,
            _,
            _,
            gx,
            gxl,
            gy,
            gyl,
            gz,
            gzl,
        ] = burst;
        if status & 1 == 0 {
            return None;
        }
        let count = |high, low| f32::from(i16::from_be_bytes([high, low]));
        Some(Self {
            at,
            rates: BodyRates(
                Vec3::new(count(gx, gxl), count(gy, gyl), count(gz, gzl)) * GYRO_SCALE,
            ),
            force: SpecificForce(
                Vec3::new(count(ax, axl), count(ay, ayl), count(az, azl)) * IMU_ACCEL_SCALE,
            ),
        })
    }
}

fn scaled(counts: [i16; 3], scale: f32) -> Vec3 {
    let [x, y, z] = counts.map(f32::from);
    Vec3::new(x, y, z) * scale
}

/// Accelerometer counts of the LSM303AGR as a specific force.
#[must_use]
pub fn chip_force(counts: [i16; 3]) -> SpecificForce {
    SpecificForce(scaled(counts, CHIP_ACCEL_SCALE))
}

/// Magnetometer counts of the LSM303AGR as a field, its OFFSET registers already added back.
#[must_use]
pub fn chip_field(counts: [i16; 3]) -> MagneticField {
    MagneticField(scaled(counts, MAG_SCALE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    #[test]
    fn a_burst_is_decoded_in_the_order_of_the_register_map() {
        let burst = [1, 0x08, 0, 0, 0, 0xF8, 0, 9, 9, 0, 164, 0, 0, 0xFF, 0x5C];
        let sample = ImuSample::from_burst(at_micros(7), &burst).expect("data ready");
        assert!((sample.force.0.x - GRAVITY).abs() < 1e-4);
        assert!((sample.force.0.z + GRAVITY).abs() < 1e-4);
        assert!((sample.rates.0.x.to_degrees() - 10.0).abs() < 1e-4);
        assert!((sample.rates.0.z.to_degrees() + 10.0).abs() < 1e-4);
    }

    #[test]
    fn a_burst_without_new_data_is_no_sample() {
        assert_eq!(ImuSample::from_burst(at_micros(7), &[0; 15]), None);
    }
}

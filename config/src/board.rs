//! `boards/*.toml`: what may vary on one wiring.

use serde::Deserialize;

use crate::document::Document;
use crate::{ConfigError, range};

/// The content of a file of `boards/`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Board {
    /// Rates of the sensors.
    pub sensors: Sensors,
    /// Low-pass filters on every sample.
    pub filters: Filters,
    /// The gyro's bias at rest.
    pub calibration: Calibration,
    /// The serial link.
    pub link: Link,
    /// The motor outputs.
    pub motors: Motors,
}

/// Rates of the sensors.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensors {
    /// Rate of the MPU6050 in Hz.
    #[serde(deserialize_with = "range::imu_rate")]
    pub imu_rate_hz: u32,
    /// Rate of the LSM303AGR's accelerometer in Hz.
    #[serde(deserialize_with = "range::chip_accel_rate")]
    pub chip_accel_rate_hz: u32,
    /// Rate of the LSM303AGR's magnetometer in Hz.
    #[serde(deserialize_with = "range::chip_mag_rate")]
    pub chip_mag_rate_hz: u32,
}

/// Low-pass filters on every sample.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Filters {
    /// Corner of the gyro's filter in Hz, 5 to 0.45 times the rate.
    #[serde(deserialize_with = "range::sample_cutoff")]
    pub gyro_cutoff_hz: f64,
    /// Corner of the accelerometer's filter in Hz, 5 to 0.45 times the rate.
    #[serde(deserialize_with = "range::sample_cutoff")]
    pub accel_cutoff_hz: f64,
}

/// The gyro's bias at rest.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Time over which the bias is averaged, in s, 0.1 to 10.
    #[serde(deserialize_with = "range::short_time")]
    pub length_s: f64,
    /// Largest deviation from the mean at rest, in rad/s, within (0, 1].
    #[serde(deserialize_with = "range::still_gyro")]
    pub still_gyro_rad_s: f64,
}

/// The serial link.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Bits per second.
    #[serde(deserialize_with = "range::baud")]
    pub baud: u32,
    /// Time without a setpoint after which it is lost, in s, 0.1 to 10.
    #[serde(deserialize_with = "range::short_time")]
    pub setpoint_timeout_s: f64,
}

/// The motor outputs.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motors {
    /// How a command becomes a pulse.
    pub protocol: MotorProtocol,
}

/// How a motor command becomes a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MotorProtocol {
    /// 125 to 250 us, 2000 times a second.
    OneShot125,
    /// 1000 to 2000 us, 400 times a second.
    Pwm,
}

impl Board {
    /// What only several values together can show.
    pub(crate) fn check(&self, document: &Document) -> Result<(), ConfigError> {
        let highest = 0.45 * f64::from(self.sensors.imu_rate_hz);
        let filters = [
            ("gyro_cutoff_hz", self.filters.gyro_cutoff_hz),
            ("accel_cutoff_hz", self.filters.accel_cutoff_hz),
        ];
        for (name, cutoff) in filters {
            if cutoff > highest {
                let message = format!("must be 5 to 0.45 times imu_rate_hz, {highest} Hz");
                return Err(document.error_at(&["filters", name], message));
            }
        }
        Ok(())
    }
}

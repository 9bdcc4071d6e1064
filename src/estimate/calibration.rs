//! The gyroscope's bias, measured while the drone stands still.

use crate::config::{CALIBRATION_LENGTH, STILL_GYRO};
use crate::math::Vec3;
use crate::sensors::{GRAVITY, ImuSample};
use crate::time::{Instant, span};
use crate::units::BodyRates;

/// The largest bias a healthy MPU6050 may have: 20 deg/s (PS-MPU-6000A, table 6.1) and reserve.
const LARGEST_BIAS: f32 = 0.5;

/// How far the specific force may be from 1 g at rest, in m/s2.
const STILL_FORCE: f32 = 1.5;

/// Collects samples until they stayed still for long enough; any movement starts it anew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GyroCalibration {
    since: Option<Instant>,
    first: Vec3,
    sum: Vec3,
    force: Vec3,
    count: u32,
}

/// What calibration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest {
    /// The rates a still gyroscope reports.
    pub bias: BodyRates,
    /// The mean specific force, hence which way is up.
    pub force: Vec3,
}

impl GyroCalibration {
    /// Takes a raw sample; what was found once the drone stood still for long enough.
    pub fn take(&mut self, sample: &ImuSample) -> Option<AtRest> {
        let rates = sample.rates.0;
        let since = *self.since.get_or_insert(sample.at);
        if self.count == 0 {
            self.first = rates;
        }
        let turned = (rates - self.first).max_norm() > STILL_GYRO;
        let pushed = (sample.force.0.norm() - GRAVITY).abs() > STILL_FORCE;
        if turned || pushed || rates.max_norm() > LARGEST_BIAS {
            *self = Self::default();
            return None;
        }
        self.sum += rates;
        self.force += sample.force.0;
        self.count += 1;
        if span(since, sample.at) < CALIBRATION_LENGTH {
            return None;
        }
        let share = 1.0 / self.count as f32;
        Some(AtRest {
            bias: BodyRates(self.sum * share),
            force: self.force * share,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;
    use crate::units::SpecificForce;

    fn sample(milliseconds: u64, rate: f32, force: f32) -> ImuSample {
        ImuSample {
            at: at_micros(milliseconds * 1000),
            rates: BodyRates(Vec3::new(rate, -rate, 0.0)),
            force: SpecificForce(Vec3::new(0.0, 0.0, force)),
        }
    }

    #[test]
    fn the_bias_is_the_mean_of_a_still_stretch() {
        let mut calibration = GyroCalibration::default();
        let found = (0..2000).find_map(|at| {
            let noise = if at % 2 == 0 { 0.01 } else { -0.01 };
            calibration.take(&sample(at, 0.05 + noise, -9.8))
        });
        let bias = found.expect("still for 2 s").bias.0;
        assert!((bias.x - 0.05).abs() < 1e-3);
    }

    #[test]
    fn movement_and_free_fall_start_it_anew() {
        let mut calibration = GyroCalibration::default();
        assert!((0..5000).all(|at| {
            calibration
                .take(&sample(at, (at % 300) as f32 * 0.001, -9.8))
                .is_none()
        }));
        assert!((0..5000).all(|at| calibration.take(&sample(at, 0.0, -2.0)).is_none()));
    }
}

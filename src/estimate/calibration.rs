//! The gyroscope's bias, measured whenever the drone stands still.
//!
//! A gyroscope alone cannot tell a bias from even turning, so others have a say: turned about
//! any axis but the vertical, the accelerometer sees gravity move within the stretch; turned about
//! the vertical, the magnetometer sees the field move over some of them. What is larger than any
//! bias of the datasheet is turning. Even turning about the vertical within that limit, where no
//! magnetometer delivers, remains.

use crate::config::{CALIBRATION_LENGTH, STILL_GYRO};
use crate::math::Vec3;
use crate::sensors::{GRAVITY, ImuSample};
use crate::time::{Duration, Instant, micros, span};
use crate::units::BodyRates;

/// The largest bias of a healthy MPU6050, in rad/s: 20 deg/s (PS-MPU-6000A, table 6.1).
pub const LARGEST_BIAS: f32 = 0.35;

/// How far the specific force may be from 1 g at rest, in m/s2.
const STILL_FORCE: f32 = 1.5;

/// How far gravity may move between the halves of a stretch, in m/s2: ten deviations of the
/// chip's noise. Turned by 0.05 rad/s it moves twice as far in 0.5 s.
const STILL_GRAVITY: f32 = 0.06;

/// How far the field's direction may move between stretches, in rad: ten deviations of the chip's
/// noise. Turned by 0.05 rad/s about the vertical, where the field dips by 60 degrees, it moves as
/// far in 0.8 s.
const STILL_FIELD: f32 = 0.02;

/// After this long the field is compared with a newer one: it may drift.
const FIELD_LIFE: Duration = micros(3_000_000);

/// A sum of vectors, and of how many.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Mean {
    sum: Vec3,
    count: u16,
}

impl Mean {
    fn add(&mut self, value: Vec3) {
        self.sum += value;
        self.count = self.count.saturating_add(1);
    }

    fn and(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            count: self.count.saturating_add(other.count),
        }
    }

    fn value(self) -> Option<Vec3> {
        (self.count > 0).then(|| self.sum * (1.0 / f32::from(self.count)))
    }
}

/// Collects samples until they stayed still for long enough; any movement starts it anew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GyroCalibration {
    since: Option<Instant>,
    first: Vec3,
    rates: Mean,
    /// Of both halves of the stretch.
    force: [Mean; 2],
    field: Mean,
    /// The field that later ones are compared with.
    field_before: Option<(Instant, Vec3)>,
}

/// What calibration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest {
    /// The rates a still gyroscope reports.
    pub bias: BodyRates,
    /// The mean specific force, hence which way is up.
    pub force: Vec3,
}

/// What a sample brought to the calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Calibrating {
    /// The stretch is not over, or was not still.
    Waiting,
    /// The field moves: what passed for a bias is turning.
    Turning,
    /// A still stretch is over.
    Found(AtRest),
}

impl GyroCalibration {
    /// Takes a raw sample.
    pub fn take(&mut self, sample: &ImuSample) -> Calibrating {
        let (rates, force) = (sample.rates.0, sample.force.0);
        let since = *self.since.get_or_insert(sample.at);
        if self.rates.count == 0 {
            self.first = rates;
        }
        let still = (rates - self.first).max_norm() <= STILL_GYRO
            && (force.norm() - GRAVITY).abs() <= STILL_FORCE
            && rates.max_norm() <= LARGEST_BIAS;
        if !still {
            self.restart();
            return Calibrating::Waiting;
        }
        self.rates.add(rates);
        let age = span(since, sample.at);
        let [begun, ended] = &mut self.force;
        let half = if age * 2 < CALIBRATION_LENGTH {
            begun
        } else {
            ended
        };
        half.add(force);
        if age < CALIBRATION_LENGTH {
            return Calibrating::Waiting;
        }
        let stretch = *self;
        self.restart();
        let turning = self.field_moves(sample.at, stretch.field);
        match stretch.at_rest() {
            _ if turning => Calibrating::Turning,
            Some(found) => Calibrating::Found(found),
            None => Calibrating::Waiting,
        }
    }

    /// Takes the magnetic field, in body axes.
    pub fn take_field(&mut self, field: Vec3) {
        self.field.add(field);
    }

    fn restart(&mut self) {
        *self = Self {
            field_before: self.field_before,
            ..Self::default()
        };
    }

    /// What a stretch found, where gravity stood still too.
    fn at_rest(&self) -> Option<AtRest> {
        let [begun, ended] = self.force;
        let moved = (begun.value()? - ended.value()?).max_norm();
        let force = begun.and(ended).value()?;
        let bias = BodyRates(self.rates.value()?);
        (moved <= STILL_GRAVITY).then_some(AtRest { bias, force })
    }

    /// True where the field moved since it was seen before.
    fn field_moves(&mut self, now: Instant, field: Mean) -> bool {
        let Some(direction) = field.value().and_then(unit) else {
            return false;
        };
        match self.field_before {
            Some((at, before)) if span(at, now) < FIELD_LIFE => {
                let moves = before.cross(direction).norm() > STILL_FIELD;
                if moves {
                    self.field_before = None;
                }
                moves
            }
            _ => {
                self.field_before = Some((now, direction));
                false
            }
        }
    }
}

fn unit(vector: Vec3) -> Option<Vec3> {
    let length = vector.norm();
    (length > 1e-3).then(|| vector * (1.0 / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Quaternion;
    use crate::time::at_micros;
    use crate::units::SpecificForce;

    /// A gyroscope of this bias that turns evenly, and what it is calibrated with.
    struct Turned {
        bias: Vec3,
        rate: Vec3,
        with_field: bool,
    }

    impl Turned {
        /// What seconds of samples at 1 kHz lead to, with noise of some counts.
        fn for_seconds(&self, seconds: u32) -> Vec<Calibrating> {
            let mut calibration = GyroCalibration::default();
            let mut body = Quaternion::IDENTITY;
            let mut told = Vec::new();
            for ms in 0..seconds * 1_000 {
                let noise = (((ms.wrapping_mul(2_654_435_761)) >> 7) % 9) as f32 - 4.0;
                body = body.turned_by(self.rate * 0.001);
                let noise = Vec3::new(noise, -noise, noise);
                let sample = ImuSample {
                    at: at_micros(u64::from(ms) * 1_000),
                    rates: BodyRates(self.bias + self.rate + noise * 0.001),
                    force: SpecificForce(
                        body.to_body(Vec3::new(0.0, 0.0, -GRAVITY)) + noise * 0.01,
                    ),
                };
                if self.with_field && ms % 20 == 0 {
                    calibration.take_field(body.to_body(Vec3::new(0.2, 0.0, 0.4)) + noise * 0.001);
                }
                match calibration.take(&sample) {
                    Calibrating::Waiting => {}
                    other => told.push(other),
                }
            }
            told
        }
    }

    const STILL: Turned = Turned {
        bias: Vec3::ZERO,
        rate: Vec3::ZERO,
        with_field: true,
    };

    #[test]
    fn the_bias_is_the_mean_of_each_still_stretch() {
        let bias = Vec3::new(0.3, -0.2, 0.1);
        let told = Turned { bias, ..STILL }.for_seconds(10);
        assert!(told.len() >= 19);
        for found in told {
            let Calibrating::Found(at_rest) = found else {
                panic!("{found:?}");
            };
            assert!((at_rest.bias.0 - bias).max_norm() < 1e-3, "{at_rest:?}");
        }
    }

    #[test]
    fn even_turning_about_level_axes_is_never_taken_for_a_bias() {
        for rate in [0.05, 0.1, 0.2, 0.3, 0.49, 1.0] {
            for axis in [
                Vec3::new(1.0, 0.0, 0.0),
                Vec3::new(0.0, -1.0, 0.0),
                Vec3::new(0.5, 0.5, 0.7),
            ] {
                let turned = Turned {
                    rate: axis * rate,
                    with_field: false,
                    ..STILL
                };
                assert_eq!(turned.for_seconds(3), [], "{rate} about {axis:?}");
            }
        }
    }

    #[test]
    fn even_turning_about_the_vertical_is_noticed_by_the_field_within_two_seconds() {
        for rate in [0.05, 0.1, 0.2, 0.3] {
            let rate = Vec3::new(0.0, 0.0, rate);
            let told = Turned { rate, ..STILL }.for_seconds(2);
            assert!(told.contains(&Calibrating::Turning), "{rate:?} {told:?}");
            // What no magnetometer contradicts is not told apart from a bias.
            let told = Turned {
                rate,
                with_field: false,
                ..STILL
            }
            .for_seconds(1);
            assert!(matches!(told[..], [Calibrating::Found(_)]));
        }
        let fast = Turned {
            rate: Vec3::new(0.0, 0.0, 0.49),
            with_field: false,
            ..STILL
        };
        assert_eq!(fast.for_seconds(5), [], "no gyroscope has that much bias");
    }

    #[test]
    fn free_fall_is_no_rest() {
        let mut calibration = GyroCalibration::default();
        let falling = (0..5_000).map(|ms| ImuSample {
            at: at_micros(ms * 1_000),
            rates: BodyRates::default(),
            force: SpecificForce(Vec3::new(0.0, 0.0, -2.0)),
        });
        let mut told = falling.map(|sample| calibration.take(&sample));
        assert!(told.all(|told| told == Calibrating::Waiting));
    }
}

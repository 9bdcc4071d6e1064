//! OpenPilot's attitude: a complementary filter that learns the gyro's bias.
//!
//! The Attitude module of CopterControl, later the filter `cf` of the State Estimation module
//! (OpenPilot 15.02 and LibrePilot 16.09), in continuous time. The vector product of measured and
//! estimated gravity corrects the rate and, integrated, the bias; about the vertical the heading
//! corrects the rate, and the mean yaw rate is weakly taken for a bias.
//!
//! The original adds `AccelKp` degrees per sample, which at its 500 Hz is `0.436 / s`; here the
//! gains are per second, and the sums of the arrival stage take the place of its samples. They
//! too are of unit length sample by sample, but weighted by how far the force is from 1 g, which
//! the original does not do. Its low-pass `AccelTau` (off in 15.02) acts on both vectors alike
//! and is left out: it is 40 times faster than the correction it would smooth.

use super::Increment;
use super::attitude::turned;
use crate::math::{Quaternion, Vec3, limited};
use crate::settings::gains::openpilot::Estimate;
use crate::units::BodyRates;

/// Attitude estimate, body to Earth, and the gyroscope's bias.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OpenPilotFilter {
    attitude: Quaternion,
    /// In rad/s, within the configured limit.
    bias: Vec3,
    /// What the last step turned towards gravity and heading, in rad.
    correction: Vec3,
}

/// How an estimate turned in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turned {
    /// What the body turned, by the gyroscope without its bias, in rad.
    pub body: Vec3,
    /// What the estimate turned, corrections included, in rad.
    pub estimate: Vec3,
    /// The latter, integrated over the time, in rad s.
    pub swept: Vec3,
}

impl OpenPilotFilter {
    /// The same estimate at another attitude; what was learned stays.
    #[must_use]
    pub fn turned_to(&self, attitude: Quaternion) -> Self {
        Self { attitude, ..*self }
    }

    /// The estimate.
    #[must_use]
    pub fn attitude(&self) -> Quaternion {
        self.attitude
    }

    /// Measured rates without the bias.
    #[must_use]
    pub fn unbiased(&self, rates: BodyRates) -> BodyRates {
        BodyRates(rates.0 - self.bias)
    }

    /// The filter after this motion; one that covers no time advances nothing.
    ///
    /// `heading_error` is by how much (rad, clockwise) the estimate's heading falls short of a
    /// measured one, where there is one.
    #[must_use]
    pub fn stepped(
        &self,
        motion: &Increment,
        heading_error: Option<f32>,
        gains: &Estimate,
    ) -> Self {
        if motion.dt <= 0.0 {
            return *self;
        }
        let down = self.attitude.down_in_body();
        let error = motion.down.cross(down);
        // Slower as it gets there, to second order: a rare step that took the first error for the
        // whole of it would end beyond frequent ones.
        let slowing = 1.0 + 0.5 * gains.accel_kp * motion.down.dot(down).abs();
        let error = error * (1.0 / slowing);
        let towards_heading = gains.mag_kp * heading_error.unwrap_or(0.0) * motion.dt;
        let correction = error * gains.accel_kp + down * towards_heading;
        let angle = self.body_turn(motion);
        let unbiased = Increment { angle, ..*motion };
        Self {
            attitude: turned(self.attitude, &unbiased, correction),
            bias: self.bias_after(error, angle, gains),
            correction,
        }
    }

    /// How the estimate turned from `before` to here, in this motion.
    #[must_use]
    pub fn turned(&self, before: &Self, motion: &Increment) -> Turned {
        let body = before.body_turn(motion);
        // Bias and correction act evenly over the time.
        let even = self.correction - before.bias * motion.dt;
        Turned {
            body,
            estimate: body + self.correction,
            swept: motion.swept + even * (0.5 * motion.dt),
        }
    }

    fn body_turn(&self, motion: &Increment) -> Vec3 {
        motion.angle - self.bias * motion.dt
    }

    /// The bias after an error of gravity integrated over time (s) and a turn (rad).
    fn bias_after(&self, error: Vec3, turn: Vec3, gains: &Estimate) -> Vec3 {
        // The error in the axes halfway through the turn: the bias is of the body.
        let error = error + error.cross(turn) * 0.5;
        let learned = self.bias - error * gains.accel_ki;
        Vec3::new(
            limited(learned.x, gains.bias_limit_rad_s),
            limited(learned.y, gains.bias_limit_rad_s),
            limited(
                learned.z + turn.z * gains.yaw_bias_rate,
                gains.bias_limit_rad_s,
            ),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::openpilot::GAINS;
    use crate::math::wrapped;
    use crate::sensors::GRAVITY;
    use proptest::prelude::*;

    /// What steady turning at these measured rates sums to, gravity along `down`.
    fn turning(rates: Vec3, down: Vec3, dt: f32) -> Increment {
        Increment {
            angle: rates * dt,
            swept: rates * (0.5 * dt * dt),
            velocity: down * (-GRAVITY * dt),
            down: down * dt,
            dt,
            ..Increment::default()
        }
    }

    fn level() -> Vec3 {
        Vec3::new(0.0, 0.0, 1.0)
    }

    #[test]
    fn a_tilted_estimate_levels_while_gravity_is_seen() {
        let mut filter = OpenPilotFilter::default()
            .turned_to(Quaternion::from_up(Vec3::new(2.0, -1.0, -9.0)).expect("up"));
        for _ in 0..20_000 {
            filter = filter.stepped(&turning(Vec3::ZERO, level(), 0.001), None, &GAINS.estimate);
        }
        let down = filter.attitude().down_in_body();
        assert!((down - level()).max_norm() < 0.02, "{down:?}");
    }

    #[test]
    fn a_bias_of_the_gyroscope_is_learned() {
        let bias = Vec3::new(0.02, -0.01, 0.0);
        let mut filter = OpenPilotFilter::default();
        for _ in 0..60_000 {
            filter = filter.stepped(&turning(bias, level(), 0.05), None, &GAINS.estimate);
        }
        let left = filter.unbiased(BodyRates(bias)).0;
        assert!(left.max_norm() < 1e-3, "{left:?}");
        let down = filter.attitude().down_in_body();
        assert!((down - level()).max_norm() < 2e-3, "{down:?}");
    }

    #[test]
    fn the_mean_yaw_rate_is_weakly_taken_for_a_bias() {
        let yaw = Vec3::new(0.0, 0.0, 0.05);
        let mut filter = OpenPilotFilter::default();
        for _ in 0..100_000 {
            filter = filter.stepped(&turning(yaw, level(), 0.02), None, &GAINS.estimate);
        }
        let left = filter.unbiased(BodyRates(yaw)).0.z;
        assert!((left - 0.05 * libm::expf(-1.0)).abs() < 2e-3, "{left}");
    }

    #[test]
    fn a_measured_heading_is_followed_the_shorter_way() {
        let mut filter = OpenPilotFilter::default();
        for _ in 0..100_000 {
            let error = wrapped(-3.0 - filter.attitude().heading());
            filter = filter.stepped(
                &turning(Vec3::ZERO, level(), 0.01),
                Some(error),
                &GAINS.estimate,
            );
        }
        assert!((filter.attitude().heading() + 3.0).abs() < 1e-2);
    }

    #[test]
    fn without_time_nothing_advances() {
        let before = OpenPilotFilter::default()
            .turned_to(Quaternion::from_up(Vec3::new(2.0, -1.0, -9.0)).expect("up"));
        assert_eq!(
            before.stepped(&Increment::default(), Some(1.0), &GAINS.estimate),
            before
        );
    }

    #[test]
    fn what_it_says_to_have_turned_is_what_it_turned() {
        let before = OpenPilotFilter::default()
            .turned_to(Quaternion::from_up(Vec3::new(0.5, -0.3, -9.7)).expect("up"));
        let motion = turning(Vec3::new(0.2, 0.1, -0.1), level(), 0.05);
        let after = before.stepped(&motion, Some(0.3), &GAINS.estimate);
        let turned = after.turned(&before, &motion).estimate;
        let seen = before.attitude().error_to(after.attitude());
        assert!((seen - turned).max_norm() < 1e-4, "{seen:?} {turned:?}");
    }

    proptest! {
        #[test]
        fn rare_steps_come_to_the_same_estimate_as_frequent_ones(
            x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0,
            tilt in -0.2f32..0.2, heading in -1.0f32..1.0
        ) {
            let rates = Vec3::new(x, y, z);
            let start = OpenPilotFilter::default().turned_to(Quaternion::from_up(Vec3::new(tilt, -tilt, -9.8)).expect("up"));
            let (mut often, mut rarely) = (start, start);
            let mut body = Quaternion::IDENTITY;
            for _ in 0..40 {
                rarely = rarely.stepped(&turning(rates, body.down_in_body(), 0.05), Some(heading), &GAINS.estimate);
                for _ in 0..50 {
                    let motion = turning(rates, body.down_in_body(), 0.001);
                    often = often.stepped(&motion, Some(heading), &GAINS.estimate);
                    body = body.turned_by(rates * 0.001);
                }
            }
            let apart = often.attitude().error_to(rarely.attitude()).max_norm();
            prop_assert!(apart < 2e-4, "{}", apart);
            prop_assert!((often.bias - rarely.bias).max_norm() < 1e-4);
        }

        #[test]
        fn any_motion_leaves_a_rotation_and_a_limited_bias(
            steps in prop::collection::vec(
                (prop::array::uniform6(-50.0f32..50.0), -4.0f32..4.0, 0.0f32..0.5), 1..200
            )
        ) {
            let mut filter = OpenPilotFilter::default();
            for ([x, y, z, down_x, down_y, down_z], heading, dt) in steps {
                let down = Vec3::new(down_x, down_y, down_z) * (1.0 / 50.0);
                let motion = turning(Vec3::new(x, y, z), down, dt);
                filter = filter.stepped(&motion, Some(heading), &GAINS.estimate);
                let [w, i, j, k] = filter.attitude().to_array();
                let length = w * w + i * i + j * j + k * k;
                prop_assert!((length - 1.0).abs() < 0.05, "{}", length);
                prop_assert!(filter.bias.max_norm() <= GAINS.estimate.bias_limit_rad_s);
            }
        }
    }
}

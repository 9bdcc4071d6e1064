//! The attitude: gyroscope integrated, pulled slowly towards gravity and a heading.
//!
//! A complementary filter in the form of Mahony et al. (2008) on the sums of the arrival
//! stage, so that its result hardly depends on how often control runs.

use super::Increment;
use crate::math::{Quaternion, Vec3};

/// How fast the attitude follows its references.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrections {
    /// By the accelerometer, in 1/s.
    pub gravity: f32,
    /// By a measured heading, in 1/s.
    pub heading: f32,
}

/// Attitude estimate, body to Earth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeFilter {
    attitude: Quaternion,
}

impl AttitudeFilter {
    /// The same estimate at another attitude; what was learned stays.
    #[must_use]
    pub fn turned_to(&self, attitude: Quaternion) -> Self {
        Self { attitude }
    }

    /// The estimate.
    #[must_use]
    pub fn attitude(&self) -> Quaternion {
        self.attitude
    }

    /// The turn (rad, body axes) towards gravity and the measured heading over this motion.
    ///
    /// `heading_error` is by how much (rad, clockwise) the estimate's heading falls short of a
    /// measured one, where there is one.
    ///
    /// Towards gravity it slows down as it gets there, to second order in the motion's length: a
    /// rare step that took the first error for the whole of it would end beyond frequent ones.
    #[must_use]
    pub fn correction(
        &self,
        motion: &Increment,
        heading_error: Option<f32>,
        speed: &Corrections,
    ) -> Vec3 {
        let down = self.attitude.down_in_body();
        // Seen the wrong way round, down must not turn this into a division by zero.
        let slowing = 1.0 + 0.5 * speed.gravity * motion.down.dot(down).abs();
        let towards_gravity = motion.down.cross(down) * (speed.gravity / slowing);
        let towards_heading = speed.heading * heading_error.unwrap_or(0.0) * motion.dt;
        towards_gravity + down * towards_heading
    }

    /// The filter after the motion since the last step; see [`Self::correction`].
    #[must_use]
    pub fn stepped(
        &self,
        motion: &Increment,
        heading_error: Option<f32>,
        speed: &Corrections,
    ) -> Self {
        self.after(motion, self.correction(motion, heading_error, speed))
    }

    /// The filter after the motion since the last step, and this correction.
    ///
    /// Motion that covers no time advances nothing.
    #[must_use]
    pub fn after(&self, motion: &Increment, correction: Vec3) -> Self {
        if motion.dt <= 0.0 {
            return *self;
        }
        Self {
            attitude: turned(self.attitude, motion, correction),
        }
    }
}

/// First the correction, in the axes that the sums began with, then the motion.
pub(super) fn turned(attitude: Quaternion, motion: &Increment, correction: Vec3) -> Quaternion {
    let turn = motion.angle + motion.coning;
    let turn = turn + correction + correction.cross(turn) * 0.5;
    in_small_turns(attitude, turn)
}

/// Turns in steps that the small-angle formula is exact for.
#[must_use]
pub fn in_small_turns(attitude: Quaternion, turn: Vec3) -> Quaternion {
    const LARGEST: f32 = 0.25;
    const MOST: u8 = 16;
    let size = turn.max_norm();
    if size <= LARGEST {
        return attitude.turned_by(turn);
    }
    let parts = libm::ceilf(size / LARGEST).min(f32::from(MOST));
    let part = turn * (1.0 / parts);
    (0..parts as u8).fold(attitude, |attitude, _| attitude.turned_by(part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cascade::GAINS;
    use crate::math::wrapped;
    use crate::sensors::GRAVITY;
    use proptest::prelude::*;

    const SPEED: Corrections = Corrections {
        gravity: GAINS.estimate.accel_correction,
        heading: GAINS.estimate.heading_correction,
    };

    fn still(dt: f32) -> Increment {
        Increment {
            angle: Vec3::ZERO,
            coning: Vec3::ZERO,
            swept: Vec3::ZERO,
            velocity: Vec3::new(0.0, 0.0, -GRAVITY) * dt,
            down: Vec3::new(0.0, 0.0, 1.0) * dt,
            dt,
        }
    }

    fn turning(rate: Vec3, dt: f32) -> Increment {
        Increment {
            angle: rate * dt,
            dt,
            ..Increment::default()
        }
    }

    #[test]
    fn a_tilted_estimate_levels_while_gravity_is_seen() {
        let mut filter = AttitudeFilter::default();
        filter = filter.turned_to(Quaternion::from_up(Vec3::new(2.0, -1.0, -9.0)).expect("up"));
        for _ in 0..20_000 {
            filter = filter.stepped(&still(0.001), None, &SPEED);
        }
        let down = filter.attitude().down_in_body();
        assert!(
            (down - Vec3::new(0.0, 0.0, 1.0)).max_norm() < 2e-3,
            "{down:?}"
        );
    }

    #[test]
    fn down_seen_upside_down_leaves_an_attitude() {
        let mut filter = AttitudeFilter::default();
        let upside_down = Increment {
            down: Vec3::new(0.01, 0.0, -2.0 / SPEED.gravity),
            ..still(1.0)
        };
        filter = filter.stepped(&upside_down, None, &SPEED);
        assert!(filter.attitude().down_in_body().norm() > 0.9);
    }

    #[test]
    fn a_measured_heading_is_followed_the_shorter_way() {
        let mut filter = AttitudeFilter::default();
        for _ in 0..100_000 {
            let error = wrapped(-3.0 - filter.attitude().heading());
            filter = filter.stepped(&still(0.001), Some(error), &SPEED);
        }
        assert!((filter.attitude().heading() + 3.0).abs() < 1e-2);
    }

    #[test]
    fn without_time_nothing_advances() {
        let mut filter = AttitudeFilter::default();
        filter = filter.turned_to(Quaternion::from_up(Vec3::new(2.0, -1.0, -9.0)).expect("up"));
        let before = filter;
        filter = filter.stepped(&Increment::default(), Some(1.0), &SPEED);
        assert_eq!(filter, before);
    }

    proptest! {
        #[test]
        fn a_rare_step_levels_as_far_as_frequent_ones(x in -4.0f32..4.0, y in -4.0f32..4.0) {
            let (mut often, mut rarely) = (AttitudeFilter::default(), AttitudeFilter::default());
            often = often.turned_to(Quaternion::from_up(Vec3::new(x, y, -9.0)).expect("up"));
            rarely = rarely.turned_to(Quaternion::from_up(Vec3::new(x, y, -9.0)).expect("up"));
            let tilt = rarely.attitude().down_in_body();
            for _ in 0..100 {
                often = often.stepped(&still(0.001), None, &SPEED);
            }
            rarely = rarely.stepped(&still(0.1), None, &SPEED);
            let apart = often.attitude().error_to(rarely.attitude()).max_norm();
            let far = tilt.cross(Vec3::new(0.0, 0.0, 1.0)).norm();
            prop_assert!(apart < 1e-4 * far + 1e-6, "{apart} of {far}");
        }

        #[test]
        fn rare_steps_come_to_the_same_attitude_as_frequent_ones(
            x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0
        ) {
            let (mut often, mut rarely) = (AttitudeFilter::default(), AttitudeFilter::default());
            let rate = Vec3::new(x, y, z);
            for _ in 0..50 {
                for _ in 0..10 {
                    often = often.stepped(&turning(rate, 0.001), None, &SPEED);
                }
                rarely = rarely.stepped(&turning(rate, 0.01), None, &SPEED);
            }
            prop_assert!(often.attitude().error_to(rarely.attitude()).max_norm() < 1e-3);
        }
    }
}

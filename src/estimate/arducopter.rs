//! ArduCopter's estimate: a gyroscope whose drift gravity and compass correct.
//!
//! In the spirit of AP_AHRS_DCM: the accelerometer corrects the tilt and the magnetometer the
//! heading, in proportion at once and by an integral that stands for the gyroscope's drift.
//! Where the original averages force over 0.2 s to see through vibration, the arrival stage has
//! summed its direction over every sample. A quaternion stands for the matrix.

use super::Increment;
use super::attitude::turned;
use crate::math::{Quaternion, Vec3, between};
use crate::settings::gains::arducopter::Estimate;

/// Below this rate (rad/s, 20 deg/s) drift is learned.
///
/// Faster, an error of the gyroscope's scale would pass for it.
const DRIFT_SPIN: f32 = 0.349;
/// From this rate (rad/s, 50 deg/s) on corrections grow with it, up to ten times.
///
/// Turning integrates the errors of scale and alignment.
const SLOW_SPIN: f32 = 0.873;
/// Time constant (s) of the spin that is judged: the original looks at it every 0.2 s.
///
/// Judged by the mean rate since the last run, a shake would be fast or slow by how long that is.
const SPIN_TIME: f32 = 0.2;
/// The fastest rates that are believed, in rad/s: 2000 deg/s, the range of gyroscopes on drones.
const FASTEST: Vec3 = Vec3::new(35.0, 35.0, 35.0);
/// The most drift that is believed, in rad/s: more was taken out at rest.
const MOST_DRIFT: Vec3 = Vec3::new(0.1, 0.1, 0.1);

/// For how long (s) drift is learned before it counts.
///
/// A change is limited by the time that it took: judged over less, noise would reach the limit,
/// and what is learned would depend on how often control runs.
const DRIFT_WINDOW: f32 = 5.0;

/// Attitude, body to Earth, and what the gyroscope lacks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriftFilter {
    attitude: Quaternion,
    /// To be added to the rates, in rad/s.
    drift: Vec3,
    /// Low-passed rates, in rad/s.
    rates: Vec3,
    /// By how much the drift seems to have changed in the window, in rad/s.
    learned: Vec3,
    /// How much of the window is over, in s.
    learning: f32,
    /// The turn (rad) that the last step put right, in the axes that it began with.
    correction: Vec3,
}

impl DriftFilter {
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

    /// The turn (rad, body axes) that corrected the last step, beside the motion.
    #[must_use]
    pub fn correction(&self) -> Vec3 {
        self.correction
    }

    /// The filter after the motion since the last run; without time it is as it was.
    ///
    /// `heading_error` is by how much (rad, clockwise) the heading falls short of a measured
    /// one, where there is one.
    #[must_use]
    pub fn after(&self, motion: &Increment, heading_error: Option<f32>, gains: &Estimate) -> Self {
        if motion.dt <= 0.0 {
            return *self;
        }
        let down = self.attitude.down_in_body();
        let heading = down * (heading_error.unwrap_or(0.0) * motion.dt);
        let rates = self.rates_after(motion);
        let spins = [self.rates.norm(), rates.norm()];
        let pull = 0.5 * spins.iter().map(|&spin| pull(spin)).sum::<f32>();
        // The error shrinks as it is corrected, by half of that in the mean. Down may also be
        // seen the wrong way round, which must not turn this into a division by zero.
        let slowing = 1.0 + 0.5 * gains.tilt_p * pull * motion.down.dot(down).abs();
        let tilt = motion.down.cross(down) * (1.0 / slowing);
        let correction = (tilt * gains.tilt_p + heading * gains.heading_p) * pull;
        let correction = correction + self.drift * motion.dt;
        let step = tilt * gains.tilt_i + heading * gains.heading_i;
        Self {
            attitude: turned(self.attitude, motion, correction),
            rates,
            correction,
            ..self.learned(step, motion.dt, slow_share(spins), gains)
        }
    }

    /// The low-passed rates after this motion.
    fn rates_after(&self, motion: &Increment) -> Vec3 {
        let kept = libm::expf(motion.dt * (-1.0 / SPIN_TIME));
        let mean = motion.angle * (1.0 / motion.dt);
        (mean + (self.rates - mean) * kept).limited(FASTEST)
    }

    /// What is known of the drift after `dt` (s) in which it seemed to change by `step` (rad/s).
    ///
    /// Of both this `share` counts.
    fn learned(&self, step: Vec3, dt: f32, share: f32, gains: &Estimate) -> Self {
        let counted = dt * share;
        let left = DRIFT_WINDOW - self.learning;
        if counted < left {
            return Self {
                learned: self.learned + step * share,
                learning: self.learning + counted,
                ..*self
            };
        }
        // What is behind the window's end belongs to the next one, however long the step.
        let within = step * (left / dt);
        let most = gains.drift_limit_rad_s2 * DRIFT_WINDOW;
        let change = (self.learned + within).limited(Vec3::new(most, most, most));
        Self {
            drift: (self.drift + change).limited(MOST_DRIFT),
            learned: step * share - within,
            learning: counted - left,
            ..*self
        }
    }
}

/// How much corrections grow with a spin (rad/s).
fn pull(spin: f32) -> f32 {
    between(spin * (1.0 / SLOW_SPIN), 1.0, 10.0)
}

/// The share of a stretch in which a spin (rad/s), from its start to its end, lets drift be learned.
fn slow_share([start, end]: [f32; 2]) -> f32 {
    let (least, most) = (start.min(end), start.max(end));
    // Two spins that differ by nothing are both slow or both fast.
    between((DRIFT_SPIN - least) / (most - least).max(1e-6), 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::arducopter::GAINS;
    use crate::math::wrapped;
    use proptest::prelude::*;

    fn still(dt: f32) -> Increment {
        Increment {
            down: Vec3::new(0.0, 0.0, 1.0) * dt,
            dt,
            ..Increment::default()
        }
    }

    #[test]
    fn a_tilted_estimate_levels_while_gravity_is_seen() {
        let mut filter = DriftFilter::default()
            .turned_to(Quaternion::from_up(Vec3::new(2.0, -1.0, -9.0)).expect("up"));
        for _ in 0..1000 {
            filter = filter.after(&still(0.05), None, &GAINS.estimate);
        }
        let down = filter.attitude().down_in_body();
        assert!(
            (down - Vec3::new(0.0, 0.0, 1.0)).max_norm() < 0.01,
            "{down:?}"
        );
    }

    #[test]
    fn a_measured_heading_is_followed_the_shorter_way() {
        let mut filter = DriftFilter::default();
        for _ in 0..4000 {
            let error = wrapped(-3.0 - filter.attitude().heading());
            filter = filter.after(&still(0.05), Some(error), &GAINS.estimate);
        }
        assert!((filter.attitude().heading() + 3.0).abs() < 0.02);
    }

    #[test]
    fn a_biased_gyroscope_is_found_out_within_minutes() {
        let (bias, dt) = (0.01, 0.05);
        let mut filter = DriftFilter::default();
        let motion = Increment {
            angle: Vec3::new(bias * dt, 0.0, 0.0),
            ..still(dt)
        };
        for _ in 0..(400.0 / dt) as u32 {
            filter = filter.after(&motion, None, &GAINS.estimate);
        }
        assert!((filter.drift.x + bias).abs() < 0.002, "{filter:?}");
        assert!(filter.attitude().down_in_body().y.abs() < 0.02);
    }

    #[test]
    fn without_time_nothing_advances() {
        let filter = DriftFilter::default()
            .turned_to(Quaternion::from_up(Vec3::new(2.0, -1.0, -9.0)).expect("up"));
        assert_eq!(
            filter.after(&Increment::default(), Some(1.0), &GAINS.estimate),
            filter
        );
    }

    proptest! {
        #[test]
        fn a_rare_step_levels_as_far_as_frequent_ones(x in -4.0f32..4.0, y in -4.0f32..4.0) {
            let begun = DriftFilter::default().turned_to(Quaternion::from_up(Vec3::new(x, y, -9.0)).expect("up"));
            let often = (0..100).fold(begun, |filter, _| filter.after(&still(0.001), None, &GAINS.estimate));
            let rarely = begun.after(&still(0.1), None, &GAINS.estimate);
            let apart = often.attitude().error_to(rarely.attitude()).max_norm();
            prop_assert!(apart < 2e-5, "{apart}");
            prop_assert!((often.drift - rarely.drift).max_norm() < 1e-5);
        }

        #[test]
        fn rare_steps_come_to_the_same_as_frequent_ones(
            x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0, heading in -0.5f32..0.5
        ) {
            let rate = Vec3::new(x, y, z);
            let mut often = DriftFilter::default();
            let mut rarely = often;
            let turning = |dt: f32| Increment { angle: rate * dt, dt, ..Increment::default() };
            for _ in 0..20 {
                for _ in 0..50 {
                    often = often.after(&turning(0.001), Some(heading), &GAINS.estimate);
                }
                rarely = rarely.after(&turning(0.05), Some(heading), &GAINS.estimate);
            }
            prop_assert!(often.attitude().error_to(rarely.attitude()).max_norm() < 5e-3);
            prop_assert!((often.drift - rarely.drift).max_norm() < 1e-5);
        }

        #[test]
        fn noise_in_gravity_teaches_rare_steps_the_drift_of_frequent_ones(
            lean in -0.02f32..0.02, noise in 0.0f32..0.5, shake in 0.0f32..1.0
        ) {
            let (mut often, mut rarely) = (DriftFilter::default(), DriftFilter::default());
            for _ in 0..300 {
                let mut sum = Increment::default();
                for sample in 0..50u8 {
                    let sign = if sample % 2 == 0 { 1.0 } else { -1.0 };
                    let motion = Increment {
                        angle: Vec3::new(shake * sign, 0.0, 0.0) * 0.001,
                        down: Vec3::new(0.0, lean + noise * sign, 1.0) * 0.001,
                        dt: 0.001,
                        ..Increment::default()
                    };
                    often = often.after(&motion, None, &GAINS.estimate);
                    sum.angle += motion.angle;
                    sum.down += motion.down;
                    sum.dt += motion.dt;
                }
                rarely = rarely.after(&sum, None, &GAINS.estimate);
            }
            prop_assert!((often.drift - rarely.drift).max_norm() < 2e-5, "{often:?} {rarely:?}");
        }

        #[test]
        fn attitude_and_drift_stay_finite_on_any_motion(
            steps in prop::collection::vec(
                (prop::array::uniform3(-40.0f32..40.0), -4.0f32..4.0, 0.0f32..0.2), 1..50)
        ) {
            let mut filter = DriftFilter::default();
            for ([x, y, z], heading, dt) in steps {
                let rate = Vec3::new(x, y, z);
                let motion = Increment { angle: rate * dt, down: rate * (dt / 70.0), dt, ..Increment::default() };
                filter = filter.after(&motion, Some(heading), &GAINS.estimate);
                let [w, i, j, k] = filter.attitude().to_array();
                prop_assert!((w * w + i * i + j * j + k * k - 1.0).abs() < 1e-3);
                prop_assert!(filter.drift.max_norm() <= MOST_DRIFT.x);
            }
        }
    }
}

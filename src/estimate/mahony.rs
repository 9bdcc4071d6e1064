//! The attitude as Cleanflight estimates it: Mahony's filter, fast at the start.
//!
//! After `imuMahonyAHRSupdate` of Cleanflight 1.13 (`src/main/flight/imu.c`), on the sums of the
//! arrival stage instead of at every loop. What differs, and why:
//!
//! - A correction of gain `k` over a time `t` closes the share `1 - exp(-k t)` of an error, here
//!   `k t / (1 + k t / 2)`, which is that within `(k t)^3 / 12`: a run after 0.1 s corrects what a
//!   hundred loops do.
//! - The original takes an accelerometer between 0.9 and 1.1 g as it is and any other not at all.
//!   In place of that gate stands the trust that the arrival stage gives each sample, from one at
//!   1 g, over 0.8 where the gate was, to none 0.5 g off. Its sums enter linearly: a gate on
//!   their mean would let pass or lose a whole run, by how long that happened to be.
//! - The magnetometer comes as an error of the heading. In the original the horizontal share of
//!   the field enters twice, as the sine of the error between two vectors of that length.
//! - "Not armed" is read as "no thrust is asked for".

use super::attitude::turned;
use super::{Increment, LARGEST_BIAS};
use crate::math::{Quaternion, Vec3, limited, sin_cos, wrapped};
use crate::settings::gains::cleanflight::Estimate;

/// What shows the estimate's errors, beside the motion itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    /// By how much (rad, clockwise) the heading falls short of a measured one.
    pub heading_error: Option<f32>,
    /// No thrust is asked for: the drone stands, and gravity shows without doubt.
    pub standing: bool,
}

/// Attitude estimate, body to Earth, and the gyroscope's bias.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MahonyFilter {
    attitude: Quaternion,
    /// Taken off the rates, so of the opposite sign as the bias; rad/s.
    feedback: Vec3,
    /// The turn (rad) that the last step put right, in the axes that it began with.
    correction: Vec3,
    /// Down in those axes, as estimated then.
    down: Vec3,
    /// Time since the start in s, counted as long as it matters.
    age: f32,
}

impl MahonyFilter {
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

    /// Down in body axes, as estimated where the last step began.
    #[must_use]
    pub fn down_before(&self) -> Vec3 {
        self.down
    }

    /// The estimate after the motion since the last run; `dt` of zero advances nothing.
    #[must_use]
    pub fn after(&self, motion: &Increment, evidence: Evidence, gains: &Estimate) -> Self {
        let dt = motion.dt;
        if dt <= 0.0 {
            return *self;
        }
        let down = self.attitude.down_in_body();
        let [tilt, heading] = errors(down, motion, evidence.heading_error, gains);
        let feedback = self.learned(tilt + heading, motion, gains);
        let fast = evidence.standing && self.age < gains.fast_s;
        let gain = gains.dcm_kp * if fast { gains.fast_factor } else { 1.0 };
        // The tilt's error shrinks as it is corrected, a measured error of the heading stands.
        // Seen the wrong way round, down must not turn this into a division by zero.
        let seen = motion.down.dot(down).abs();
        let shrunk = 1.0 / (1.0 + 0.5 * gain * seen);
        let correction = (tilt * shrunk + heading) * gain + feedback * dt;
        let attitude = turned(self.attitude, motion, correction);
        Self {
            // Past a turn that the polynomials can take, the old attitude is the better guess.
            attitude: Quaternion::from_array(attitude.to_array()).unwrap_or(self.attitude),
            feedback,
            correction,
            down,
            age: (self.age + dt).min(gains.fast_s),
        }
    }

    /// The integral feedback after this motion, and an error (rad s) integrated over it.
    fn learned(&self, error: Vec3, motion: &Increment, gains: &Estimate) -> Vec3 {
        let spinning = motion.angle.norm() >= gains.spin_limit_rad_s * motion.dt;
        if gains.dcm_ki <= 0.0 || spinning {
            return self.feedback;
        }
        let most = Vec3::new(LARGEST_BIAS, LARGEST_BIAS, LARGEST_BIAS);
        (self.feedback + error * gains.dcm_ki).limited(most)
    }
}

/// The turns that gravity and the magnetometer ask for where `down` is estimated there.
///
/// As sines in body axes, integrated over the motion, in rad s.
fn errors(
    down: Vec3,
    motion: &Increment,
    heading_error: Option<f32>,
    gains: &Estimate,
) -> [Vec3; 2] {
    let share = gains.horizontal_field * gains.horizontal_field;
    let off = sin_cos(wrapped(heading_error.unwrap_or(0.0))).0;
    let towards_heading = down * (share * limited(off, 1.0) * motion.dt);
    [motion.down.cross(down), towards_heading]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cleanflight::GAINS;
    use proptest::prelude::*;

    const FLYING: Evidence = Evidence {
        heading_error: None,
        standing: false,
    };

    /// At rest and level, as the arrival stage sums it with this trust.
    fn still(trust: f32, dt: f32) -> Increment {
        Increment {
            down: Vec3::new(0.0, 0.0, trust) * dt,
            dt,
            ..Increment::default()
        }
    }

    fn tilted() -> MahonyFilter {
        MahonyFilter::default()
            .turned_to(Quaternion::from_up(Vec3::new(2.0, -1.0, -9.0)).expect("up"))
    }

    /// How far from level the estimate is.
    fn tilt(filter: &MahonyFilter) -> f32 {
        let down = filter.attitude().down_in_body();
        Vec3::new(down.x, down.y, 0.0).norm()
    }

    fn run(mut filter: MahonyFilter, runs: u32, motion: Increment, see: Evidence) -> MahonyFilter {
        for _ in 0..runs {
            filter = filter.after(&motion, see, &GAINS.estimate);
        }
        filter
    }

    #[test]
    fn a_tilted_estimate_levels_at_the_published_gain() {
        let start = tilted();
        let after = run(start, 4_000, still(1.0, 0.001), FLYING);
        let expected = libm::expf(-4.0 * GAINS.estimate.dcm_kp);
        assert!((tilt(&after) / tilt(&start) - expected).abs() < 0.01);
    }

    #[test]
    fn half_the_trust_levels_half_as_fast() {
        let after = run(tilted(), 1000, still(0.5, 0.001), FLYING);
        let trusted = run(tilted(), 500, still(1.0, 0.001), FLYING);
        assert!((tilt(&after) - tilt(&trusted)).abs() < 1e-4);
        let blind = run(tilted(), 1000, still(0.0, 0.001), FLYING);
        assert!((tilt(&blind) - tilt(&tilted())).abs() < 1e-4);
    }

    #[test]
    fn rare_steps_correct_as_much_while_trust_comes_and_goes() {
        let mut often = tilted();
        let mut rarely = tilted();
        for _ in 0..20 {
            let mut seen = Increment::default();
            for sample in 0..50 {
                let trust = if sample % 3 == 0 { 1.0 } else { 0.4 };
                let motion = still(trust, 0.001);
                often = often.after(&motion, FLYING, &GAINS.estimate);
                seen.down += motion.down;
                seen.dt += motion.dt;
            }
            rarely = rarely.after(&seen, FLYING, &GAINS.estimate);
        }
        let apart = often.attitude.error_to(rarely.attitude).max_norm();
        assert!(apart < 1e-4, "{apart}");
    }

    #[test]
    fn just_started_and_without_thrust_it_levels_faster_but_not_for_ever() {
        let standing = Evidence {
            standing: true,
            ..FLYING
        };
        let fast = run(tilted(), 500, still(1.0, 0.001), standing);
        let slow = run(tilted(), 500, still(1.0, 0.001), FLYING);
        assert!(tilt(&fast) < 0.5 * tilt(&slow));
        let mut old = run(tilted(), 2001, still(0.0, 0.01), standing);
        old.attitude = tilted().attitude;
        let late = run(old, 500, still(1.0, 0.001), standing);
        assert!((tilt(&late) - tilt(&slow)).abs() < 1e-4);
    }

    #[test]
    fn a_measured_heading_is_followed_the_shorter_way() {
        let mut filter = MahonyFilter::default();
        for _ in 0..20_000 {
            let error = wrapped(-2.5 - filter.attitude().heading());
            let see = Evidence {
                heading_error: Some(error),
                standing: false,
            };
            filter = filter.after(&still(1.0, 0.01), see, &GAINS.estimate);
        }
        assert!((filter.attitude().heading() + 2.5).abs() < 1e-2);
        assert!(tilt(&filter) < 1e-3);
    }

    #[test]
    fn without_time_nothing_advances() {
        let see = Evidence {
            heading_error: Some(1.0),
            standing: true,
        };
        assert_eq!(
            tilted().after(&Increment::default(), see, &GAINS.estimate),
            tilted()
        );
    }

    proptest! {
        #[test]
        fn rare_steps_come_to_the_same_attitude_as_frequent_ones(
            x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0
        ) {
            let angle = |dt| Vec3::new(x, y, z) * dt;
            let turning = |dt| Increment { angle: angle(dt), dt, ..Increment::default() };
            let often = run(tilted(), 300, turning(0.001), FLYING);
            let rarely = run(tilted(), 6, turning(0.05), FLYING);
            prop_assert!(often.attitude.error_to(rarely.attitude).max_norm() < 1e-3);
        }

        #[test]
        fn rare_steps_correct_as_much_as_frequent_ones(
            heading in -1.5f32..1.5, standing in any::<bool>()
        ) {
            let see = Evidence { heading_error: Some(heading), standing };
            let often = run(tilted(), 300, still(1.0, 0.001), see);
            let rarely = run(tilted(), 6, still(1.0, 0.05), see);
            prop_assert!(often.attitude.error_to(rarely.attitude).max_norm() < 1e-3);
        }

        #[test]
        fn the_attitude_stays_a_rotation_whatever_comes(
            motions in prop::collection::vec(
                (any::<f32>(), any::<f32>(), any::<f32>(), 0.0f32..1.0), 1..50)
        ) {
            let mut filter = MahonyFilter::default();
            for (angle, down, heading, dt) in motions {
                let motion = Increment {
                    angle: Vec3::new(angle, 0.5 * angle, -angle),
                    down: Vec3::new(limited(down, dt), 0.0, dt),
                    dt,
                    ..Increment::default()
                };
                let see = Evidence { heading_error: Some(heading), standing: true };
                filter = filter.after(&motion, see, &GAINS.estimate);
                let length: f32 = filter.attitude.to_array().iter().map(|part| part * part).sum();
                prop_assert!((length - 1.0).abs() < 1e-3, "{filter:?}");
                prop_assert!(filter.feedback.max_norm() <= LARGEST_BIAS);
            }
        }
    }
}

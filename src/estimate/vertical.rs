//! Gravity as both inertial sensors see it: drift, and contradiction.
//!
//! Slower than any estimator that flies, so that manoeuvres average out: in flight an
//! accelerometer feels the propellers' push, which is vertical only in the mean. What the two
//! disagree by, integrated, is the gyroscope's drift since it was calibrated; it is taken off the
//! rates for every control logic. What remains of it after drift is learned as fast as it can be is a
//! contradiction: one of the two is wrong, and two cannot say which.

use super::attitude::in_small_turns;
use super::{AttitudeFilter, Corrections, Increment};
use crate::math::Vec3;

/// How fast the vertical follows the accelerometer, in 1/s, and the heading nothing.
const SPEED: Corrections = Corrections {
    gravity: 0.1,
    heading: 0.0,
};
/// Drift learned (rad/s) from an error (rad) in a second: damped critically, 20 s.
const LEARNING: f32 = 0.25 * SPEED.gravity * SPEED.gravity;
/// The same from an error of the heading, which estimators follow as fast.
const LEARNING_HEADING: f32 = LEARNING;
/// The most drift since calibration that is learned, in rad/s: warm-up takes half of the datasheet's
/// range over temperature at the worst.
const MOST: Vec3 = Vec3::new(0.17, 0.17, 0.17);
/// Time constant (s) over which errors are averaged before they contradict.
const AVERAGED: f32 = 2.0;
/// The mean error (rad) that contradicts: 37 degrees.
const CONTRADICTS: f32 = 0.65;

/// Time constant (s) over which a vertical speed is forgotten: an accelerometer that is off by
/// 0.05 m/s2 then shows 1 m/s at most.
const FORGETTING: f32 = 20.0;

/// The vertical, the gyroscope's drift since its bias was measured, and how fast the body sinks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vertical {
    filter: AttitudeFilter,
    /// To be taken off the rates, in rad/s.
    drift: Vec3,
    /// Mean sine of the angle between both verticals.
    off: f32,
    /// Gravity as the accelerometer showed it at rest, in m/s2.
    gravity: f32,
    /// In m/s.
    sinking: f32,
}

impl Vertical {
    /// Starts from a mean specific force at rest, without drift.
    #[must_use]
    pub fn at_rest(&self, force: Vec3) -> Self {
        let attitude = self.filter.attitude().levelled(force);
        Self {
            filter: attitude.map_or(self.filter, |attitude| self.filter.turned_to(attitude)),
            gravity: force.norm(),
            ..Self::default()
        }
    }

    /// The same behind a turn (rad) that no sample saw.
    #[must_use]
    pub fn turned_by(&self, turn: Vec3) -> Self {
        let attitude = in_small_turns(self.filter.attitude(), turn);
        Self {
            filter: self.filter.turned_to(attitude),
            ..*self
        }
    }

    /// The drift to take off the rates, in rad/s.
    #[must_use]
    pub fn drift(&self) -> Vec3 {
        self.drift
    }

    /// Down in body axes, of length 1.
    #[must_use]
    pub fn down(&self) -> Vec3 {
        self.filter.attitude().down_in_body()
    }

    /// How fast the body sinks, in m/s, by what it felt since it stood; forgotten over 20 s.
    #[must_use]
    pub fn sinking(&self) -> f32 {
        self.sinking
    }

    /// True where gyroscope and accelerometer contradict each other.
    #[must_use]
    pub fn is_contradicted(&self) -> bool {
        self.off > CONTRADICTS
    }

    /// After a motion whose drift, as far as it was known, is taken off.
    ///
    /// `heading_error` is that of the estimator that flies, in rad.
    #[must_use]
    pub fn after(&self, motion: &Increment, heading_error: Option<f32>) -> Self {
        let dt = motion.dt;
        if dt <= 0.0 {
            return *self;
        }
        let down = self.down();
        let error = motion.down.cross(down);
        let seen = motion.down.norm();
        let heading = down * (heading_error.unwrap_or(0.0) * dt);
        let step = error * LEARNING + heading * LEARNING_HEADING;
        let share = dt * (1.0 / (AVERAGED + dt));
        // Seen the wrong way round, the sine is small though the error is not.
        let off = if motion.down.dot(down) < 0.0 {
            seen
        } else {
            error.norm()
        } / dt;
        Self {
            filter: self.filter.stepped(motion, None, &SPEED),
            drift: (self.drift - step).limited(MOST),
            off: self.off + (off - self.off) * share,
            gravity: self.gravity,
            sinking: (self.sinking + down.dot(motion.velocity) + self.gravity * dt)
                * (1.0 - dt * (1.0 / (FORGETTING + dt))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A level body that stands, seen by a gyroscope of this bias, for a time (s).
    fn after(bias: Vec3, seconds: u32, runs_hz: u32) -> Vertical {
        let dt = 1.0 / runs_hz as f32;
        (0..seconds * runs_hz).fold(Vertical::default(), |vertical, _| {
            let motion = Increment {
                angle: (bias - vertical.drift()) * dt,
                down: Vec3::new(0.0, 0.0, dt),
                dt,
                ..Increment::default()
            };
            vertical.after(&motion, None)
        })
    }

    #[test]
    fn a_bias_is_learned_within_a_minute_and_a_half_however_often_control_runs() {
        for runs_hz in [1_000, 50, 10] {
            let vertical = after(Vec3::new(0.05, -0.1, 0.0), 90, runs_hz);
            let left = Vec3::new(0.05, -0.1, 0.0) - vertical.drift();
            assert!(left.max_norm() < 0.01, "{runs_hz} {vertical:?}");
            assert!(!vertical.is_contradicted());
        }
    }

    #[test]
    fn a_sudden_bias_contradicts_within_ten_seconds_and_usual_drift_never() {
        assert!(after(Vec3::new(0.2, 0.0, 0.0), 10, 100).is_contradicted());
        for seconds in 1..60 {
            assert!(!after(Vec3::new(0.05, 0.0, 0.0), seconds, 100).is_contradicted());
        }
    }

    #[test]
    fn what_is_upside_down_contradicts_though_both_are_in_line() {
        let mut vertical = Vertical::default();
        for _ in 0..1_000 {
            let motion = Increment {
                down: Vec3::new(0.0, 0.0, -0.01),
                dt: 0.01,
                ..Increment::default()
            };
            vertical = vertical.after(&motion, None);
        }
        assert!(vertical.is_contradicted());
    }

    #[test]
    fn a_steady_error_of_the_heading_is_drift_about_the_vertical() {
        let mut vertical = Vertical::default();
        let mut heading = 0.0;
        for _ in 0..20_000 {
            heading += (0.03 - vertical.drift().z - 0.1 * heading) * 0.01;
            let motion = Increment {
                down: Vec3::new(0.0, 0.0, 0.01),
                dt: 0.01,
                ..Increment::default()
            };
            vertical = vertical.after(&motion, Some(-heading));
        }
        assert!((vertical.drift().z - 0.03).abs() < 2e-3, "{vertical:?}");
    }
}

//! An error and its limits over a stretch of time between rare runs.
//!
//! Known are its start, its end and its integral. Steps of a millisecond would see it pass zero
//! or a limit in between; these forms do so in closed form.

use crate::math::{Vec3, limited};

/// An error over a stretch of time, about each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorStretch {
    /// At its start.
    pub start: Vec3,
    /// At its end.
    pub end: Vec3,
    /// Its mean over the time.
    pub mean: Vec3,
    /// Length in s.
    pub dt: f32,
}

impl ErrorStretch {
    /// Of an error whose course is known by a turn (rad), and that turn swept.
    ///
    /// It falls with the turn about the `axes` that count (1, others 0). What is left grows from
    /// nothing and enters with a third of its end, as of a parabola.
    #[must_use]
    pub fn of_turn([start, end]: [Vec3; 2], [turn, swept]: [Vec3; 2], axes: Vec3, dt: f32) -> Self {
        let beside = end - start + turn.scale(axes);
        let fallen = swept.scale(axes) * (1.0 / dt.max(1e-6));
        Self {
            start,
            end,
            mean: start - fallen + beside * (1.0 / 3.0),
            dt,
        }
    }

    /// The error integrated from start to end, where it passes zero in two parts.
    #[must_use]
    pub fn parts(&self) -> [Vec3; 2] {
        let part = |start: f32, end: f32, mean: f32| {
            let whole = mean * self.dt;
            if start * end < 0.0 {
                let first = 0.5 * start * (start / (start - end)) * self.dt;
                (first, whole - first)
            } else {
                (whole, 0.0)
            }
        };
        let (start, end, mean) = (self.start, self.end, self.mean);
        let x = part(start.x, end.x, mean.x);
        let y = part(start.y, end.y, mean.y);
        let z = part(start.z, end.z, mean.z);
        [Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1)]
    }

    /// An integral after both parts times a gain, within a limit after each.
    #[must_use]
    pub fn integrated(&self, before: Vec3, gain: Vec3, limit: Vec3) -> Vec3 {
        let [first, second] = self.parts();
        let grown = (before + first.scale(gain)).limited(limit);
        (grown + second.scale(gain)).limited(limit)
    }
}

/// The mean of a value over a stretch, where it is held within a limit.
///
/// Without the limit it would go from `start` to `end` with this `mean`; where it passes the
/// limit, in a straight line.
#[must_use]
pub fn mean_limited([start, end]: [f32; 2], mean: f32, limit: f32) -> f32 {
    if start.abs() <= limit && end.abs() <= limit {
        return limited(mean, limit);
    }
    let change = end - start;
    if change.abs() < 1e-3 * limit {
        return limited(0.5 * (start + end), limit);
    }
    limited((area(end, limit) - area(start, limit)) / change, limit)
}

/// The limited value integrated from zero to `end`.
fn area(end: f32, limit: f32) -> f32 {
    let inside = end.abs().min(limit);
    inside * (end.abs() - 0.5 * inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An error that goes in a straight line.
    fn straight(start: f32, end: f32, dt: f32) -> ErrorStretch {
        let all = |x| Vec3::new(x, x, x);
        ErrorStretch {
            start: all(start),
            end: all(end),
            mean: all(0.5 * (start + end)),
            dt,
        }
    }

    proptest! {
        #[test]
        fn the_mean_of_a_limited_line_is_that_of_its_many_points(
            start in -5.0f32..5.0, end in -5.0f32..5.0, limit in 0.1f32..4.0
        ) {
            let point = |k: i32| start + (end - start) * (k as f32 + 0.5) / 2000.0;
            let sum: f64 = (0..2000).map(|k| f64::from(limited(point(k), limit))).sum();
            let mean = mean_limited([start, end], 0.5 * (start + end), limit);
            prop_assert!((f64::from(mean) - sum / 2000.0).abs() < 2e-3, "{}", mean);
        }

        #[test]
        fn an_integral_at_its_limit_takes_one_long_stretch_as_many_short_ones(
            before in -1.0f32..1.0, start in -9.0f32..9.0, end in -9.0f32..9.0
        ) {
            let (one, limit) = (Vec3::new(2.0, 2.0, 2.0), Vec3::new(1.0, 1.0, 1.0));
            let before = Vec3::new(before, before, before);
            let rare = straight(start, end, 0.05).integrated(before, one, limit);
            let at = |k: i32| start + (end - start) * k as f32 / 50.0;
            let often = (0..50).fold(before, |state, k| {
                straight(at(k), at(k + 1), 0.001).integrated(state, one, limit)
            });
            prop_assert!((rare - often).max_norm() < 1e-5, "{:?} {:?}", rare, often);
        }

        #[test]
        fn any_course_leaves_the_integral_within_its_limit(
            before in -1.0f32..1.0, start in -1e6f32..1e6, end in -1e6f32..1e6, dt in 0.0f32..9.0
        ) {
            let (one, limit) = (Vec3::new(2.0, 2.0, 2.0), Vec3::new(1.0, 1.0, 1.0));
            let before = Vec3::new(before, before, before);
            let after = straight(start, end, dt).integrated(before, one, limit);
            prop_assert!(after.is_finite() && after.max_norm() <= 1.0);
            prop_assert!(mean_limited([start, end], start, 1.0).abs() <= 1.0);
            prop_assert_eq!(straight(start, end, 0.0).integrated(before, one, limit), before);
        }
    }
}

//! The square-root controller: how fast an error may be approached.

use crate::math::sqrt;

/// What an error asks for, and how that moves with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Approach {
    /// Rate or velocity asked for: the error's unit per second.
    pub speed: f32,
    /// Its derivative with respect to the error, 1/s.
    pub slope: f32,
}

/// How fast an error is approached so that a deceleration suffices to end at it.
///
/// Proportional (`gain`, 1/s) near zero; from where that would decelerate faster than
/// `acceleration` (error's unit per s2), the square root of a constant deceleration. Value and
/// slope are continuous where they meet.
///
/// The original also asks for no more than would end the error within one step. A step is at
/// most 0.1 s here, and the gain times that below one as long as it is below 10 1/s.
#[must_use]
pub fn approach(error: f32, gain: f32, acceleration: f32) -> Approach {
    let size = error.abs();
    let linear = acceleration / (gain * gain);
    if size <= linear {
        return Approach {
            speed: error * gain,
            slope: gain,
        };
    }
    let speed = sqrt(2.0 * acceleration * (size - 0.5 * linear));
    Approach {
        speed: speed.copysign(error),
        slope: acceleration / speed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_root_takes_over_where_the_line_decelerates_as_fast() {
        let meeting = 9.6 / (4.5 * 4.5);
        let near = approach(meeting * 0.9999, 4.5, 9.6);
        let far = approach(meeting * 1.0001, 4.5, 9.6);
        assert!((near.speed - far.speed).abs() < 1e-3);
        assert!((near.slope - far.slope).abs() < 1e-3);
    }

    #[test]
    fn a_body_that_follows_it_decelerates_as_was_allowed() {
        let (mut error, dt) = (3.0f32, 0.000_1);
        let mut before = approach(error, 4.5, 9.6).speed;
        while error > 0.01 {
            error -= before * dt;
            let speed = approach(error, 4.5, 9.6).speed;
            assert!(before - speed < 9.7 * dt, "{error}");
            before = speed;
        }
    }

    proptest! {
        #[test]
        fn more_error_never_asks_for_less(
            error in -100.0f32..100.0, more in 0.0f32..1.0,
            gain in 0.01f32..12.0, acceleration in 0.01f32..40.0
        ) {
            let [low, high] = [error, error + more].map(|e| approach(e, gain, acceleration));
            prop_assert!(low.speed.is_finite() && low.slope.is_finite());
            prop_assert!(high.speed >= low.speed - 1e-4 * low.speed.abs());
            prop_assert!(low.slope <= gain * 1.0001);
            prop_assert_eq!(approach(-error, gain, acceleration).speed, -low.speed);
        }
    }
}

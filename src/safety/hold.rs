//! The thrust that holds a vertical speed where no place is seen.
//!
//! By the mean thrust that was flown, and by how fast the accelerometer says that the drone sinks.
//! On the ground it never sinks as fast as it should: thrust falls until the landing is seen.

use crate::math::{between, min};
use crate::time::{Instant, seconds, span};

/// Shares of the mean thrust for each m/s that is missing, at once, and for each second of it: a
/// bandwidth of some 2 rad/s, as 1 % of the mean thrust is 0.15 m/s2.
const AT_ONCE: f32 = 0.14;
const LASTING: f32 = 0.1;
/// The least and the most, as shares of the mean thrust.
const LEAST: f32 = 0.3;
const MOST: f32 = 1.15;
/// The longest time (s) between two runs that is summed over.
const LONGEST: f32 = 0.2;

/// What holds a vertical speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Hold {
    newest: Option<Instant>,
    /// What lasts beside the mean thrust, as a share of it.
    beside: f32,
}

impl Hold {
    /// The thrust, as a share of the mean, for a drone that shall sink so fast, and does, in m/s.
    pub(super) fn thrust(&mut self, now: Instant, wanted: f32, sinking: f32) -> f32 {
        let since = self.newest.replace(now).map(|before| span(before, now));
        let dt = min(since.map_or(0.0, seconds), LONGEST);
        let missing = wanted - sinking;
        self.beside = between(
            self.beside - LASTING * missing * dt,
            LEAST - 1.0,
            MOST - 1.0,
        );
        between(1.0 + self.beside - AT_ONCE * missing, LEAST, MOST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    /// How fast a drone sinks at each second, whose mean thrust was off by a share, and which
    /// begins with a vertical speed (m/s); rotors slow it down a little.
    fn sinks(wanted: f32, off: f32, begins: f32) -> Vec<f32> {
        let (mut hold, mut speed) = (Hold::default(), begins);
        let mut seconds = Vec::new();
        for step in 0..1_000 {
            let share = hold.thrust(at_micros(step * 20_000), wanted, speed);
            let missing = 1.0 - share * (1.0 + off);
            speed += (missing * 1.5 * 9.81 - 0.1 * speed) * 0.02;
            if step % 50 == 49 {
                seconds.push(speed);
            }
        }
        seconds
    }

    #[test]
    fn a_speed_is_held_whatever_the_mean_thrust_was_off_by() {
        for off in [-0.1, 0.0, 0.1] {
            for begins in [-2.0, 0.0, 3.0] {
                let speeds = sinks(1.0, off, begins);
                assert!(speeds[3..].iter().all(|speed| *speed < 2.0), "{speeds:?}");
                assert!((speeds[19] - 1.0).abs() < 0.05, "{speeds:?}");
            }
        }
    }

    #[test]
    fn on_the_ground_thrust_falls_below_what_could_lift() {
        let mut hold = Hold::default();
        let shares = (0..500).map(|step| hold.thrust(at_micros(step * 20_000), 1.0, 0.0));
        let low = shares.map(|share| share < 0.5);
        assert!(low.skip(250).all(|low| low));
    }
}

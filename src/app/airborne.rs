//! Whether the drone has left the ground: before that, integrals only wind up.
//!
//! Nothing on board touches the ground, so the verdict is drawn from what a drone does that flies:
//! it asks for thrust for a while, or it was pushed upwards. Held down, or in a hand, the
//! accelerometer shows 1 g whatever the motors do.
//!
//! | asked for | felt | verdict |
//! |---|---|---|
//! | [`LIFTING`] or more for [`SPOOLING`] | - | airborne |
//! | more than [`IDLING`] | pushed upwards to [`LIFTED`] | airborne |
//! | [`IDLING`] or less for [`RESTING`] | 1 g all the time | on the ground |
//! | motors stopped by disarming | - | on the ground |

use crate::math::Vec3;
use crate::sensors::GRAVITY;
use crate::time::{Duration, Instant, micros, seconds, span};

/// Collective thrust with which most drones begin to climb; those that need less are felt.
const LIFTING: f32 = 0.25;
/// For how long it is asked for: motors and air take a while.
const SPOOLING: Duration = micros(500_000);
/// Collective thrust that lifts no drone.
const IDLING: f32 = 0.1;
/// Upward speed (m/s) that only a push by the propellers explains, beside that thrust.
const LIFTED: f32 = 0.5;
/// Time (s) over which pushes are summed.
const MEMORY: f32 = 1.0;
/// For how long a drone that landed stands.
const RESTING: Duration = micros(2_000_000);
/// How far the force may be from 1 g while it stands, in m/s2: a fall is further.
const STANDING: f32 = 2.0;

/// What tells flying from standing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Airborne {
    airborne: bool,
    /// When it was judged last.
    judged: Option<Instant>,
    /// Since when what is asked for and felt speaks against the verdict.
    since: Option<Instant>,
    /// Speed (m/s) gained by pushes beyond 1 g, forgotten over [`MEMORY`].
    pushed: f32,
}

impl Airborne {
    /// Judges with the collective thrust in force and the filtered specific force (m/s2).
    pub(super) fn judge(&mut self, now: Instant, armed: bool, thrust: f32, force: Vec3) {
        let dt = self.judged.map_or(0.0, |before| seconds(span(before, now)));
        self.judged = Some(now);
        if !armed {
            *self = Self::default();
            return;
        }
        let beyond = force.norm() - GRAVITY;
        let kept = (1.0 - dt * (1.0 / MEMORY)).max(0.0);
        self.pushed = self.pushed * kept + beyond * dt.min(MEMORY);
        let (contradicted, patience) = if self.airborne {
            (thrust <= IDLING && beyond.abs() < STANDING, RESTING)
        } else {
            (thrust >= LIFTING, SPOOLING)
        };
        self.since = contradicted.then(|| self.since.unwrap_or(now));
        let lifted = !self.airborne && thrust > IDLING && self.pushed > LIFTED;
        let lasted = self.since.is_some_and(|since| span(since, now) >= patience);
        if lifted || lasted {
            self.airborne = !self.airborne;
            self.since = None;
            self.pushed = 0.0;
        }
    }

    /// The verdict.
    pub(super) fn is_airborne(&self) -> bool {
        self.airborne
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::at_micros;

    /// After `seconds` of each thrust and force (g), judged 100 times a second from a start on.
    fn judged(armed: bool, steps: &[(f32, f32, f32)]) -> bool {
        let mut airborne = Airborne::default();
        let mut now = 0;
        for &(seconds, thrust, force) in steps {
            for _ in 0..(seconds * 100.0) as u32 {
                now += 10_000;
                let force = Vec3::new(0.0, 0.0, -force * GRAVITY);
                airborne.judge(at_micros(now), armed, thrust, force);
            }
        }
        airborne.is_airborne()
    }

    #[test]
    fn a_drone_that_is_held_down_at_low_thrust_stays_on_the_ground() {
        assert!(!judged(true, &[(60.0, 0.0, 1.0)]));
        assert!(!judged(true, &[(60.0, 0.1, 1.0)]));
        assert!(!judged(true, &[(60.0, 0.2, 1.0)]));
    }

    #[test]
    fn lasting_thrust_or_a_push_upwards_lifts_it() {
        assert!(!judged(true, &[(0.3, 0.5, 1.0)]));
        assert!(judged(true, &[(0.7, 0.5, 1.0)]));
        assert!(judged(true, &[(0.3, 0.2, 1.3)]), "a strong drone");
        assert!(!judged(true, &[(0.3, 0.05, 1.3)]), "a hand lifts it");
        assert!(!judged(false, &[(5.0, 0.5, 1.3)]));
    }

    #[test]
    fn it_has_landed_once_it_stands_without_thrust_but_not_while_it_falls() {
        let up = (1.0, 0.5, 1.0);
        assert!(!judged(true, &[up, (2.5, 0.0, 1.0)]));
        assert!(judged(true, &[up, (1.0, 0.0, 1.0)]));
        assert!(judged(true, &[up, (5.0, 0.0, 0.1)]));
        assert!(judged(
            true,
            &[up, (1.5, 0.0, 1.0), (0.1, 0.5, 1.0), (1.5, 0.0, 1.0)]
        ));
    }
}

//! Whether the drone stands, may be in the air, or flies: the one verdict.
//!
//! Nothing on board touches the ground, so it is drawn from what is asked of a drone that flies,
//! and from what that does: held down, or in a hand, an accelerometer shows 1 g whatever the
//! motors do. Figures are in `config/safety.toml`.
//!
//! | asked for | felt | verdict |
//! |---|---|---|
//! | more than `idle_thrust` | - | it may be in the air |
//! | `lifting_thrust` or more for `lifting_s` | - | it flies |
//! | more than `idle_thrust` | pushed upwards to `lifted_m_s` | it flies |
//! | `idle_thrust` or less, or half of the mean thrust | at rest for `landed_s` | it stands |
//!
//! Where it may be in the air, motors are not stopped lightly. Until it flies, integrals only wind
//! up. In the air a drone with so little thrust falls: what it feels then is no gravity.

use super::FlightEvent;
use super::seen::{Lasting, Seen};
use crate::config::{IDLE_THRUST, LANDED_TIME, LIFTED_SPEED, LIFTING_THRUST, LIFTING_TIME};
use crate::math::{max, min};

/// Time (s) over which pushes are summed.
const MEMORY: f32 = 1.0;
/// A drone at rest with less than this share of the mean thrust is not held by its rotors.
const LANDED_SHARE: f32 = 0.5;

/// What tells flying from standing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ground {
    flies: bool,
    lifting: Lasting,
    standing: Lasting,
    /// Speed (m/s) gained by pushes beyond 1 g.
    pushed: f32,
}

impl Ground {
    /// True where the drone has left the ground for certain.
    pub(super) fn flies(&self) -> bool {
        self.flies
    }

    /// True where it stands, though perhaps not for long yet; beside the mean thrust of its flight.
    pub(super) fn stands(seen: &Seen, mean_thrust: f32) -> bool {
        let thrust = seen.thrust.share();
        seen.rests() && (thrust <= IDLE_THRUST || thrust <= LANDED_SHARE * mean_thrust)
    }

    /// Takes what an armed drone does, `dt` (s) behind the last; what that shows.
    pub(super) fn take(&mut self, seen: &Seen, dt: f32, stands: bool) -> Option<FlightEvent> {
        let thrust = seen.thrust.share();
        let kept = max(1.0 - dt * (1.0 / MEMORY), 0.0);
        self.pushed = self.pushed * kept + seen.pushed() * min(dt, MEMORY);
        let may_fly = thrust > IDLE_THRUST;
        let lifts = thrust >= LIFTING_THRUST;
        self.flies |= self.lifting.lasts(lifts, seen.at, LIFTING_TIME)
            || may_fly && self.pushed > LIFTED_SPEED;
        if self.standing.lasts(stands, seen.at, LANDED_TIME) {
            *self = Self::default();
            return Some(FlightEvent::Landed);
        }
        may_fly.then_some(FlightEvent::TookOff)
    }
}

//! What a run knows of the drone, and for how long something has been so.

use crate::config::{REST_FORCE, REST_RATE};
use crate::math::Vec3;
use crate::sensors::GRAVITY;
use crate::time::{Duration, Instant, span};
use crate::units::Thrust;

/// What a run knows of the drone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Now.
    pub at: Instant,
    /// Collective thrust that was asked of the mixer.
    pub thrust: Thrust,
    /// Filtered rates, in rad/s.
    pub rates: Vec3,
    /// Filtered specific force, in m/s2.
    pub force: Vec3,
    /// Where down is by the estimate, body axes, of length 1.
    pub down: Vec3,
    /// Where it shall be; `None` where no attitude is asked for.
    pub asked_down: Option<Vec3>,
    /// The drone comes down to a place that it sees.
    pub sees_place: bool,
}

impl Seen {
    /// By how much more than gravity the drone is pushed, in m/s2.
    pub(super) fn pushed(&self) -> f32 {
        self.force.norm() - GRAVITY
    }

    /// True where the body neither turns nor is pushed. Motors that idle shake it.
    pub(super) fn rests(&self) -> bool {
        self.rates.max_norm() < REST_RATE && self.pushed().abs() < REST_FORCE
    }
}

/// Something that counts only once it has lasted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lasting(Option<Instant>);

impl Lasting {
    /// True where it holds, and has for this time.
    pub(super) fn lasts(&mut self, holds: bool, now: Instant, time: Duration) -> bool {
        if !holds {
            self.0 = None;
            return false;
        }
        span(*self.0.get_or_insert(now), now) >= time
    }
}

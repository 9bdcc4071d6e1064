//! What the drone shall fly: setpoints, goals, and what holds once something stops.
//!
//! The newest demand counts, a setpoint or a goal. Silence ends what it cannot be trusted with:
//!
//! | falls silent | flown | then |
//! |---|---|---|
//! | the peer | a setpoint | level, heading free, at the mean thrust flown |
//! | the peer | a goal | the goal's place is held, for as long as places come |
//! | places | a goal | level, heading free, at the mean thrust flown |
//! | either | anything, on the ground | no thrust: a late take-off would surprise everybody |
//!
//! A place is held, because level flight drifts with the wind, and climbs or sinks: of what is
//! known, staying is the safest. Loops that see no place are blind to both, and would go on
//! leaning towards a goal that may be passed long ago. What follows for the flight is in
//! [`crate::safety::FlightState`]: it ends, unless the pilot comes back.

use crate::config::{DESCENT_SPEED, SETPOINT_TIMEOUT};
use crate::control::{Goal, Setpoint};
use crate::graph::ControlLogic;
use crate::math::Vec3;
use crate::time::{Duration, Instant, micros, seconds, span};
use crate::units::Velocity;

/// Time (s) over which the turning of desired attitudes is averaged: a step of the stick is no flip.
const AVERAGED: f32 = 0.25;

/// Places further apart are not of one movement: the later one begins anew.
const LONGEST_BETWEEN_PLACES: Duration = micros(500_000);

/// What is flown: a setpoint or a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    /// An attitude or rates, and a thrust.
    Setpoint(Setpoint),
    /// A place.
    Goal(Goal),
}

/// Something that the drone is flown by, and that stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Silence {
    /// The peer's setpoints.
    Setpoint,
    /// The peer's goals.
    Goal,
    /// Places, while a goal was flown.
    Place,
}

/// When demands and places come, and how fast setpoints turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Demand {
    /// When the newest setpoint or goal came; `None` once they fell silent.
    newest: Option<Instant>,
    /// How fast setpoints turn, in rad/s.
    turning: f32,
    /// When the newest place came.
    placed_at: Option<Instant>,
    /// When the goal of a descent last sank.
    sank_at: Option<Instant>,
}

impl Demand {
    /// Takes a setpoint, behind one that was in force; how fast they turn now, in rad/s.
    pub(super) fn take_setpoint(
        &mut self,
        at: Instant,
        before: &Setpoint,
        setpoint: &Setpoint,
    ) -> f32 {
        let angle = match (self.newest, before.attitude, setpoint.attitude) {
            (Some(_), Some(before), Some(attitude)) => before.error_to(attitude).max_norm(),
            _ => 0.0,
        };
        let since = self
            .newest
            .map_or(AVERAGED, |before| seconds(span(before, at)));
        let kept = (1.0 - since / AVERAGED).max(0.0);
        self.turning = self.turning * kept + angle / AVERAGED;
        self.newest = Some(at);
        self.turning.max(setpoint.rates.0.max_norm())
    }

    /// Takes a goal.
    pub(super) fn take_goal(&mut self, at: Instant) {
        self.newest = Some(at);
        self.turning = 0.0;
    }

    /// Takes a place; the time since the one before in s, 0 where that is long ago.
    pub(super) fn take_place(&mut self, at: Instant) -> f32 {
        self.placed_at
            .replace(at)
            .map(|before| span(before, at))
            .filter(|since| *since <= LONGEST_BETWEEN_PLACES)
            .map_or(0.0, seconds)
    }

    /// The next demand is the first again.
    pub(super) fn forget(&mut self) {
        self.newest = None;
        self.turning = 0.0;
        self.sank_at = None;
    }

    /// True where no demand is in force that came from the peer.
    pub(super) fn is_silent(&self) -> bool {
        self.newest.is_none()
    }

    /// True while places come.
    pub(super) fn knows_place(&self, now: Instant) -> bool {
        self.placed_at
            .is_some_and(|at| span(at, now) <= SETPOINT_TIMEOUT)
    }

    /// The goal of a descent, which sinks as time passes.
    pub(super) fn sink(&mut self, now: Instant, goal: Goal) -> Goal {
        let since = self.sank_at.replace(now).unwrap_or(now);
        let mut goal = Goal {
            velocity: Velocity(Vec3::new(0.0, 0.0, DESCENT_SPEED)),
            ..goal
        };
        goal.position.0.z += DESCENT_SPEED * seconds(span(since, now));
        goal
    }

    /// What fell silent: what is flown must not outlive what it is flown by.
    pub(super) fn notice_silence(
        &mut self,
        now: Instant,
        graph: &impl ControlLogic,
    ) -> Option<Silence> {
        let silent = self
            .newest
            .is_some_and(|at| span(at, now) > SETPOINT_TIMEOUT);
        let silence = match graph.flown_to() {
            Some(_) if !self.knows_place(now) => Silence::Place,
            Some(_) if silent => Silence::Goal,
            _ if silent => Silence::Setpoint,
            _ => return None,
        };
        self.forget();
        Some(silence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Quaternion;
    use crate::time::at_micros;
    use crate::units::Thrust;

    fn rolled(angle: f32) -> Setpoint {
        Setpoint {
            attitude: Some(Quaternion::IDENTITY.turned_by(Vec3::new(angle, 0.0, 0.0))),
            ..Setpoint::level(Thrust::ZERO)
        }
    }

    /// The fastest that setpoints at 50 Hz turn, by roll angles in rad.
    fn fastest(angles: impl Iterator<Item = f32>) -> f32 {
        let mut demand = Demand::default();
        let mut before = rolled(0.0);
        let mut fastest = 0.0f32;
        for (step, angle) in (0..).zip(angles) {
            let setpoint = rolled(angle);
            fastest =
                fastest.max(demand.take_setpoint(at_micros(step * 20_000), &before, &setpoint));
            before = setpoint;
        }
        fastest
    }

    #[test]
    fn a_step_of_the_stick_is_not_mistaken_for_a_flip() {
        let step = fastest((0..50).map(|step| if step < 10 { 0.0 } else { 0.2 }));
        assert!((step - 0.8).abs() < 0.05, "{step}");
        let turn = fastest((0..50).map(|step| 0.25f32.min(step as f32 * 0.02 * 2.0)));
        assert!((0.7..2.1).contains(&turn), "{turn}");
    }

    #[test]
    fn desired_rates_count_as_they_are() {
        let mut demand = Demand::default();
        let mut setpoint = rolled(0.0);
        setpoint.rates.0.x = -15.0;
        let turning = demand.take_setpoint(at_micros(0), &rolled(0.0), &setpoint);
        assert_eq!(turning, 15.0);
    }
}

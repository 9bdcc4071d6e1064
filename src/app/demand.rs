//! What the drone shall fly: setpoints, goals, and what holds once something stops.
//!
//! The newest demand counts, a setpoint or a goal. Silence ends what it cannot be trusted with:
//!
//! | falls silent | flown | then |
//! |---|---|---|
//! | the peer | a setpoint | level, heading free, at its thrust |
//! | the peer | a goal, armed | the goal's place is held, for as long as places come |
//! | the peer | a goal, on the ground | no thrust: a late take-off would surprise everybody |
//! | places | a goal | level, heading free, at the thrust last commanded |
//!
//! A place is held, because level flight drifts with the wind, and climbs or sinks: of what is
//! known, staying is the safest. Loops that see no place are blind to both, and would go on
//! leaning towards a goal that may be passed long ago.

use super::telemetry::Event;
use crate::config::SETPOINT_TIMEOUT;
use crate::control::{Goal, Setpoint};
use crate::graph::ControlLogic;
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

/// When demands and places come, and how fast setpoints turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Demand {
    /// When the newest setpoint or goal came; `None` once they fell silent.
    newest: Option<Instant>,
    /// How fast setpoints turn, in rad/s.
    turning: f32,
    /// When the newest place came.
    placed_at: Option<Instant>,
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

    /// What is flown must not outlive what it is flown by: what follows, and why; see above.
    pub(super) fn after_silence(
        &mut self,
        now: Instant,
        armed: bool,
        graph: &impl ControlLogic,
    ) -> Option<(Aim, Event)> {
        let silent = self
            .newest
            .is_some_and(|at| span(at, now) > SETPOINT_TIMEOUT);
        let follows = match graph.flown_to() {
            Some(_) if !self.knows_place(now) => (level(armed, graph), Event::PlaceLost),
            Some(goal) if silent && armed => (stand_still(goal), Event::GoalHeld),
            _ if silent => (level(armed, graph), Event::SetpointLost),
            _ => return None,
        };
        self.forget();
        Some(follows)
    }
}

/// A goal that nobody moves any more stands still.
fn stand_still(goal: Goal) -> Aim {
    Aim::Goal(Goal {
        velocity: Velocity::default(),
        ..goal
    })
}

/// Level, heading free; after a goal on the ground without thrust.
fn level(armed: bool, graph: &impl ControlLogic) -> Aim {
    Aim::Setpoint(match graph.flown_to() {
        None => Setpoint::level(graph.flown().thrust),
        Some(_) if armed => Setpoint::level(graph.collective()),
        Some(_) => Setpoint::default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Quaternion, Vec3};
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

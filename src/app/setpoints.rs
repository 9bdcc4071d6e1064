//! Setpoints as they come: whether one forces a run, whether they are aerobatics.

use crate::config::{
    SETPOINT_ANGLE_QUANTUM, SETPOINT_POSITION_QUANTUM, SETPOINT_RATE_QUANTUM,
    SETPOINT_THRUST_QUANTUM, SETPOINT_TIMEOUT,
};
use crate::control::{Goal, Setpoint};
use crate::math::wrapped;
use crate::time::{Instant, seconds, span};

/// Time (s) over which the turning of desired attitudes is averaged: a step of the stick is no flip.
const AVERAGED: f32 = 0.25;

/// When demands come, setpoints or goals, and how fast they move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SetpointWatch {
    /// When the newest one came; `None` once they fell silent.
    pub(super) at: Option<Instant>,
    /// How fast setpoints turn, in rad/s.
    turning: f32,
    /// The way that goals took since the last run, in quanta.
    way: f32,
}

impl SetpointWatch {
    /// True once demands have stopped for longer than they may.
    pub(super) fn fell_silent(&self, now: Instant) -> bool {
        self.at.is_some_and(|at| span(at, now) > SETPOINT_TIMEOUT)
    }

    /// Takes a goal, behind one that was in force; true where it calls for a run.
    ///
    /// The first does, and those that took a quantum of way since the last run.
    pub(super) fn take_goal(&mut self, at: Instant, before: Option<&Goal>, goal: &Goal) -> bool {
        self.at = Some(at);
        self.turning = 0.0;
        self.way += before.map_or(1.0, |before| quanta_between(before, goal));
        self.way >= 1.0
    }

    /// After a run: it flew the newest goal.
    pub(super) fn on_run(&mut self) {
        self.way = 0.0;
    }

    /// Takes a setpoint, behind one that was in force; how fast they turn now, in rad/s.
    pub(super) fn take(&mut self, at: Instant, before: &Setpoint, setpoint: &Setpoint) -> f32 {
        let angle = match (self.at, before.attitude, setpoint.attitude) {
            (Some(_), Some(before), Some(attitude)) => before.error_to(attitude).max_norm(),
            _ => 0.0,
        };
        let since = self.at.map_or(AVERAGED, |before| seconds(span(before, at)));
        let kept = (1.0 - since / AVERAGED).max(0.0);
        self.turning = self.turning * kept + angle / AVERAGED;
        self.at = Some(at);
        self.turning.max(setpoint.rates.0.max_norm())
    }
}

/// True where a setpoint differs from another by its own quantum or more.
pub(super) fn moved(from: &Setpoint, to: &Setpoint) -> bool {
    let turned = match (from.attitude, to.attitude) {
        (Some(from), Some(to)) => from.error_to(to).max_norm() >= SETPOINT_ANGLE_QUANTUM,
        (None, None) => false,
        _ => true,
    };
    turned
        || from.yaw != to.yaw
        || (to.rates.0 - from.rates.0).max_norm() >= SETPOINT_RATE_QUANTUM
        || (to.thrust.share() - from.thrust.share()).abs() >= SETPOINT_THRUST_QUANTUM
}

/// How far a goal is from another, in its own quanta.
fn quanta_between(from: &Goal, to: &Goal) -> f32 {
    let way = (to.position.0 - from.position.0).norm();
    let turn = wrapped(to.heading - from.heading).abs();
    (way / SETPOINT_POSITION_QUANTUM).max(turn / SETPOINT_ANGLE_QUANTUM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Quaternion, Vec3};
    use crate::time::at_micros;
    use crate::units::{Position, Thrust};

    /// Whether goals so far apart (m, rad), one after the other, call for a run.
    fn calls(steps: &[(f32, f32)]) -> bool {
        let mut watch = SetpointWatch::default();
        let mut before = Goal::default();
        assert!(watch.take_goal(at_micros(0), None, &before), "the first");
        watch.on_run();
        steps.iter().fold(false, |_, (way, turn)| {
            let mut goal = before;
            goal.position = Position(goal.position.0 + Vec3::new(0.0, *way, 0.0));
            goal.heading += turn;
            let calls = watch.take_goal(at_micros(0), Some(&before), &goal);
            before = goal;
            calls
        })
    }

    #[test]
    fn goals_call_for_a_run_once_they_moved_or_turned_by_a_quantum() {
        let quantum = SETPOINT_POSITION_QUANTUM;
        assert!(!calls(&[(0.9 * quantum, 0.0)]));
        assert!(calls(&[(1.1 * quantum, 0.0)]));
        assert!(calls(&[(0.4 * quantum, 0.0); 3]), "in small steps too");
        assert!(!calls(&[(0.0, 0.9 * SETPOINT_ANGLE_QUANTUM)]));
        assert!(calls(&[(0.0, 1.1 * SETPOINT_ANGLE_QUANTUM)]));
        assert!(!calls(&[(0.0, core::f32::consts::TAU)]), "a whole turn");
    }

    fn rolled(angle: f32) -> Setpoint {
        Setpoint {
            attitude: Some(Quaternion::IDENTITY.turned_by(Vec3::new(angle, 0.0, 0.0))),
            ..Setpoint::level(Thrust::ZERO)
        }
    }

    /// The fastest that setpoints at 50 Hz turn, by roll angles in rad.
    fn fastest(angles: impl Iterator<Item = f32>) -> f32 {
        let mut watch = SetpointWatch::default();
        let mut before = rolled(0.0);
        let mut fastest = 0.0f32;
        for (step, angle) in (0..).zip(angles) {
            let setpoint = rolled(angle);
            fastest = fastest.max(watch.take(at_micros(step * 20_000), &before, &setpoint));
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
        let mut watch = SetpointWatch::default();
        let mut setpoint = rolled(0.0);
        setpoint.rates.0.x = -15.0;
        let turning = watch.take(at_micros(0), &rolled(0.0), &setpoint);
        assert_eq!(turning, 15.0);
    }
}

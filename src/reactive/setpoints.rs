//! Setpoints and goals as triggers: a change past a quantum calls for a run.

use crate::config::{
    SETPOINT_ANGLE_QUANTUM, SETPOINT_POSITION_QUANTUM, SETPOINT_RATE_QUANTUM,
    SETPOINT_THRUST_QUANTUM,
};
use crate::control::{Goal, Setpoint};
use crate::math::wrapped;

/// How far demands moved since the last run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SetpointQuanta {
    /// The setpoint that the last run flew.
    of_last_run: Setpoint,
    /// The way that goals took since the last run, in quanta.
    way: f32,
}

impl SetpointQuanta {
    /// True where a setpoint moved by its quantum since the last run.
    pub(super) fn calls(&self, setpoint: &Setpoint) -> bool {
        moved(&self.of_last_run, setpoint)
    }

    /// Takes a goal, behind one that was in force; true where it calls for a run.
    ///
    /// The first does, and those that took a quantum of way since the last run.
    pub(super) fn take_goal(&mut self, before: Option<&Goal>, goal: &Goal) -> bool {
        self.way += before.map_or(1.0, |before| quanta_between(before, goal));
        self.way >= 1.0
    }

    /// A run flew the newest goal, or this setpoint.
    pub(super) fn on_run(&mut self, flown: &Setpoint) {
        self.of_last_run = *flown;
        self.way = 0.0;
    }
}

/// True where a setpoint differs from another by its own quantum or more.
fn moved(from: &Setpoint, to: &Setpoint) -> bool {
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
    use crate::math::Vec3;
    use crate::units::Position;

    /// Whether goals so far apart (m, rad), one after the other, call for a run.
    fn calls(steps: &[(f32, f32)]) -> bool {
        let mut quanta = SetpointQuanta::default();
        let mut before = Goal::default();
        assert!(quanta.take_goal(None, &before), "the first");
        quanta.on_run(&Setpoint::default());
        steps.iter().fold(false, |_, (way, turn)| {
            let mut goal = before;
            goal.position = Position(goal.position.0 + Vec3::new(0.0, *way, 0.0));
            goal.heading += turn;
            let calls = quanta.take_goal(Some(&before), &goal);
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
}

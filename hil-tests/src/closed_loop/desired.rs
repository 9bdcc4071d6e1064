//! The attitude that a control logic steers to, read from its graph.
//!
//! What the paper calls the desired attitude: what the autopilot wants the drone to take in order
//! to reach where it is going (Bregu et al. 2016, section 7.1).

use reflex::control::{Setpoint, Yaw};
use reflex::math::Quaternion;

use super::mission::wrapped;
use crate::logics::AnyLogic;

/// Roll, pitch and yaw in rad; none where an axis is not asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Desired(pub(super) [Option<f64>; 3]);

impl Desired {
    /// What a logic steered to in its last run.
    pub(super) fn of(logic: &AnyLogic) -> Self {
        match logic {
            AnyLogic::Cascade(logic) => Self::of_setpoint(logic.setpoint()),
            AnyLogic::Observer(logic) => Self::of_setpoint(logic.setpoint()),
            AnyLogic::ArduCopter(logic) => Self::of_setpoint(logic.target()),
            AnyLogic::OpenPilot(logic) => Self::of_setpoint(logic.target()),
            AnyLogic::Cleanflight(logic) => {
                let aim = logic.aim();
                let lean = aim.lean;
                Self([
                    lean.map(|lean| lean.roll.into()),
                    lean.map(|lean| lean.pitch.into()),
                    aim.heading.map(f64::from),
                ])
            }
        }
    }

    fn of_setpoint(setpoint: &Setpoint) -> Self {
        let angles = setpoint.attitude.map(angles);
        let [roll, pitch, yaw] = [0, 1, 2].map(|axis| angles.map(|angles| angles[axis]));
        let heading = yaw.filter(|_| setpoint.yaw == Yaw::Heading);
        Self([roll, pitch, heading])
    }

    /// Desired less actual angles in rad, the shorter way round.
    pub(super) fn less(&self, actual: [f64; 3]) -> [Option<f64>; 3] {
        let mut actual = actual.into_iter();
        self.0.map(|desired| {
            let actual = actual.next().unwrap_or_default();
            desired.map(|desired| wrapped(desired - actual))
        })
    }
}

/// Roll, pitch and yaw in rad.
fn angles(attitude: Quaternion) -> [f64; 3] {
    let [w, x, y, z] = attitude.to_array().map(f64::from);
    let attitude = nalgebra::Quaternion::new(w, x, y, z);
    let (roll, pitch, yaw) = nalgebra::UnitQuaternion::from_quaternion(attitude).euler_angles();
    [roll, pitch, yaw]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logics::LogicName;
    use clap::ValueEnum;
    use reflex::control::{Goal, Yaw};
    use reflex::estimate::Place;
    use reflex::graph::ControlLogic;
    use reflex::math::Vec3;
    use reflex::units::{Position, Thrust};

    #[test]
    fn every_logic_tells_the_attitude_of_its_setpoint() {
        for name in LogicName::value_variants() {
            let mut logic = name.logic();
            let mut setpoint = Setpoint::level(Thrust::new(0.5).expect("in range"));
            let turn = Vec3::new(0.1, 0.0, 0.0);
            setpoint.attitude = Some(Quaternion::from_heading(0.5).turned_by(turn));
            setpoint.yaw = Yaw::Heading;
            logic.fly(setpoint);
            logic.run();
            let off = Desired::of(&logic)
                .less([0.0, 0.0, 0.5])
                .map(Option::unwrap);
            for (off, wanted) in off.into_iter().zip([0.1, 0.0, 0.0]) {
                assert!((off - wanted).abs() < 1e-3, "{name:?} {off}");
            }
        }
    }

    #[test]
    fn logics_with_position_loops_tell_how_they_lean_to_a_goal() {
        for name in LogicName::value_variants() {
            let mut logic = name.logic();
            if !logic.flies_to_goals() {
                continue;
            }
            logic.fly_to(Some(Goal::default()));
            for _ in 0..40 {
                logic.see(Place {
                    position: Position(Vec3::new(2.0, 0.0, 0.0)),
                    dt: 0.05,
                    ..Place::default()
                });
                logic.run();
            }
            let [roll, pitch, yaw] = Desired::of(&logic).0.map(Option::unwrap);
            assert!(pitch > 0.02, "{name:?}: nose up to fly south, {pitch}");
            assert!(roll.abs() < 1e-3 && yaw.abs() < 1e-3, "{name:?}");
        }
    }
}

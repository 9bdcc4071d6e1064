//! What is flown: the setpoint, or where there is a goal, what the hold asks for.

use super::{Hold, Lean};
use crate::control::{Goal, Setpoint, Yaw};
use crate::math::{Quaternion, limited, sin_cos};
use crate::settings::gains::cleanflight::{Gains, Level};
use crate::units::{BodyRates, Thrust};

/// The cosine of 80 degrees: the tilt past which thrust no longer lifts.
const LIFTING: f32 = 0.174;

/// The demand on level mode and mixer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aim {
    /// Desired roll and pitch; `None` where only rates are asked for.
    pub lean: Option<Lean>,
    /// Desired heading in rad, where one is held.
    pub heading: Option<f32>,
    /// Desired body rates, added to what the angles ask for.
    pub rates: BodyRates,
    /// Collective thrust.
    pub thrust: Thrust,
}

/// The setpoint's demand, or the hold's once it has begun.
///
/// The hold leans to north and east, about axes that depend on the present heading.
#[must_use]
pub fn aimed(
    setpoint: &Setpoint,
    goal: Option<Goal>,
    hold: &Hold,
    attitude: Quaternion,
    gains: &Gains,
) -> Aim {
    let (Some(goal), true) = (goal, hold.begun) else {
        return of_setpoint(setpoint, &gains.level);
    };
    let [north, east] = hold.lean();
    let (sin, cos) = sin_cos(attitude.heading());
    let lean = Lean {
        roll: limited(east * cos - north * sin, gains.position.lean_limit_rad),
        pitch: -limited(north * cos + east * sin, gains.position.lean_limit_rad),
    };
    let lifting = attitude.down_in_body().z > LIFTING;
    Aim {
        lean: Some(lean.within_limits(&gains.level)),
        heading: Some(goal.heading),
        rates: BodyRates::default(),
        thrust: hold.thrust(lifting),
    }
}

fn of_setpoint(setpoint: &Setpoint, gains: &Level) -> Aim {
    let held = match setpoint.yaw {
        Yaw::Heading => setpoint.attitude.map(Quaternion::heading),
        Yaw::Rate => None,
    };
    Aim {
        lean: setpoint
            .attitude
            .map(|attitude| Lean::of(attitude).within_limits(gains)),
        heading: held,
        rates: setpoint.rates,
        thrust: setpoint.thrust,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Climb, Sight, held};
    use super::*;
    use crate::config::cleanflight::GAINS;
    use crate::estimate::Place;
    use crate::math::Vec3;
    use crate::units::Position;
    use core::f32::consts::FRAC_PI_2;

    /// A hold that has leaned for a while towards a goal in this direction.
    fn leaning(north: f32, east: f32) -> (Goal, Hold) {
        let goal = Goal {
            position: Position(Vec3::new(north, east, 0.0)),
            ..Goal::default()
        };
        let place = Place {
            dt: 0.1,
            ..Place::default()
        };
        let hold = (0..5).fold(Hold::default(), |hold, _| {
            let sight = Sight {
                goal: Some(goal),
                place,
                thrust: Thrust::ZERO,
            };
            held(&hold, &sight, &Climb::default(), &GAINS)
        });
        (goal, hold)
    }

    #[test]
    fn a_setpoint_is_flown_within_the_farthest_lean() {
        let attitude = Quaternion::from_heading(1.0).turned_by(Vec3::new(0.3, 0.0, 0.0));
        let setpoint = Setpoint {
            attitude: Some(attitude),
            yaw: Yaw::Heading,
            ..Setpoint::default()
        };
        let flown = aimed(
            &setpoint,
            None,
            &Hold::default(),
            Quaternion::IDENTITY,
            &GAINS,
        );
        let lean = flown.lean.expect("an attitude was given");
        assert!((lean.roll - 0.3).abs() < 1e-3 && lean.pitch.abs() < 1e-3);
        assert!((flown.heading.expect("held") - 1.0).abs() < 1e-3);
        let over = Setpoint {
            attitude: Some((0..5).fold(attitude, |a, _| a.turned_by(Vec3::new(0.2, 0.0, 0.0)))),
            ..setpoint
        };
        let lean = aimed(&over, None, &Hold::default(), Quaternion::IDENTITY, &GAINS).lean;
        assert_eq!(lean.expect("given").roll, GAINS.level.max_lean_rad);
    }

    #[test]
    fn a_goal_is_leaned_to_whatever_the_heading() {
        for (north, east, heading, roll, pitch) in [
            (5.0, 0.0, 0.0, 0.0, -1.0),
            (0.0, 5.0, 0.0, 1.0, 0.0),
            (5.0, 0.0, FRAC_PI_2, -1.0, 0.0),
            (0.0, 5.0, FRAC_PI_2, 0.0, -1.0),
        ] {
            let (goal, hold) = leaning(north, east);
            let attitude = Quaternion::from_heading(heading);
            let flown = aimed(&Setpoint::default(), Some(goal), &hold, attitude, &GAINS);
            let lean = flown.lean.expect("a hold leans");
            assert!(lean.roll * roll > 0.01 || (roll == 0.0 && lean.roll.abs() < 1e-3));
            assert!(lean.pitch * pitch > 0.01 || (pitch == 0.0 && lean.pitch.abs() < 1e-3));
        }
    }

    #[test]
    fn a_goal_waits_for_the_first_place() {
        let setpoint = Setpoint::level(Thrust::new(0.3).expect("in range"));
        let goal = Some(Goal::default());
        let flown = aimed(
            &setpoint,
            goal,
            &Hold::default(),
            Quaternion::IDENTITY,
            &GAINS,
        );
        assert_eq!(flown.thrust, setpoint.thrust);
    }
}

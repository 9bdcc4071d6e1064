//! Tests of the position and altitude loops.

use super::*;
use crate::config::openpilot::GAINS;
use crate::sensors::GRAVITY;
use crate::units::{Position, Velocity};
use proptest::prelude::*;

const LAW: PathFollower = PathFollower::new(&GAINS);

fn place(position: Vec3, velocity: Vec3, dt: f32) -> Place {
    Place {
        position: Position(position),
        velocity: Velocity(velocity),
        dt,
    }
}

fn hover() -> Thrust {
    Thrust::new(0.5).expect("in range")
}

/// The state after this long on a straight course, in this many steps.
fn flown(before: &PathState, from: Place, goal: &Goal, seconds: f32, steps: u16) -> PathState {
    let dt = seconds / f32::from(steps);
    (1..=steps).fold(*before, |state, k| {
        let moved = from.velocity.0 * (f32::from(k) * dt);
        let here = place(from.position.0 + moved, from.velocity.0, dt);
        LAW.after(&state, &here, Some(goal), hover())
    })
}

fn leans(state: &PathState, place: &Place, goal: &Goal) -> Vec3 {
    let setpoint = LAW.setpoint(state, place, goal).expect("engaged");
    setpoint
        .attitude
        .expect("a lean")
        .to_earth(Vec3::new(0.0, 0.0, -1.0))
}

#[test]
fn without_a_goal_or_a_place_there_is_no_setpoint() {
    let (goal, here) = (Goal::default(), Place::default());
    assert_eq!(LAW.setpoint(&PathState::default(), &here, &goal), None);
    let engaged = LAW.after(&PathState::default(), &here, Some(&goal), hover());
    assert!(LAW.setpoint(&engaged, &here, &goal).is_some());
    let dropped = LAW.after(&engaged, &here, None, hover());
    assert_eq!(dropped, PathState::default());
}

#[test]
fn thrust_points_towards_the_goal_whatever_the_heading() {
    for heading in [0.0, 1.0, 2.5, -2.0] {
        let goal = Goal {
            position: Position(Vec3::new(4.0, -3.0, 0.0)),
            heading,
            ..Goal::default()
        };
        let here = Place::default();
        let state = LAW.after(&PathState::default(), &here, Some(&goal), hover());
        let thrust = leans(&state, &here, &goal);
        assert!(thrust.x > 0.05 && thrust.y < -0.05, "{heading} {thrust:?}");
        assert!(
            (thrust.x / -thrust.y - 4.0 / 3.0).abs() < 0.02,
            "{thrust:?}"
        );
    }
}

#[test]
fn below_the_goal_it_climbs_and_above_it_sinks() {
    let here = Place::default();
    for (down, climbs) in [(-1.0, true), (1.0, false)] {
        let goal = Goal {
            position: Position(Vec3::new(0.0, 0.0, down)),
            ..Goal::default()
        };
        let state = LAW.after(&PathState::default(), &here, Some(&goal), hover());
        let thrust = LAW.setpoint(&state, &here, &goal).expect("engaged").thrust;
        assert_eq!(thrust.share() > 0.5, climbs);
    }
}

#[test]
fn the_thrust_that_flew_goes_on() {
    let (goal, here) = (Goal::default(), Place::default());
    let flew = Thrust::new(0.35).expect("in range");
    let state = LAW.after(&PathState::default(), &here, Some(&goal), flew);
    let thrust = LAW.setpoint(&state, &here, &goal).expect("engaged").thrust;
    assert!((thrust.share() - 0.35).abs() < 1e-6);
    let state = LAW.after(&PathState::default(), &here, Some(&goal), Thrust::ZERO);
    let thrust = LAW.setpoint(&state, &here, &goal).expect("engaged").thrust;
    assert!((thrust.share() - GAINS.altitude.thrust_neutral).abs() < 1e-6);
}

#[test]
fn a_place_that_covers_no_time_advances_no_integral() {
    let goal = Goal {
        position: Position(Vec3::new(3.0, 1.0, -1.0)),
        ..Goal::default()
    };
    let start = Place::default();
    let state = flown(&PathState::default(), start, &goal, 0.5, 10);
    let again = LAW.after(&state, &start, Some(&goal), hover());
    assert_eq!(again.integral, state.integral);
}

/// Flies a mass on two loops to the goal in wind, with places this far apart (s).
fn arrived(dt: f32, hovering: f32) -> Vec3 {
    let goal = Goal {
        position: Position(Vec3::new(6.0, -4.0, -3.0)),
        heading: 0.8,
        ..Goal::default()
    };
    let (mut position, mut velocity) = (Vec3::ZERO, Vec3::ZERO);
    let mut state = PathState::default();
    for _ in 0..(90.0 / dt) as u32 {
        let here = place(position, velocity, dt);
        state = LAW.after(&state, &here, Some(&goal), hover());
        let setpoint = LAW.setpoint(&state, &here, &goal).expect("engaged");
        let force = setpoint.thrust.share() / hovering * GRAVITY;
        let pushed = setpoint
            .attitude
            .expect("a lean")
            .to_earth(Vec3::new(0.0, 0.0, -force));
        let acceleration = pushed + Vec3::new(0.5, 0.3, GRAVITY) - velocity * 0.2;
        velocity += acceleration * dt;
        position += velocity * dt;
    }
    position - goal.position.0
}

#[test]
fn it_arrives_in_wind_and_learns_what_hovering_takes() {
    for dt in [0.01, 0.05] {
        for hovering in [0.35, 0.65] {
            let missed = arrived(dt, hovering);
            assert!(missed.max_norm() < 0.03, "{dt} {hovering} {missed:?}");
        }
    }
}

proptest! {
    #[test]
    fn one_place_after_50_ms_comes_to_what_50_after_1_ms_do(
        x in -40.0f32..40.0, y in -40.0f32..40.0, z in -9.0f32..9.0,
        vx in -8.0f32..8.0, vz in -6.0f32..6.0
    ) {
        let goal = Goal::default();
        let start = place(Vec3::new(x, y, z), Vec3::new(vx, -vx, vz), 0.0);
        let before = LAW.after(&PathState::default(), &start, Some(&goal), hover());
        let rarely = flown(&before, start, &goal, 0.5, 10);
        let often = flown(&before, start, &goal, 0.5, 500);
        let apart = rarely.integral - often.integral;
        prop_assert!(apart.x.abs().max(apart.y.abs()) < 5e-5, "{:?}", apart);
        prop_assert!(apart.z.abs() < 5e-3, "{:?}", apart);
    }

    #[test]
    fn whatever_comes_lean_and_thrust_are_limited(
        steps in prop::collection::vec(
            (prop::array::uniform6(-1e6f32..1e6), -90.0f32..90.0, 0.0f32..2.0, 0.0f32..=1.0), 1..60
        )
    ) {
        let mut state = PathState::default();
        for ([x, y, z, vx, vy, vz], heading, dt, share) in steps {
            let goal = Goal {
                position: Position(Vec3::new(vy, x, vx)),
                velocity: Velocity(Vec3::new(z, y, x)),
                heading,
            };
            let here = place(Vec3::new(x, y, z), Vec3::new(vx, vy, vz), dt);
            let flown = Thrust::new(share).expect("in range");
            state = LAW.after(&state, &here, Some(&goal), flown);
            let setpoint = LAW.setpoint(&state, &here, &goal).expect("engaged");
            let share = setpoint.thrust.share();
            prop_assert!((GAINS.altitude.thrust_minimum..=GAINS.altitude.thrust_maximum).contains(&share));
            let up = leans(&state, &here, &goal).z;
            prop_assert!(up < -0.8, "{}", up);
            prop_assert!(state.integral.is_finite() && state.integral.max_norm() <= 1.0);
        }
    }
}

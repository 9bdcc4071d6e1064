//! What altitude and GPS hold promise.

use super::*;
use crate::math::Vec3;
use crate::units::{Position, Velocity};
use proptest::prelude::*;

fn place(position: Vec3, velocity: Vec3, dt: f32) -> Place {
    Place {
        position: Position(position),
        velocity: Velocity(velocity),
        dt,
    }
}

/// A goal at the origin, seen from a place.
fn seen(place: Place, thrust: f32) -> Sight {
    Sight {
        goal: Some(Goal::default()),
        place,
        thrust: Thrust::new(thrust).expect("in range"),
    }
}

fn run(runs: u32, sight: &Sight) -> Hold {
    (0..runs).fold(Hold::default(), |hold, _| {
        held(&hold, sight, &Climb::default())
    })
}

#[test]
fn a_hold_that_begins_in_flight_hovers_with_the_thrust_it_finds() {
    let at_goal = place(Vec3::ZERO, Vec3::ZERO, 0.02);
    let found = run(1, &seen(at_goal, 0.42)).thrust(true);
    assert!((found.share() - 0.42).abs() < 1e-6);
    let given = run(1, &seen(at_goal, 0.0)).thrust(true);
    assert!((given.share() - ALTITUDE_HOVER_THRUST).abs() < 1e-6);
}

#[test]
fn below_the_goal_or_sinking_asks_for_more_thrust() {
    let below = seen(place(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 0.02), 0.4);
    assert!(run(1, &below).thrust(true).share() > 0.5);
    let sinking = seen(place(Vec3::ZERO, Vec3::new(0.0, 0.0, 0.5), 0.02), 0.4);
    assert!(run(1, &sinking).thrust(true).share() > 0.5);
    assert!((run(1, &sinking).thrust(false).share() - 0.4).abs() < 1e-6);
}

#[test]
fn upward_acceleration_is_damped() {
    let sight = seen(place(Vec3::ZERO, Vec3::ZERO, 0.02), 0.4);
    let climb = Climb { acceleration: 10.0 };
    let share = held(&Hold::default(), &sight, &climb).thrust(true).share();
    assert!((share - 0.4 + 10.0 * ALTITUDE_VELOCITY_D).abs() < 1e-6);
}

#[test]
fn without_time_nothing_is_integrated_and_no_lean_changes() {
    let start = run(
        10,
        &seen(place(Vec3::new(3.0, -2.0, 1.0), Vec3::ZERO, 0.1), 0.4),
    );
    let still = seen(place(Vec3::new(3.0, -2.0, 1.0), Vec3::ZERO, 0.0), 0.4);
    assert_eq!(held(&start, &still, &Climb::default()), start);
}

#[test]
fn without_a_goal_everything_is_forgotten() {
    let start = run(
        10,
        &seen(place(Vec3::new(3.0, 0.0, 1.0), Vec3::ZERO, 0.1), 0.4),
    );
    let sight = Sight::default();
    assert_eq!(held(&start, &sight, &Climb::default()), Hold::default());
}

#[test]
fn a_drone_that_leans_as_asked_comes_to_the_goal_and_stays() {
    let dt = 0.05;
    let (mut hold, mut position, mut velocity) =
        (Hold::default(), Vec3::new(3.0, -2.0, 2.0), Vec3::ZERO);
    // A wind that pushes with a tenth of 1 g, and a drone heavier than was taken.
    for _ in 0..6_000 {
        let sight = seen(place(position, velocity, dt), 0.4);
        hold = held(&hold, &sight, &Climb::default());
        let [north, east] = hold.lean();
        let upward = (hold.thrust(true).share() / 0.45 - 1.0) * 9.8;
        let acceleration = Vec3::new(9.8 * north - 0.3, 9.8 * east, -upward);
        velocity += acceleration * dt;
        position += velocity * dt;
    }
    assert!(position.max_norm() < 0.5, "{position:?}");
    assert!(velocity.max_norm() < 0.1, "{velocity:?}");
}

proptest! {
    #[test]
    fn rare_places_come_to_the_same_as_frequent_ones(
        x in -5.0f32..5.0, z in -3.0f32..3.0, vx in -2.0f32..2.0, vz in -1.0f32..1.0
    ) {
        // A drone that coasts, seen every 10 ms and every 100 ms.
        let coasting = |every: u32| {
            (0..=200u32).step_by(every as usize).fold(Hold::default(), |hold, step| {
                let (from, velocity) = (Vec3::new(x, 0.0, z), Vec3::new(vx, 0.0, vz));
                let at = from + velocity * (step as f32 * 0.01);
                let sight = seen(place(at, velocity, every as f32 * 0.01), 0.4);
                held(&hold, &sight, &Climb::default())
            })
        };
        let (often, rarely) = (coasting(1), coasting(10));
        prop_assert!((often.north.integral - rarely.north.integral).abs() < 1e-4);
        prop_assert!((often.integral - rarely.integral).abs() < 1e-4);
        prop_assert!((often.thrust(true).share() - rarely.thrust(true).share()).abs() < 1e-3);
        prop_assert!((often.north.lean - rarely.north.lean).abs() < 1e-3);
    }

    #[test]
    fn lean_and_thrust_stay_bounded_whatever_comes(
        places in prop::collection::vec(
            (any::<f32>(), any::<f32>(), any::<f32>(), any::<f32>(), 0.0f32..2.0), 1..50)
    ) {
        let mut hold = Hold::default();
        for (x, z, vx, vz, dt) in places {
            let sight = seen(place(Vec3::new(x, -x, z), Vec3::new(vx, z, vz), dt), 0.4);
            hold = held(&hold, &sight, &Climb { acceleration: vz });
            for lean in hold.lean() {
                prop_assert!(lean.abs() <= POSITION_LEAN_LIMIT + 1e-6, "{hold:?}");
            }
            prop_assert!((0.0..=1.0).contains(&hold.thrust(true).share()));
            prop_assert!(hold.adjustment.is_finite());
        }
    }
}

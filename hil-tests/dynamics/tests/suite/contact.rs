//! Ground: rest, take-off, landing, crash.

use flight_dynamics::{Drag, Drone, Environment, STANDARD_GRAVITY, Start, State};
use nalgebra::{UnitQuaternion, Vector3};

use crate::{close, fly, flying, vehicles};

#[test]
fn a_drone_rests_level_and_still_in_a_fresh_breeze() {
    for vehicle in [vehicles::quad(), vehicles::hexa(), vehicles::y6()] {
        let place = Start {
            north: 3.0,
            east: -2.0,
            heading: 1.0,
        };
        let mut drone = Drone::new(&vehicle, place, &Environment::calm()).unwrap();
        let still = vec![0.0; vehicle.motors.len()];
        fly(&mut drone, 1.0, 1e-3, &still);
        close(drone.height(), 0.0, 1e-12);
        close(drone.readings().specific_force.z, -STANDARD_GRAVITY, 1e-9);
        for _ in 0..20_000 {
            let breeze = Vector3::new(6.0, -6.0, 0.0);
            drone.advance(1e-3, &still, breeze).unwrap();
        }
        let state = drone.state();
        close(state.position.x, 3.0, 1e-3);
        close(state.position.y, -2.0, 1e-3);
        close(state.velocity.norm(), 0.0, 1e-9);
        close(state.rates.norm(), 0.0, 1e-9);
        close(state.tilt(), 0.0, 5e-3);
        close(state.attitude.euler_angles().2, 1.0, 1e-6);
        assert!(drone.is_on_ground() && drone.crash().is_none());
    }
}

#[test]
fn it_takes_off_when_thrust_exceeds_weight_and_not_before() {
    let vehicle = vehicles::ideal(vehicles::quad());
    let hover = vehicles::hover(&vehicle);
    let mut drone = Drone::new(&vehicle, Start::default(), &Environment::calm()).unwrap();
    fly(&mut drone, 1.0, 1e-3, &[hover - 0.02; 4]);
    assert!(drone.is_on_ground());
    fly(&mut drone, 1.0, 1e-3, &[hover + 0.02; 4]);
    assert!(!drone.is_on_ground() && drone.height() > 0.05);
    close(drone.state().tilt(), 0.0, 1e-6);
}

/// Dropped so that it touches at about `speed` m/s, motors stopped.
fn dropped(speed: f64) -> Drone {
    let mut vehicle = vehicles::quad();
    vehicle.drag = Drag::none();
    let height = vehicle.skids.height + speed * speed / (2.0 * STANDARD_GRAVITY);
    let mut drone = flying(&vehicle, height, 0.0);
    fly(&mut drone, 3.0, 1e-3, &[0.0; 4]);
    drone
}

#[test]
fn a_gentle_landing_comes_to_rest_and_is_no_crash() {
    let drone = dropped(1.5);
    assert_eq!(drone.crash(), None);
    assert!(drone.is_on_ground());
    close(drone.height(), 0.0, 1e-4);
    close(drone.state().velocity.norm(), 0.0, 1e-3);
}

#[test]
fn a_hard_landing_is_a_crash() {
    let crash = dropped(3.0).crash().unwrap();
    close(crash.speed, 3.0, 0.02);
    close(crash.tilt, 0.0, 1e-6);
    close(crash.at_ns as f64 * 1e-9, 3.0 / STANDARD_GRAVITY, 0.01);
}

#[test]
fn tipping_over_on_the_ground_is_a_crash_even_when_slow() {
    let vehicle = vehicles::ideal(vehicles::quad());
    let mut drone = Drone::new(&vehicle, Start::default(), &Environment::calm()).unwrap();
    let throttles: Vec<f64> = vehicle
        .motors
        .iter()
        .map(|motor| {
            if motor.arm_angle.sin() > 0.0 {
                0.6
            } else {
                0.0
            }
        })
        .collect();
    fly(&mut drone, 3.0, 1e-3, &throttles);
    assert!(drone.crash().is_some());
}

#[test]
fn falling_upside_down_for_a_second_is_an_upset() {
    let vehicle = vehicles::quad();
    let mut state = State::at_height(100.0);
    state.attitude = UnitQuaternion::from_euler_angles(3.0, 0.0, 0.0);
    let mut drone = Drone::in_state(&vehicle, state, &Environment::calm()).unwrap();
    fly(&mut drone, 0.95, 1e-3, &[0.0; 4]);
    assert_eq!(drone.upset(), None);
    fly(&mut drone, 0.1, 1e-3, &[0.0; 4]);
    close(drone.upset().unwrap() as f64 * 1e-9, 1.0, 0.01);
    assert_eq!(drone.crash(), None);
}

#[test]
fn a_drone_that_fell_from_far_stays_on_the_ground() {
    let drone = dropped(15.0);
    assert!(drone.crash().is_some());
    assert!(drone.height() < 1.0);
}

//! What perfect sensors read.

use std::f64::consts::FRAC_PI_2;

use flight_dynamics::{Drone, Environment, STANDARD_GRAVITY, Start};
use nalgebra::Vector3;

use crate::{close, fly, flying, vehicles};

#[test]
fn the_field_turns_against_the_drone() {
    let vehicle = vehicles::quad();
    let east = Start {
        heading: FRAC_PI_2,
        ..Start::default()
    };
    let drone = Drone::new(&vehicle, east, &Environment::calm()).unwrap();
    // Facing east, north is on the left.
    let field = drone.readings().magnetic_field;
    close((field - Vector3::new(0.0, -0.2, 0.4)).norm(), 0.0, 1e-12);
}

#[test]
fn biases_are_added() {
    let mut vehicle = vehicles::quad();
    vehicle.biases.rates = Vector3::new(0.01, 0.02, 0.03);
    vehicle.biases.specific_force = Vector3::new(0.1, 0.2, 0.3);
    let drone = Drone::new(&vehicle, Start::default(), &Environment::calm()).unwrap();
    close(
        (drone.readings().rates - vehicle.biases.rates).norm(),
        0.0,
        1e-12,
    );
    close(
        drone.readings().specific_force.z,
        0.3 - STANDARD_GRAVITY,
        1e-9,
    );
}

#[test]
fn a_drone_in_flight_shakes_at_the_speed_of_its_rotors() {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.vibration.force = 0.2;
    vehicle
        .motors
        .iter_mut()
        .for_each(|motor| motor.height = 0.0);
    let hover = vehicles::hover(&vehicle);
    let mut drone = flying(&vehicle, 100.0, hover);
    let speed = vehicles::speed_at(&vehicle, hover);
    let (mut sine, mut cosine, mut mean) = (0.0, 0.0, 0.0);
    let steps = 20_000;
    for step in 1..=steps {
        fly(&mut drone, 1e-4, 1e-4, &[hover; 4]);
        let forward = drone.readings().specific_force.x;
        let phase = speed * f64::from(step) * 1e-4;
        sine += forward * phase.sin() * 2.0 / f64::from(steps);
        cosine += forward * phase.cos() * 2.0 / f64::from(steps);
        mean += forward / f64::from(steps);
    }
    // Four phasors of 0.2 m/s2 per N at 2.4 rad from one to the next.
    let thrust = vehicle.mass * STANDARD_GRAVITY / 4.0;
    let sum = (0..4).fold((0.0, 0.0), |(x, y), rotor| {
        let (s, c) = (2.4 * f64::from(rotor)).sin_cos();
        (x + c, y + s)
    });
    let should = 0.2 * thrust * f64::hypot(sum.0, sum.1);
    close(f64::hypot(sine, cosine), should, 0.02 * should);
    close(mean, 0.0, 0.01);
}

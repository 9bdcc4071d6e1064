//! The flight dynamics against hand computation, theory and another simulator.

mod battery;
mod bits;
mod contact;
mod motion;
mod motors;
mod properties;
mod rotorpy;
mod sensors;
mod vehicles;
mod weather;

use flight_dynamics::{Drone, Environment, State, Vehicle};
use nalgebra::Vector3;

/// At `height` m with all rotors at the speed of a share of full throttle.
pub fn flying(vehicle: &Vehicle, height: f64, throttle: f64) -> Drone {
    let mut state = State::at_height(height);
    for speed in state.rotor_speeds.iter_mut().take(vehicle.motors.len()) {
        *speed = vehicles::speed_at(vehicle, throttle);
    }
    Drone::in_state(vehicle, state, &Environment::calm()).unwrap()
}

/// Lets `seconds` pass in steps of `dt` with the same throttles, in still air.
pub fn fly(drone: &mut Drone, seconds: f64, dt: f64, throttles: &[f64]) {
    for _ in 0..(seconds / dt).round() as u64 {
        drone.advance(dt, throttles, Vector3::zeros()).unwrap();
    }
}

/// Fails unless the two are within `tolerance`.
#[track_caller]
pub fn close(is: f64, should: f64, tolerance: f64) {
    assert!(
        (is - should).abs() <= tolerance,
        "{is} should be {should} within {tolerance}"
    );
}

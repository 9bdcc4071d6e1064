//! Same input, same bits; and smaller steps, the same flight.

use flight_dynamics::{Drone, Environment, Gusts, State, Wind};
use nalgebra::Vector3;

use crate::{close, vehicles};

fn gusty() -> Environment {
    let mut environment = Environment::calm();
    environment.wind.mean = Vector3::new(3.0, 2.0, 0.0);
    environment.wind.speed_at_20_ft = 6.0;
    environment.wind.gusts = Some(Gusts {
        mean_interval: 3.0,
        amplitude: 2.0,
        length: 5.0,
    });
    environment
}

fn flown(seed: u64, dt: f64) -> State {
    let (vehicle, environment) = (vehicles::quad(), gusty());
    let hover = vehicles::hover(&vehicle);
    let mut state = State::at_height(50.0);
    let speed = vehicles::speed_at(&vehicle, hover);
    state.rotor_speeds[..4].fill(speed);
    let mut drone = Drone::in_state(&vehicle, state, &environment).unwrap();
    let mut wind = Wind::new(&environment, seed).unwrap();
    for step in 0..(1.0 / dt).round() as u64 {
        let time = step as f64 * dt;
        let push = if (0.25..0.35).contains(&(time + 1e-9)) {
            0.04
        } else {
            0.0
        };
        let throttles = [hover + push, hover + push, hover - push, hover - push];
        // The wind at the start of each millisecond, for all steps alike.
        let air = wind.now();
        wind.advance(dt);
        drone.advance(dt, &throttles, air).unwrap();
    }
    *drone.state()
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    assert_eq!(flown(1, 1e-3), flown(1, 1e-3));
    assert_ne!(flown(1, 1e-3).position, flown(2, 1e-3).position);
}

#[test]
fn steps_of_1_ms_fly_like_steps_of_a_tenth() {
    let (coarse, fine) = (flown(1, 1e-3), flown(1, 1e-4));
    close((coarse.position - fine.position).norm(), 0.0, 2e-3);
    close(coarse.attitude.angle_to(&fine.attitude), 0.0, 2e-3);
}

#[test]
fn in_constant_air_a_millisecond_at_once_or_in_tenths_is_the_same_to_six_digits() {
    let vehicle = vehicles::quad();
    let flown = |dt: f64| {
        let mut drone = crate::flying(&vehicle, 100.0, 0.5);
        let throttles = [0.55, 0.5, 0.52, 0.5];
        crate::fly(&mut drone, 0.5, dt, &throttles);
        *drone.state()
    };
    let (coarse, fine) = (flown(1e-3), flown(1e-4));
    close((coarse.velocity - fine.velocity).norm(), 0.0, 1e-6);
    close(coarse.attitude.angle_to(&fine.attitude), 0.0, 1e-6);
    close((coarse.rates - fine.rates).norm(), 0.0, 1e-6);
}

#[test]
fn the_wind_of_a_seed_does_not_depend_on_how_time_is_cut() {
    let mut coarse = Wind::new(&gusty(), 5).unwrap();
    let mut fine = Wind::new(&gusty(), 5).unwrap();
    for _ in 0..1000 {
        let at_once = coarse.advance(0.025);
        let mut in_parts = Vector3::zeros();
        for _ in 0..25 {
            in_parts = fine.advance(0.001);
        }
        close((at_once - in_parts).norm(), 0.0, 1e-6);
    }
}

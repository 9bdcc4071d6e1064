//! Rigid body: balance, fall, energy and momentum.

use flight_dynamics::{Drag, Drone, Environment, STANDARD_GRAVITY, Spin, State};
use nalgebra::Vector3;

use crate::{close, fly, flying, vehicles};

#[test]
fn thrust_equal_to_weight_holds_every_drone_in_place() {
    for vehicle in [vehicles::quad(), vehicles::hexa(), vehicles::y6()] {
        let vehicle = vehicles::ideal(vehicle);
        let throttle = vehicles::hover(&vehicle);
        let throttles = vec![throttle; vehicle.motors.len()];
        let mut drone = flying(&vehicle, 20.0, throttle);
        fly(&mut drone, 2.0, 1e-3, &throttles);
        close(drone.state().position.z, -20.0, 1e-9);
        close(drone.state().velocity.norm(), 0.0, 1e-9);
        close(drone.state().tilt(), 0.0, 1e-6);
        close(drone.readings().specific_force.z, -STANDARD_GRAVITY, 1e-9);
    }
}

#[test]
fn without_air_a_drone_with_stopped_motors_falls_freely_and_feels_nothing() {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.drag = Drag::none();
    let mut drone = flying(&vehicle, 100.0, 0.0);
    fly(&mut drone, 2.0, 1e-3, &[0.0; 4]);
    close(drone.state().velocity.z, 2.0 * STANDARD_GRAVITY, 1e-9);
    close(
        drone.state().position.z,
        -100.0 + 2.0 * STANDARD_GRAVITY,
        1e-9,
    );
    close(drone.readings().specific_force.norm(), 0.0, 1e-12);
}

#[test]
fn a_falling_drone_reaches_the_speed_at_which_drag_is_weight() {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.drag = Drag::none();
    vehicle.drag.quadratic.z = 0.1;
    let mut drone = flying(&vehicle, 1000.0, 0.0);
    fly(&mut drone, 20.0, 1e-3, &[0.0; 4]);
    // 0.1 v^2 = 1.3 g
    close(
        drone.state().velocity.z,
        (13.0 * STANDARD_GRAVITY).sqrt(),
        1e-3,
    );
}

/// A tumbling body that nothing acts on.
fn tumbling() -> Drone {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.drag = Drag::none();
    vehicle.inertia = Vector3::new(0.02, 0.03, 0.045);
    let mut state = State::at_height(10_000.0);
    state.rates = Vector3::new(3.0, 8.0, 0.5);
    Drone::in_state(&vehicle, state, &Environment::calm()).unwrap()
}

#[test]
fn energy_and_angular_momentum_of_a_body_free_of_moments_are_conserved() {
    let mut drone = tumbling();
    let inertia = drone.vehicle().inertia;
    let energy = |state: &State| 0.5 * state.rates.dot(&inertia.component_mul(&state.rates));
    let momentum = |state: &State| state.attitude * inertia.component_mul(&state.rates);
    let (energy_before, momentum_before) = (energy(drone.state()), momentum(drone.state()));
    fly(&mut drone, 10.0, 1e-3, &[0.0; 4]);
    close(energy(drone.state()) / energy_before, 1.0, 1e-9);
    let change = momentum(drone.state()) - momentum_before;
    close(change.norm() / momentum_before.norm(), 0.0, 1e-8);
}

#[test]
fn more_thrust_on_the_left_rolls_right_and_in_front_pitches_up() {
    let vehicle = vehicles::ideal(vehicles::quad());
    let hover = vehicles::hover(&vehicle);
    let turned = |more: fn(f64) -> f64| {
        let throttles: Vec<f64> = vehicle
            .motors
            .iter()
            .map(|motor| hover + 0.05 * more(motor.arm_angle))
            .collect();
        let mut drone = flying(&vehicle, 20.0, hover);
        fly(&mut drone, 0.1, 1e-3, &throttles);
        drone.state().attitude.euler_angles()
    };
    let (roll, pitch, _) = turned(|angle| -angle.sin().signum());
    assert!(roll > 0.01 && pitch.abs() < 1e-3, "{roll} {pitch}");
    let (roll, pitch, _) = turned(|angle| angle.cos().signum());
    assert!(pitch > 0.01 && roll.abs() < 1e-3, "{roll} {pitch}");
}

#[test]
fn full_authority_of_the_quad_is_what_its_numbers_promise() {
    // Left pair at full thrust, right pair stopped: half of 200 rad/s2, by definition of the
    // authority as that of all motors on one side.
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.drag = Drag::none();
    let mut state = State::at_height(50.0);
    for (speed, motor) in state.rotor_speeds.iter_mut().zip(&vehicle.motors) {
        let is_left = motor.arm_angle.sin() < 0.0;
        *speed = if is_left {
            vehicle.propulsion.full_speed
        } else {
            0.0
        };
    }
    let throttles: Vec<f64> = vehicle
        .motors
        .iter()
        .map(|motor| {
            if motor.arm_angle.sin() < 0.0 {
                1.0
            } else {
                0.0
            }
        })
        .collect();
    let mut drone = Drone::in_state(&vehicle, state, &Environment::calm()).unwrap();
    drone.advance(1e-4, &throttles, Vector3::zeros()).unwrap();
    close(drone.state().rates.x / 1e-4, 100.0, 0.1);
}

#[test]
fn rotors_that_turn_clockwise_push_the_frame_counter_clockwise() {
    let vehicle = vehicles::ideal(vehicles::quad());
    let hover = vehicles::hover(&vehicle);
    let faster = |spin: Spin| -> Vec<f64> {
        let share =
            |motor: &flight_dynamics::Motor| hover + if motor.spin == spin { 0.05 } else { -0.05 };
        vehicle.motors.iter().map(share).collect()
    };
    for (spin, sign) in [(Spin::Clockwise, -1.0), (Spin::CounterClockwise, 1.0)] {
        let mut drone = flying(&vehicle, 20.0, hover);
        fly(&mut drone, 0.2, 1e-3, &faster(spin));
        assert!(drone.state().rates.z * sign > 0.05);
    }
}

/// One clockwise rotor in the middle, without torque of the air.
fn one_rotor() -> flight_dynamics::Vehicle {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.motors.truncate(1);
    vehicle.motors[0].spin = Spin::Clockwise;
    vehicle.motors[0].arm_length = 0.0;
    vehicle.propulsion.torque_per_thrust = 0.0;
    vehicle.drag = Drag::none();
    vehicle
}

#[test]
fn the_momentum_that_a_rotor_gains_is_what_the_frame_loses() {
    let vehicle = one_rotor();
    let mut drone = flying(&vehicle, 20.0, 0.0);
    fly(&mut drone, 0.5, 1e-3, &[0.8]);
    let rotor = vehicle.propulsion.rotor_inertia * drone.state().rotor_speeds[0];
    assert!(rotor > 0.02);
    close(drone.state().rates.z * vehicle.inertia.z, -rotor, 1e-9);
}

#[test]
fn a_rolling_drone_with_a_clockwise_rotor_is_turned_up_by_gyroscopic_moment() {
    // M = -w x h: rolling right (+x) with spin about down (+z): -(x cross z) = +y, nose up.
    let vehicle = one_rotor();
    let throttle = 0.5;
    let mut state = State::at_height(50.0);
    state.rotor_speeds[0] = vehicles::speed_at(&vehicle, throttle);
    state.rates.x = 2.0;
    let mut drone = Drone::in_state(&vehicle, state, &Environment::calm()).unwrap();
    fly(&mut drone, 1e-3, 1e-4, &[throttle]);
    let spin = vehicle.propulsion.rotor_inertia * state.rotor_speeds[0];
    let should = 2.0 * spin / vehicle.inertia.y * 1e-3;
    close(drone.state().rates.y, should, should * 1e-3);
}

#[test]
fn wind_carries_a_hovering_drone_along() {
    let vehicle = vehicles::ideal(vehicles::quad());
    let hover = vehicles::hover(&vehicle);
    let mut drone = flying(&vehicle, 50.0, hover);
    let wind = Vector3::new(0.0, 5.0, 0.0);
    for _ in 0..500 {
        drone.advance(1e-3, &[hover; 4], wind).unwrap();
    }
    assert!(drone.state().velocity.y > 0.05);
    close(drone.state().velocity.x, 0.0, 1e-3);
}

//! Battery: voltage, sag, energy.

use std::f64::consts::PI;

use crate::{close, fly, flying, vehicles};

#[test]
fn voltage_follows_the_table_and_sags_with_power() {
    let battery = vehicles::battery();
    close(battery.open_circuit_voltage(1.0), 16.8, 1e-12);
    close(battery.open_circuit_voltage(0.9), 4.0 * 4.11, 1e-12);
    close(battery.open_circuit_voltage(0.0), 13.2, 1e-12);
    // 10 A at 0.03 ohm: 0.3 V of 16.8 V, 165 W at the terminals.
    close(battery.voltage(1.0, 165.0), 16.5, 1e-12);
    // More than it can give.
    close(battery.voltage(1.0, 1e6), 8.4, 1e-12);
}

#[test]
fn power_of_hovering_is_that_of_momentum_theory() {
    let vehicle = vehicles::ideal(vehicles::quad());
    let hover = vehicles::hover(&vehicle);
    let drone = flying(&vehicle, 50.0, hover);
    let thrust = vehicle.mass * 9.80665 / 4.0;
    let area = PI * 0.127 * 0.127;
    let ideal = thrust.powf(1.5) / (2.0 * 1.225 * area).sqrt();
    close(drone.power(), 4.0 * ideal / 0.5 + 5.0, 1e-9);
    // The size of it: 130 to 150 W, about 110 W per kg.
    assert!((100.0..200.0).contains(&drone.power()), "{}", drone.power());
}

/// Copper losses of activity: what a rotor of 4e-5 kg m2 takes to change its speed heats windings by
/// the mean square of that torque, over the square of the motor constant.
#[test]
fn a_restless_throttle_heats_the_windings_by_the_square_of_its_torque() {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    let hover = vehicles::hover(&vehicle);
    let mut power = |motor_constant: f64| {
        vehicle.propulsion.motor_constant = motor_constant;
        let mut drone = flying(&vehicle, 500.0, hover);
        let (mut mean, mut square) = (0.0, 0.0);
        const STEPS: i32 = 4000;
        for step in 0..STEPS {
            let restless = hover + if step / 10 % 2 == 0 { 0.03 } else { -0.03 };
            let before = drone.state().rotor_speeds[0];
            fly(&mut drone, 1e-3, 1e-3, &[restless; 4]);
            let torque = 4e-5 * (drone.state().rotor_speeds[0] - before) * 1e3;
            mean += drone.power() / f64::from(STEPS);
            square += torque * torque / f64::from(STEPS);
        }
        (mean, square)
    };
    let ((cold, square), (warm, _)) = (power(100.0), power(0.033));
    let expected = 4.0 * square / (0.033 * 0.033);
    assert!(expected > 0.1, "{expected}");
    close((warm - cold) / expected, 1.0, 0.1);
}

#[test]
fn a_rotor_that_brakes_gives_nothing_back() {
    let vehicle = vehicles::ideal(vehicles::quad());
    let mut drone = flying(&vehicle, 500.0, 1.0);
    fly(&mut drone, 1e-3, 1e-3, &[0.0; 4]);
    close(drone.power(), vehicle.propulsion.electronics, 1e-12);
}

#[test]
fn thrust_falls_with_the_square_of_the_voltage() {
    let mut vehicle = vehicles::quad();
    vehicle.esc.steps = None;
    let mut drone = flying(&vehicle, 500.0, 0.5);
    fly(&mut drone, 1.0, 1e-3, &[0.5; 4]);
    let relative = drone.voltage() / 16.8;
    assert!(relative < 0.99);
    let speed = drone.state().rotor_speeds[0] / vehicles::speed_at(&vehicle, 0.5);
    close(speed, relative, 1e-4);
}

#[test]
fn energy_and_charge_drawn_add_up() {
    let mut vehicle = vehicles::quad();
    vehicle.battery.capacity = 0.5;
    let hover = vehicles::hover(&vehicle);
    let mut drone = flying(&vehicle, 5000.0, hover);
    let (mut energy, mut charge) = (0.0, 0.0);
    for _ in 0..60_000 {
        let (before, current) = (drone.power(), drone.power() / drone.voltage());
        fly(&mut drone, 1e-3, 1e-3, &[hover; 4]);
        energy += 0.5e-3 * (before + drone.power());
        charge += 0.5e-3 * (current + drone.power() / drone.voltage());
    }
    assert!(energy > 5000.0);
    // The first steps, in which rotors give way to the sag, are coarse for a trapezium.
    close(drone.state().energy_used / energy, 1.0, 2e-5);
    close(drone.state().state_of_charge, 1.0 - charge / 1800.0, 1e-5);
    assert!(drone.state().state_of_charge < 0.9);
}

#[test]
fn an_empty_battery_stops_the_motors() {
    let mut vehicle = vehicles::quad();
    vehicle.battery.capacity = 0.005;
    let mut drone = flying(&vehicle, 5000.0, 0.5);
    fly(&mut drone, 10.0, 1e-3, &[0.5; 4]);
    assert_eq!(drone.state().state_of_charge, 0.0);
    assert!(drone.state().rotor_speeds[0] < 1.0);
}

//! Three drones to fly in tests.

use std::f64::consts::PI;

use flight_dynamics::{
    Battery, Biases, Drag, Esc, Motor, Propulsion, STANDARD_GRAVITY, Skids, Spin, Vehicle,
    Vibration,
};
use nalgebra::Vector3;

use Spin::{Clockwise, CounterClockwise};

/// Motors evenly around, `half` of a step off forward, of alternating spin.
fn ring(count: usize, length: f64) -> Vec<Motor> {
    let step = 2.0 * PI / count as f64;
    (0..count)
        .map(|motor| Motor {
            arm_angle: step * (motor as f64 + 0.5),
            arm_length: length,
            height: 0.02,
            spin: if motor % 2 == 0 {
                CounterClockwise
            } else {
                Clockwise
            },
            efficiency: 1.0,
        })
        .collect()
}

/// Four cells of a lithium-polymer battery, 5 Ah.
pub fn battery() -> Battery {
    Battery {
        cells: 4,
        open_circuit: vec![
            [0.0, 3.3],
            [0.1, 3.68],
            [0.3, 3.77],
            [0.5, 3.84],
            [0.8, 4.02],
            [1.0, 4.2],
        ],
        resistance: 0.03,
        capacity: 5.0,
    }
}

/// A quad X of 1.3 kg that lifts 2.8 times its weight.
///
/// All thrust at the arm over root 2 turns it at 200 rad/s2 in roll and pitch, all torque at 30
/// in yaw.
pub fn quad() -> Vehicle {
    let (mass, arm) = (1.3, 0.225);
    let lift = 2.8 * mass * STANDARD_GRAVITY;
    let roll = lift * arm / 2.0_f64.sqrt() / 200.0;
    let yaw = 0.045;
    Vehicle {
        mass,
        inertia: Vector3::new(roll, roll, yaw),
        motors: ring(4, arm),
        propulsion: Propulsion {
            full_thrust: lift / 4.0,
            full_speed: 900.0,
            expo: 0.65,
            torque_per_thrust: 30.0 * yaw / lift,
            lag_up: 0.025,
            lag_down: 0.025,
            rotor_inertia: 4e-5,
            rotor_radius: 0.127,
            motor_constant: 0.033,
            figure_of_merit: 0.5,
            electronics: 5.0,
        },
        drag: Drag {
            linear: Vector3::new(0.05, 0.05, 0.08),
            quadratic: Vector3::new(0.015, 0.015, 0.03),
            rotor_across: 1e-4,
            rotor_along: 1e-4,
            rotational: Vector3::new(0.002, 0.002, 0.002),
        },
        esc: Esc::default(),
        battery: battery(),
        vibration: Vibration {
            force: 0.1,
            force_double: 0.15,
            rate: 0.004,
            rate_double: 0.002,
        },
        skids: Skids {
            reach: 0.12,
            height: 0.12,
            friction: 0.6,
        },
        biases: Biases::default(),
    }
}

/// A hexa X of 2.6 kg.
pub fn hexa() -> Vehicle {
    let mut hexa = quad();
    hexa.mass = 2.6;
    hexa.motors = ring(6, 0.3);
    hexa.inertia = Vector3::new(0.05, 0.05, 0.09);
    hexa.propulsion.full_thrust = 2.4 * hexa.mass * STANDARD_GRAVITY / 6.0;
    hexa
}

/// A Y6 of 2.4 kg: three arms with an upper and a lower rotor each.
pub fn y6() -> Vehicle {
    let mut y6 = quad();
    y6.mass = 2.4;
    y6.inertia = Vector3::new(0.045, 0.045, 0.07);
    y6.propulsion.full_thrust = 2.4 * y6.mass * STANDARD_GRAVITY / 5.4;
    let arms = [PI / 3.0, PI, -PI / 3.0];
    let motor = |arm_angle, spin, height, efficiency| Motor {
        arm_angle,
        arm_length: 0.28,
        height,
        spin,
        efficiency,
    };
    y6.motors = arms
        .into_iter()
        .flat_map(|arm| {
            [
                motor(arm, Clockwise, 0.04, 1.0),
                motor(arm, CounterClockwise, -0.02, 0.8),
            ]
        })
        .collect();
    y6
}

/// Without what is not rigid: full resolution, steady battery, no vibration.
pub fn ideal(mut vehicle: Vehicle) -> Vehicle {
    vehicle.esc.steps = None;
    vehicle.battery = Battery::ideal(vehicle.battery.open_circuit_voltage(1.0));
    vehicle.vibration = Vibration::default();
    vehicle
}

/// Share of full throttle at which thrust is weight, with no sag.
pub fn hover(vehicle: &Vehicle) -> f64 {
    let efficiencies: f64 = vehicle.motors.iter().map(|motor| motor.efficiency).sum();
    let lift = efficiencies * vehicle.propulsion.full_thrust;
    throttle_for(vehicle, vehicle.mass * STANDARD_GRAVITY / lift)
}

/// Share of full throttle for a share of full thrust.
pub fn throttle_for(vehicle: &Vehicle, thrust: f64) -> f64 {
    let e = vehicle.propulsion.expo;
    if e == 0.0 {
        return thrust;
    }
    let line = 1.0 - e;
    ((line * line + 4.0 * e * thrust).sqrt() - line) / (2.0 * e)
}

/// Speed of the rotors at a share of full throttle with no sag, rad/s.
pub fn speed_at(vehicle: &Vehicle, throttle: f64) -> f64 {
    vehicle.propulsion.full_speed * vehicle.propulsion.thrust_share(throttle).sqrt()
}

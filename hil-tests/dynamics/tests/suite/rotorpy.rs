//! The same flight in RotorPy, an independent simulator.
//!
//! Needs Python with `rotorpy` 3.0.0 (`pip install rotorpy`); `REFLEX_PYTHON` names the Python,
//! otherwise it is `python3`. Without either the test says so and passes.

use std::env;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

use flight_dynamics::{Drone, Environment, State, Vehicle};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::vehicles;

/// Time for which a command holds, s.
const STEP: f64 = 0.01;
/// Length of the flight, s.
const SECONDS: f64 = 5.0;
const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/rotorpy_flight.py");

/// Velocity of the air, north east down, m/s.
fn wind() -> Vector3<f64> {
    Vector3::new(0.5, -0.4, 0.3)
}

fn python() -> Option<String> {
    let python = env::var("REFLEX_PYTHON").unwrap_or_else(|_| "python3".into());
    let import = Command::new(&python)
        .args(["-c", "import rotorpy.vehicles.multirotor"])
        .output();
    if import.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    println!(
        "skipped: {python} cannot import rotorpy; install it and name its Python in REFLEX_PYTHON"
    );
    None
}

/// A quad of unequal axes, without what RotorPy does not know.
fn vehicle() -> Vehicle {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.inertia = Vector3::new(0.022, 0.028, 0.045);
    vehicle.drag.linear = Vector3::zeros();
    vehicle.drag.rotational = Vector3::zeros();
    vehicle.drag.quadratic = Vector3::new(0.02, 0.03, 0.05);
    vehicle.drag.rotor_across = 1e-4;
    vehicle.drag.rotor_along = 2e-4;
    vehicle.propulsion.rotor_inertia = 0.0;
    // Rotors' drag over the centre of mass turns the drone away; nothing here steers against it.
    vehicle
        .motors
        .iter_mut()
        .for_each(|motor| motor.height = 0.01);
    vehicle
}

/// 1, -1, -1, 1 in quarters of `length` from `start`: turns away, back and stops.
fn doublet(time: f64, start: f64, length: f64) -> f64 {
    match ((time - start) / length * 4.0).floor() {
        0.0 | 3.0 => 1.0,
        1.0 | 2.0 => -1.0,
        _ => 0.0,
    }
}

/// Throttles around hover that excite thrust and all axes, apart and together.
fn throttles(vehicle: &Vehicle, time: f64) -> Vec<f64> {
    let hover = vehicles::hover(vehicle);
    let roll = 0.03 * (doublet(time, 0.2, 0.8) - doublet(time, 3.0, 0.8));
    let pitch = 0.03 * (doublet(time, 1.0, 0.8) - doublet(time, 3.2, 0.8));
    let yaw = 0.06 * (doublet(time, 1.8, 1.2) + doublet(time, 3.4, 1.2));
    let thrust = 0.05 * (doublet(time, 0.6, 1.6) - doublet(time, 2.6, 1.6));
    vehicle
        .motors
        .iter()
        .map(|motor| {
            let (sine, cosine) = motor.arm_angle.sin_cos();
            hover + thrust - roll * sine + pitch * cosine - yaw * motor.spin.sign()
        })
        .collect()
}

/// Parameters and commands for the script, with y and z turned over.
fn input(vehicle: &Vehicle, commands: &[Vec<f64>]) -> String {
    let mut text = String::new();
    let propulsion = &vehicle.propulsion;
    let thrust = propulsion.full_thrust / propulsion.full_speed.powi(2);
    let mut line = |name: &str, values: &[f64]| {
        let values: Vec<_> = values.iter().map(f64::to_string).collect();
        writeln!(text, "{name} {}", values.join(" ")).unwrap();
    };
    let hub = |motor: &flight_dynamics::Motor| {
        let (sine, cosine) = motor.arm_angle.sin_cos();
        let length = motor.arm_length;
        [length * cosine, -length * sine, motor.height]
    };
    let hubs: Vec<_> = vehicle.motors.iter().flat_map(hub).collect();
    let spins: Vec<_> = vehicle.motors.iter().map(|m| m.spin.sign()).collect();
    line("mass", &[vehicle.mass]);
    line("inertia", vehicle.inertia.as_slice());
    line("motors", &[vehicle.motors.len() as f64]);
    line("hubs", &hubs);
    line("spins", &spins);
    line("thrust", &[thrust]);
    line("torque", &[thrust * propulsion.torque_per_thrust]);
    line("lag", &[propulsion.lag_up]);
    line("drag", vehicle.drag.quadratic.as_slice());
    line("across", &[vehicle.drag.rotor_across]);
    line("along", &[vehicle.drag.rotor_along]);
    line("wind", &[wind().x, -wind().y, -wind().z]);
    line("fly", &[STEP]);
    for command in commands {
        let speeds: Vec<_> = command
            .iter()
            .map(|throttle| vehicles::speed_at(vehicle, *throttle).to_string())
            .collect();
        writeln!(text, "{}", speeds.join(" ")).unwrap();
    }
    text
}

/// Attitude and velocity of one instant.
type Flown = (UnitQuaternion<f64>, Vector3<f64>);

fn in_rotorpy(python: &str, input: &str) -> Vec<Flown> {
    let mut child = Command::new(python)
        .arg(SCRIPT)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(input.as_bytes()).unwrap();
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{SCRIPT} failed");
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines()
        .map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
            let [w, x, y, z, north, west, up] = numbers[..] else {
                panic!("7 numbers expected: {line}");
            };
            let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, x, -y, -z));
            (attitude, Vector3::new(north, -west, -up))
        })
        .collect()
}

fn here(vehicle: &Vehicle, commands: &[Vec<f64>]) -> Vec<Flown> {
    let mut state = State::at_height(100.0);
    for (speed, throttle) in state.rotor_speeds.iter_mut().zip(&commands[0]) {
        *speed = vehicles::speed_at(vehicle, *throttle);
    }
    let mut drone = Drone::in_state(vehicle, state, &Environment::calm()).unwrap();
    let fly = |command: &Vec<f64>| {
        drone.advance(STEP, command, wind()).unwrap();
        (drone.state().attitude, drone.state().velocity)
    };
    commands.iter().map(fly).collect()
}

#[test]
fn five_seconds_on_all_axes_are_those_of_rotorpy() {
    let vehicle = vehicle();
    let steps = (SECONDS / STEP).round() as u32;
    let commands: Vec<_> = (0..steps)
        .map(|step| throttles(&vehicle, f64::from(step) * STEP))
        .collect();
    let ours = here(&vehicle, &commands);
    let tilt = |flown: &Flown| (flown.0 * Vector3::z()).angle(&Vector3::z());
    let most = ours.iter().map(tilt).fold(0.0, f64::max).to_degrees();
    assert!((5.0..60.0).contains(&most), "leant by {most} degrees");
    let Some(python) = python() else { return };
    let theirs = in_rotorpy(&python, &input(&vehicle, &commands));
    assert_eq!(theirs.len(), ours.len());
    let (mut attitude, mut velocity) = (0.0_f64, 0.0_f64);
    for (our, their) in ours.iter().zip(&theirs) {
        attitude = attitude.max(our.0.angle_to(&their.0).to_degrees());
        velocity = velocity.max((our.1 - their.1).norm());
    }
    println!(
        "leant by up to {most:.1} degrees; against RotorPy at most {attitude:.3e} degrees and \
         {velocity:.3e} m/s apart"
    );
    assert!(attitude < 1.0 && velocity < 0.05);
}

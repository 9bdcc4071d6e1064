//! Equations of motion: what changes, at a given instant, and how fast.

use std::cell::Cell;

use differential_equations::ode::ODE;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::battery::Battery;
use crate::frame::Frame;
use crate::ground::{Anchors, Ground, Pose};
use crate::state::State;
use crate::vehicle::{MAX_MOTORS, STANDARD_GRAVITY};

/// What is integrated, in a row; the order is that of the constants below.
pub type Flat = [f64; SPEEDS + MAX_MOTORS];

const POSITION: usize = 0;
const VELOCITY: usize = 3;
const ATTITUDE: usize = 6;
const RATES: usize = 10;
const CHARGE: usize = 13;
const ENERGY: usize = 14;
const SPEEDS: usize = 15;

/// What acts on the drone at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Loads {
    /// All forces but weight, body axes, N.
    pub force: Vector3<f64>,
    /// Electric power drawn, W.
    pub power: f64,
    /// Voltage at the battery's terminals, V.
    pub volts: f64,
}

/// The equations of one step, with constant throttles, wind and anchors.
pub struct Motion<'a> {
    /// The vehicle.
    pub frame: &'a Frame,
    /// The ground under it.
    pub ground: &'a Ground,
    /// Where its feet hold.
    pub anchors: &'a Anchors,
    /// Velocity of the air, earth axes, m/s.
    pub wind: Vector3<f64>,
    /// Speeds that the motors seek at the full battery's voltage, rad/s.
    pub sought: [f64; MAX_MOTORS],
    /// The battery's open-circuit voltage, V; charge hardly changes in a step.
    pub open_voltage: f64,
    /// What acted at the instant looked at last.
    pub loads: Cell<Loads>,
}

impl Motion<'_> {
    /// Accelerations of the rotors, rad/s2, and the battery's load and voltage.
    ///
    /// Rotors seek the speed that the voltage of steady ones allows: their own acceleration, which
    /// pulls it down for as long as they lag, would make a loop without time in it.
    fn drive(&self, charge: f64, speeds: &[f64], rates: &mut [f64]) -> (f64, f64) {
        let frame = self.frame;
        let battery: &Battery = &frame.vehicle.battery;
        let under = |power| battery.under_load(self.open_voltage, power);
        let volts = under(frame.steady_power(speeds));
        // An empty battery's controllers switch off.
        let relative = if charge > 0.0 {
            volts / frame.full_voltage
        } else {
            0.0
        };
        let propulsion = &frame.vehicle.propulsion;
        let (up, down) = (1.0 / propulsion.lag_up, 1.0 / propulsion.lag_down);
        for ((rate, sought), speed) in rates.iter_mut().zip(&self.sought).zip(speeds) {
            let missing = sought * relative - speed;
            *rate = missing * if missing > 0.0 { up } else { down };
        }
        let power = frame.working_power(speeds, rates);
        (power, under(power))
    }

    /// Angular acceleration in body axes, rad/s2 (Euler, with the rotors' spin).
    fn turn(
        &self,
        moment: Vector3<f64>,
        rates: &Vector3<f64>,
        speeds: &[f64],
        spin_up: &[f64],
    ) -> Vector3<f64> {
        let (mut speed, mut change) = (0.0, 0.0);
        for ((rotor, rate), of) in self.frame.rotors.iter().zip(spin_up).zip(speeds) {
            speed += rotor.spin * of;
            change += rotor.spin * rate;
        }
        let vehicle = &self.frame.vehicle;
        let inertia = vehicle.propulsion.rotor_inertia;
        let mut momentum = vehicle.inertia.component_mul(rates);
        momentum.z += inertia * speed;
        let mut net = moment - rates.cross(&momentum);
        net.z -= inertia * change;
        net.component_mul(&self.frame.inverse_inertia)
    }
}

impl ODE<f64, Flat> for Motion<'_> {
    fn diff(&self, _time: f64, now: &Flat, change: &mut Flat) {
        let motors = self.frame.rotors.len();
        let velocity = vector(now, VELOCITY);
        let rates = vector(now, RATES);
        let speeds = &now[SPEEDS..SPEEDS + motors];
        let quaternion = quaternion(now);
        let pose = Pose {
            position: vector(now, POSITION),
            velocity,
            to_earth: *UnitQuaternion::new_unchecked(quaternion)
                .to_rotation_matrix()
                .matrix(),
            rates,
        };

        let (flat, spin_up) = change.split_at_mut(SPEEDS);
        let spin_up = &mut spin_up[..motors];
        let (power, volts) = self.drive(now[CHARGE], speeds, spin_up);
        let air = pose.to_earth.tr_mul(&(velocity - self.wind));
        let mut wrench = self.frame.in_the_air(&air, &rates, speeds);
        self.ground.push(&pose, self.anchors, &mut wrench);
        self.loads.set(Loads {
            force: wrench.force,
            power,
            volts,
        });

        let mut acceleration = pose.to_earth * (wrench.force / self.frame.vehicle.mass);
        acceleration.z += STANDARD_GRAVITY;
        put(flat, POSITION, &velocity);
        put(flat, VELOCITY, &acceleration);
        let turning = quaternion * Quaternion::from_imag(rates * 0.5);
        flat[ATTITUDE] = turning.w;
        put(flat, ATTITUDE + 1, &turning.imag());
        let turn = self.turn(wrench.moment, &rates, speeds, spin_up);
        put(flat, RATES, &turn);
        flat[CHARGE] = -power / (volts * self.frame.vehicle.battery.ampere_seconds());
        flat[ENERGY] = power;
    }
}

fn vector(flat: &Flat, at: usize) -> Vector3<f64> {
    Vector3::new(flat[at], flat[at + 1], flat[at + 2])
}

fn quaternion(flat: &Flat) -> Quaternion<f64> {
    let imaginary = vector(flat, ATTITUDE + 1);
    Quaternion::from_parts(flat[ATTITUDE], imaginary)
}

fn put(flat: &mut [f64], at: usize, vector: &Vector3<f64>) {
    flat[at..at + 3].copy_from_slice(vector.as_slice());
}

/// What of a state is integrated.
pub fn flatten(state: &State) -> Flat {
    let mut flat = [0.0; SPEEDS + MAX_MOTORS];
    put(&mut flat, POSITION, &state.position);
    put(&mut flat, VELOCITY, &state.velocity);
    flat[ATTITUDE] = state.attitude.w;
    put(&mut flat, ATTITUDE + 1, &state.attitude.imag());
    put(&mut flat, RATES, &state.rates);
    flat[CHARGE] = state.state_of_charge;
    flat[ENERGY] = state.energy_used;
    flat[SPEEDS..].copy_from_slice(&state.rotor_speeds);
    flat
}

/// Takes over what was integrated; time and phases are the caller's.
pub fn unflatten(flat: &Flat, state: &mut State) {
    state.position = vector(flat, POSITION);
    state.velocity = vector(flat, VELOCITY);
    state.attitude = UnitQuaternion::new_normalize(quaternion(flat));
    state.rates = vector(flat, RATES);
    state.state_of_charge = flat[CHARGE].max(0.0);
    state.energy_used = flat[ENERGY];
    state.rotor_speeds.copy_from_slice(&flat[SPEEDS..]);
}

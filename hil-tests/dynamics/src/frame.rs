//! A vehicle in its air: what does not change in flight, worked out once.

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::environment::Environment;
use crate::vehicle::{Motor, Vehicle};

/// One rotor, its coefficients worked out.
#[derive(Clone, Debug)]
pub struct Rotor {
    /// Hub in body axes, m.
    pub at: Vector3<f64>,
    /// 1 clockwise from above, -1 counter-clockwise.
    pub spin: f64,
    /// Thrust, N per (rad/s)^2.
    pub thrust: f64,
    /// Torque of the air, N m per (rad/s)^2.
    torque: f64,
    /// Electric power at a steady speed, W per (rad/s)^3.
    power: f64,
    /// Moment of inertia about the axis, kg m2.
    inertia: f64,
    /// Heat of the windings, W per (N m)^2.
    heat: f64,
}

impl Rotor {
    fn new(motor: &Motor, vehicle: &Vehicle, air_density: f64) -> Self {
        let of = &vehicle.propulsion;
        let (sine, cosine) = motor.arm_angle.sin_cos();
        let free = of.full_thrust / (of.full_speed * of.full_speed);
        let area = PI * of.rotor_radius * of.rotor_radius;
        let ideal = free.powf(1.5) / (2.0 * air_density * area).sqrt();
        Self {
            at: Vector3::new(
                motor.arm_length * cosine,
                motor.arm_length * sine,
                -motor.height,
            ),
            spin: motor.spin.sign(),
            thrust: free * motor.efficiency,
            // A rotor in another's wake keeps its torque and power and loses thrust.
            torque: free * of.torque_per_thrust,
            power: ideal / of.figure_of_merit,
            inertia: of.rotor_inertia,
            heat: of.motor_constant.powi(-2),
        }
    }

    fn steady_power(&self, speed: f64) -> f64 {
        self.power * speed * speed * speed
    }

    /// Power at a speed in rad/s that changes by so much, in rad/s2.
    ///
    /// The figure of merit has the copper losses of a steady speed. Acceleration adds the rotor's
    /// energy, and what its current heats the windings more. A rotor that brakes gives nothing back.
    fn working_power(&self, speed: f64, change: f64) -> f64 {
        let torque = self.torque * speed * speed;
        let more = self.inertia * change;
        let heat = self.heat * more * (2.0 * torque + more);
        (self.steady_power(speed) + more * speed + heat).max(0.0)
    }
}

/// A vehicle in its air, ready to be integrated.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its parameters.
    pub vehicle: Vehicle,
    /// Its rotors.
    pub rotors: Vec<Rotor>,
    /// Inverse of the moments of inertia, 1/(kg m2).
    pub inverse_inertia: Vector3<f64>,
    /// Open-circuit voltage of the full battery, V.
    pub full_voltage: f64,
}

/// Force and moment in body axes, N and N m.
#[derive(Clone, Copy, Debug)]
pub struct Wrench {
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

impl Frame {
    /// Works out what does not change in flight.
    pub fn new(vehicle: &Vehicle, environment: &Environment) -> Self {
        let rotor = |motor| Rotor::new(motor, vehicle, environment.air_density);
        Self {
            rotors: vehicle.motors.iter().map(rotor).collect(),
            inverse_inertia: vehicle.inertia.map(|axis| 1.0 / axis),
            full_voltage: vehicle.battery.open_circuit_voltage(1.0),
            vehicle: vehicle.clone(),
        }
    }

    /// Electric power at these rotor speeds, were they steady, W.
    pub fn steady_power(&self, speeds: &[f64]) -> f64 {
        let rotors = self.rotors.iter().zip(speeds);
        let motors: f64 = rotors
            .map(|(rotor, speed)| rotor.steady_power(*speed))
            .sum();
        motors + self.vehicle.propulsion.electronics
    }

    /// Electric power at these rotor speeds, which change so fast, W.
    pub fn working_power(&self, speeds: &[f64], changes: &[f64]) -> f64 {
        let rotors = self.rotors.iter().zip(speeds).zip(changes);
        let motors: f64 = rotors
            .map(|((rotor, speed), change)| rotor.working_power(*speed, *change))
            .sum();
        motors + self.vehicle.propulsion.electronics
    }

    /// What air and rotors do at a velocity `air` through the air, body axes.
    pub fn in_the_air(&self, air: &Vector3<f64>, rates: &Vector3<f64>, speeds: &[f64]) -> Wrench {
        let drag = &self.vehicle.drag;
        let along = drag.linear + drag.quadratic * air.norm();
        let mut force = -along.component_mul(air);
        let mut moment = -drag.rotational.component_mul(rates);
        for (rotor, &speed) in self.rotors.iter().zip(speeds) {
            let hub = air + rates.cross(&rotor.at);
            let across = -drag.rotor_across * speed;
            let square = speed * speed;
            let thrust = rotor.thrust * square + drag.rotor_along * speed * hub.z;
            let at_hub = Vector3::new(across * hub.x, across * hub.y, -thrust);
            force += at_hub;
            moment += rotor.at.cross(&at_hub);
            // The air brakes the rotor; its motor holds against that and pushes the frame back.
            moment.z -= rotor.spin * rotor.torque * square;
        }
        Wrench { force, moment }
    }
}

//! A multirotor's parameters, with units, ranges and what they mean.

use nalgebra::Vector3;

use crate::battery::Battery;
use crate::range::{Unfit, all_within, within};

/// Acceleration of free fall, m/s2 (ISO 80000-3).
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// Most motors of a vehicle.
pub const MAX_MOTORS: usize = 8;

/// All parameters of a drone, whose principal axes are forward, right and down.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Mass, kg, 0.01 to 1000.
    pub mass: f64,
    /// Moments of inertia about forward, right and down, kg m2, above 0.
    pub inertia: Vector3<f64>,
    /// Where the motors are, 1 to [`MAX_MOTORS`], in the order of the throttles.
    pub motors: Vec<Motor>,
    /// What a motor with its rotor does.
    pub propulsion: Propulsion,
    /// What the air does to frame and rotors.
    pub drag: Drag,
    /// How a motor controller reads its pulses.
    pub esc: Esc,
    /// What feeds the motors.
    pub battery: Battery,
    /// What sensors read of the rotors' imbalance.
    pub vibration: Vibration,
    /// What the drone stands on.
    pub skids: Skids,
    /// What sensors read at rest beside the truth.
    pub biases: Biases,
}

/// The way a rotor turns, seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spin {
    /// Clockwise: positive about down. The frame is pushed the other way.
    Clockwise,
    /// Counter-clockwise.
    CounterClockwise,
}

impl Spin {
    /// 1 for clockwise, -1 for counter-clockwise.
    pub fn sign(self) -> f64 {
        match self {
            Self::Clockwise => 1.0,
            Self::CounterClockwise => -1.0,
        }
    }
}

/// Place and kind of one motor, whose thrust points up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Direction of the arm, rad clockwise from forward seen from above.
    pub arm_angle: f64,
    /// Distance of the axis from the centre of mass, m, 0 to 10.
    pub arm_length: f64,
    /// Height of the rotor above the centre of mass, m, -2 to 2.
    pub height: f64,
    /// The way it turns.
    pub spin: Spin,
    /// Thrust as a share of a free rotor's at the same speed and power, 0.01 to 1;
    /// about 0.8 for the lower of two coaxial rotors.
    pub efficiency: f64,
}

/// A motor with its rotor; all are alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Propulsion {
    /// Thrust of one rotor at full throttle, N, with no sag of a full battery.
    pub full_thrust: f64,
    /// Speed of the rotor then, rad/s, 1 to 20000.
    pub full_speed: f64,
    /// Bend `e` of the thrust curve, 0 to 1.
    ///
    /// At the share `s` of full throttle the thrust's share is `(1 - e) s + e s^2` (ArduPilot's
    /// MOT_THST_EXPO; about 0.65 measured for common rotors).
    pub expo: f64,
    /// Torque of a rotor over its thrust, m, 0 to 1; about 0.015 to 0.04.
    pub torque_per_thrust: f64,
    /// Time constant of the rotor's speed when it rises, s, 0.002 to 2.
    pub lag_up: f64,
    /// Time constant of the rotor's speed when it falls, s, 0.002 to 2.
    pub lag_down: f64,
    /// Moment of inertia of rotor and bell about the axis, kg m2, 0 and more.
    pub rotor_inertia: f64,
    /// Radius of the rotor, m, 0.01 to 5.
    pub rotor_radius: f64,
    /// Torque of a motor per root of the heat in its windings, N m/W^0.5, 0.001 to 100.
    ///
    /// The motor constant `Km`: torque per current over the root of the resistance.
    pub motor_constant: f64,
    /// Ideal power of hovering over electric power, 0.05 to 1.
    ///
    /// That of rotor, motor and controller together at a steady speed. Electric power is that of momentum theory,
    /// `T^1.5 / sqrt(2 density area)`, over this.
    pub figure_of_merit: f64,
    /// Power of the electronics, W, 0 to 1000.
    pub electronics: f64,
}

/// Forces and moments against the motion through the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// Drag of the frame per axis, N per m/s.
    pub linear: Vector3<f64>,
    /// Drag of the frame per axis, N per (m/s)^2: times speed times component.
    pub quadratic: Vector3<f64>,
    /// Drag of a rotor across its axis (H-force), at its hub, N per m/s and rad/s.
    ///
    /// Blade element theory has it proportional to the rotor's speed, the root of its thrust.
    pub rotor_across: f64,
    /// Loss of thrust of a rotor that climbs (inflow), N per m/s and rad/s.
    pub rotor_along: f64,
    /// Damping of the frame's turning per axis, N m per rad/s.
    pub rotational: Vector3<f64>,
}

impl Drag {
    /// A vacuum.
    pub fn none() -> Self {
        Self {
            linear: Vector3::zeros(),
            quadratic: Vector3::zeros(),
            rotor_across: 0.0,
            rotor_along: 0.0,
            rotational: Vector3::zeros(),
        }
    }
}

/// How a motor controller reads its pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Esc {
    /// Steps from 0 to full throttle, both counted, 2 and more; 256 for 8 bits.
    ///
    /// `None` resolves everything.
    pub steps: Option<u32>,
    /// Shares of full throttle below this leave the motor standing, 0 to 0.5.
    pub dead_zone: f64,
}

impl Default for Esc {
    /// 8 bits and no dead zone.
    fn default() -> Self {
        Self {
            steps: Some(256),
            dead_zone: 0.0,
        }
    }
}

impl Esc {
    /// The share of full throttle that a motor gets of the share it was sent.
    pub fn reads(&self, share: f64) -> f64 {
        let read = match self.steps {
            None => share,
            Some(steps) => {
                let top = f64::from(steps) - 1.0;
                (share * top).round() / top
            }
        };
        if read < self.dead_zone { 0.0 } else { read }
    }
}

/// What sensors read of each rotor, in proportion to its thrust.
///
/// Imbalance turns with the rotor in its plane; the blades' passage, at twice the speed for two
/// blades, shakes along the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vibration {
    /// Specific force across the axis, m/s2 per N of the rotor's thrust.
    pub force: f64,
    /// Specific force along the axis at twice the frequency, m/s2 per N.
    pub force_double: f64,
    /// Rate across the axis, rad/s per N.
    pub rate: f64,
    /// Rate about the axis at twice the frequency, rad/s per N.
    pub rate_double: f64,
}

/// Four feet on which the drone stands level; hubs touch the ground as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skids {
    /// Distance of each foot forward or back, and right or left, m, 0.01 to 10.
    pub reach: f64,
    /// Height of the centre of mass over the feet, m, above 0 to 2.
    pub height: f64,
    /// Coefficient of friction, 0 to 2.
    pub friction: f64,
}

/// Constant errors of the sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Biases {
    /// Added to body rates, rad/s.
    pub rates: Vector3<f64>,
    /// Added to the specific force, m/s2.
    pub specific_force: Vector3<f64>,
}

impl Vehicle {
    /// Refuses values outside the ranges that the fields state.
    pub fn check(&self) -> Result<(), Unfit> {
        within("mass", self.mass, 0.01, 1000.0)?;
        all_within("inertia", self.inertia.as_slice(), 1e-8, 1e4)?;
        let motors = self.motors.len() as f64;
        within("number of motors", motors, 1.0, MAX_MOTORS as f64)?;
        for motor in &self.motors {
            within("motor arm_angle", motor.arm_angle, -10.0, 10.0)?;
            within("motor arm_length", motor.arm_length, 0.0, 10.0)?;
            within("motor height", motor.height, -2.0, 2.0)?;
            within("motor efficiency", motor.efficiency, 0.01, 1.0)?;
        }
        self.propulsion.check()?;
        self.check_air()?;
        self.battery.check()?;
        within("skids reach", self.skids.reach, 0.01, 10.0)?;
        within("skids height", self.skids.height, 0.005, 2.0)?;
        within("skids friction", self.skids.friction, 0.0, 2.0)?;
        all_within("rate bias", self.biases.rates.as_slice(), -10.0, 10.0)?;
        let force = self.biases.specific_force.as_slice();
        all_within("specific force bias", force, -100.0, 100.0)
    }

    fn check_air(&self) -> Result<(), Unfit> {
        let Drag {
            linear,
            quadratic,
            rotor_across,
            rotor_along,
            rotational,
        } = &self.drag;
        for (name, axes) in [
            ("drag linear", linear),
            ("drag quadratic", quadratic),
            ("drag rotational", rotational),
        ] {
            all_within(name, axes.as_slice(), 0.0, 1000.0)?;
        }
        within("drag rotor_across", *rotor_across, 0.0, 1.0)?;
        within("drag rotor_along", *rotor_along, 0.0, 1.0)?;
        let steps = f64::from(self.esc.steps.unwrap_or(2));
        within("esc steps", steps, 2.0, 1e9)?;
        within("esc dead_zone", self.esc.dead_zone, 0.0, 0.5)?;
        let Vibration {
            force,
            force_double,
            rate,
            rate_double,
        } = self.vibration;
        let amplitudes = [force, force_double, rate, rate_double];
        all_within("vibration", &amplitudes, 0.0, 1000.0)
    }
}

impl Propulsion {
    fn check(&self) -> Result<(), Unfit> {
        within("full_thrust", self.full_thrust, 1e-3, 1e4)?;
        within("full_speed", self.full_speed, 1.0, 2e4)?;
        within("expo", self.expo, 0.0, 1.0)?;
        within("torque_per_thrust", self.torque_per_thrust, 0.0, 1.0)?;
        within("lag_up", self.lag_up, 0.002, 2.0)?;
        within("lag_down", self.lag_down, 0.002, 2.0)?;
        within("rotor_inertia", self.rotor_inertia, 0.0, 1.0)?;
        within("rotor_radius", self.rotor_radius, 0.01, 5.0)?;
        within("motor_constant", self.motor_constant, 1e-3, 100.0)?;
        within("figure_of_merit", self.figure_of_merit, 0.05, 1.0)?;
        within("electronics", self.electronics, 0.0, 1000.0)
    }

    /// Share of full thrust, and of full speed squared, at a share of full throttle.
    pub fn thrust_share(&self, throttle: f64) -> f64 {
        (1.0 - self.expo) * throttle + self.expo * throttle * throttle
    }
}

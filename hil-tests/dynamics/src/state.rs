//! All that changes in a flight.

use nalgebra::{UnitQuaternion, Vector3};

use crate::vehicle::MAX_MOTORS;

/// All that changes in a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Time since the start, ns.
    pub time_ns: u64,
    /// Centre of mass, m, north east down; the ground is at zero.
    pub position: Vector3<f64>,
    /// Velocity over the ground, m/s, north east down.
    pub velocity: Vector3<f64>,
    /// Turns body vectors (forward right down) into earth vectors (north east down).
    pub attitude: UnitQuaternion<f64>,
    /// Angular rates about forward, right and down, rad/s.
    pub rates: Vector3<f64>,
    /// Speeds of the rotors, rad/s, 0 and more; the first as many as there are motors.
    pub rotor_speeds: [f64; MAX_MOTORS],
    /// Angles through which the rotors have turned, rad, 0 to a full turn.
    pub rotor_phases: [f64; MAX_MOTORS],
    /// Charge left, 0 to 1.
    pub state_of_charge: f64,
    /// Electric energy drawn at the battery's terminals, J.
    pub energy_used: f64,
}

impl State {
    /// At rest in the air, upright, facing north, rotors standing, battery full.
    pub fn at_height(height: f64) -> Self {
        Self {
            time_ns: 0,
            position: Vector3::new(0.0, 0.0, -height),
            velocity: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            rates: Vector3::zeros(),
            rotor_speeds: [0.0; MAX_MOTORS],
            // Rotors do not stand alike; the golden angle keeps them apart.
            rotor_phases: std::array::from_fn(|rotor| rotor as f64 * 2.4),
            state_of_charge: 1.0,
            energy_used: 0.0,
        }
    }

    /// Angle between the drone's down and the earth's, rad, 0 to pi.
    pub fn tilt(&self) -> f64 {
        self.uprightness().clamp(-1.0, 1.0).acos()
    }

    /// Cosine of the tilt.
    pub(crate) fn uprightness(&self) -> f64 {
        let (i, j) = (self.attitude.i, self.attitude.j);
        1.0 - 2.0 * (i * i + j * j)
    }
}

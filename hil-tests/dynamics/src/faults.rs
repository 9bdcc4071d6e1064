//! What can go wrong in flight: numbers that diverge, a crash.

use std::error::Error;
use std::fmt;

use crate::state::State;

/// The simulation cannot go on; the drone stays as it was before the step.
#[derive(Clone, Debug)]
pub struct Diverged {
    /// What is out of bounds.
    pub what: Divergence,
    /// The last sound state, with its time.
    pub state: Box<State>,
}

/// Why a step was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Divergence {
    /// As many throttles are needed as there are motors.
    Throttles {
        /// Motors of the vehicle.
        motors: usize,
        /// Throttles given.
        given: usize,
    },
    /// A throttle is not a number from 0 to 1.
    Throttle {
        /// Index of the motor.
        motor: usize,
        /// The share given.
        share: f64,
    },
    /// The step is not a number above 0 and up to 0.1 s.
    Step(f64),
    /// The wind is not finite or faster than 150 m/s, m/s.
    Wind(f64),
    /// A number of the new state is not finite.
    NotFinite,
    /// A body rate beyond 200 rad/s.
    Rate(f64),
    /// A speed beyond 300 m/s.
    Speed(f64),
}

impl fmt::Display for Divergence {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Throttles { motors, given } => {
                write!(out, "{given} throttles given for {motors} motors")
            }
            Self::Throttle { motor, share } => {
                write!(out, "throttle of motor {motor} is {share}, not from 0 to 1")
            }
            Self::Step(dt) => write!(out, "a step of {dt} s is not above 0 and at most 0.1 s"),
            Self::Wind(speed) => write!(out, "wind of {speed} m/s"),
            Self::NotFinite => write!(out, "the new state is not finite"),
            Self::Rate(rate) => write!(out, "a body rate of {rate} rad/s"),
            Self::Speed(speed) => write!(out, "a speed of {speed} m/s"),
        }
    }
}

impl fmt::Display for Diverged {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let State {
            time_ns,
            position,
            velocity,
            attitude,
            rates,
            ..
        } = &*self.state;
        let (roll, pitch, yaw) = attitude.euler_angles();
        write!(
            out,
            "flight dynamics diverged after {:.4} s: {}; before that at {:.3?} m, {:.3?} m/s, \
             roll, pitch, yaw {roll:.3}, {pitch:.3}, {yaw:.3} rad, {:.3?} rad/s",
            *time_ns as f64 * 1e-9,
            self.what,
            position.as_slice(),
            velocity.as_slice(),
            rates.as_slice(),
        )
    }
}

impl Error for Diverged {}

/// The drone hit the ground too hard or lies on its side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crash {
    /// When, ns since the start.
    pub at_ns: u64,
    /// Speed of the part that hit, m/s.
    pub speed: f64,
    /// Angle between the drone's down and the earth's, rad.
    pub tilt: f64,
}

//! A drone to fly in tests of a page: rigid, motors that lag, and nothing else.
//!
//! Enough to see a wrong sign, a gain off by a power of ten, or a law that wants more runs.

use crate::airframe::{Mixer, MotorShares};
use crate::config::GEOMETRY;
use crate::estimate::{Arrival, Motion, Place};
use crate::graph::ControlLogic;
use crate::math::{Quaternion, Vec3};
use crate::sensors::{GRAVITY, ImuSample};
use crate::time::at_micros;
use crate::units::{BodyRates, Position, SpecificForce, Velocity};

/// Seconds between samples.
const STEP: f32 = 0.001;
/// Time constant of the motors in s.
const MOTOR_LAG: f32 = 0.025;
/// Angular acceleration (rad/s2) of full authority, about each axis.
const AUTHORITY: Vec3 = Vec3::new(200.0, 200.0, 30.0);
/// Least command of an armed motor.
const LEAST: f32 = GEOMETRY.armed_minimum();
/// Share of thrust at which it hovers.
pub const HOVER: f32 = 0.4;

/// The drone, its sensors' arrival stage, and the motors' command.
#[derive(Clone, Debug)]
pub struct Body {
    /// Attitude, body to Earth.
    pub attitude: Quaternion,
    /// Angular rates in rad/s.
    pub rates: Vec3,
    /// Position, north-east-down, in m.
    pub position: Vec3,
    /// Velocity in the same axes, in m/s.
    pub velocity: Vec3,
    motors: MotorShares,
    command: MotorShares,
    arrival: Arrival,
    samples: u64,
    placed: u64,
}

impl Body {
    /// At rest in an attitude, its motors at hover.
    pub fn new(attitude: Quaternion) -> Self {
        let hover = MotorShares::all(LEAST + HOVER * (1.0 - LEAST), GEOMETRY.count());
        Self {
            attitude,
            rates: Vec3::ZERO,
            position: Vec3::ZERO,
            velocity: Vec3::ZERO,
            motors: hover,
            command: hover,
            arrival: Arrival::default(),
            samples: 0,
            placed: 0,
        }
    }

    /// Flies on for some milliseconds of samples, with the command held.
    pub fn hold<L: ControlLogic>(&mut self, samples: u32, logic: &L) {
        for _ in 0..samples {
            let force = self.step();
            self.samples += 1;
            let sample = ImuSample {
                at: at_micros(self.samples * 1000),
                rates: BodyRates(self.rates),
                force: SpecificForce(force),
            };
            let taken = self.arrival.take(&sample, logic.derivative_cutoff());
            assert!(taken, "time moves on evenly");
        }
    }

    /// The motion since the last run.
    pub fn motion(&self) -> Motion {
        self.arrival.motion()
    }

    /// A gust turns it (rad/s).
    pub fn push(&mut self, turn: Vec3) {
        self.rates += turn;
    }

    /// A run of the logic on what came since the last one.
    pub fn run<L: ControlLogic>(&mut self, logic: &mut L) {
        let motion: Motion = self.arrival.take_motion();
        logic.take(&motion, None);
        logic.run();
        self.command = logic.mixed().shares;
    }

    /// Where it is, with the time since this was last asked.
    pub fn place(&mut self) -> Place {
        let since = self.samples - self.placed;
        self.placed = self.samples;
        Place {
            position: Position(self.position),
            velocity: Velocity(self.velocity),
            dt: since as f32 * STEP,
        }
    }

    /// A step of the motion; what an accelerometer feels in it.
    fn step(&mut self) -> Vec3 {
        for (motor, command) in self.motors.iter_mut().zip(self.command.iter()) {
            *motor += (command - *motor) * (STEP / (MOTOR_LAG + STEP));
        }
        let [roll, pitch, yaw] = Mixer::default().axes().map(|factors| {
            let turning: f32 = self
                .motors
                .iter()
                .zip(factors.iter())
                .map(|(m, f)| m * f)
                .sum();
            turning / factors.iter().map(|f| f * f).sum::<f32>()
        });
        self.rates += Vec3::new(roll, pitch, yaw).scale(AUTHORITY) * STEP;
        self.attitude = self.attitude.turned_by(self.rates * STEP);
        let mean = self.motors.iter().sum::<f32>() / self.motors.len() as f32;
        let thrust = (mean - LEAST) / (1.0 - LEAST);
        let force = Vec3::new(0.0, 0.0, -GRAVITY * thrust / HOVER);
        self.velocity += (self.attitude.to_earth(force) + Vec3::new(0.0, 0.0, GRAVITY)) * STEP;
        self.position += self.velocity * STEP;
        force
    }
}

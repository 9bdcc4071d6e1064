//! The mixer: torque demands and collective thrust to one command per motor.
//!
//! The allocation comes from the geometry in `config/airframes/`, not from a typed table: the
//! build works it out, and the target adds up. Where the motors cannot give everything, roll and
//! pitch are kept before thrust, and thrust before yaw: a drone that is level can be saved, one
//! that keeps its heading cannot.

mod even;

use crate::config::{ARMED_MINIMUM, MOTOR_PITCH, MOTOR_ROLL, MOTOR_YAW, MOTORS};
use crate::units::{Thrust, TorqueDemand};

/// The mixer of the airframe that is built, in flash.
pub const MIXER: Mixer = Mixer::new(MOTOR_ROLL, MOTOR_PITCH, MOTOR_YAW);

/// Share of full scale that each axis moves each motor by, per unit of demand.
///
/// A unit of roll or pitch is the torque of all motors at full scale on 1/sqrt(2) of an arm, the
/// lever of an X quadrotor's motors; of yaw, the reaction of all propellers at full scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer<const N: usize = MOTORS> {
    roll: [f32; N],
    pitch: [f32; N],
    yaw: [f32; N],
}

/// A motor vector and whether a demand had to be cut to reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed<const N: usize = MOTORS> {
    /// One command per motor, from the smallest an armed motor may have to 1.
    pub shares: [f32; N],
    /// Some demand was cut: the integrators must not grow.
    pub saturated: bool,
}

impl Default for Mixer {
    fn default() -> Self {
        MIXER
    }
}

impl<const N: usize> Mixer<N> {
    /// The mixer of an allocation: motor steps that act on one axis each, and not on the thrust.
    #[must_use]
    pub const fn new(roll: [f32; N], pitch: [f32; N], yaw: [f32; N]) -> Self {
        Self { roll, pitch, yaw }
    }

    /// The shares themselves: of roll, of pitch, of yaw.
    #[must_use]
    pub const fn axes(&self) -> [&[f32; N]; 3] {
        [&self.roll, &self.pitch, &self.yaw]
    }

    /// Allocates a demand.
    #[must_use]
    pub fn mix(&self, torque: TorqueDemand, thrust: Thrust) -> Mixed<N> {
        const SPAN: f32 = 1.0 - ARMED_MINIMUM;
        let mut tilt = [0.0; N];
        for ((out, roll), pitch) in tilt.iter_mut().zip(self.roll).zip(self.pitch) {
            *out = roll * torque.0.x + pitch * torque.0.y;
        }
        let (lowest, highest) = range(&tilt);
        let fit = if highest - lowest > SPAN {
            SPAN / (highest - lowest)
        } else {
            1.0
        };
        let wanted = ARMED_MINIMUM + thrust.share() * SPAN;
        let base = wanted
            .max(ARMED_MINIMUM - lowest * fit)
            .min(1.0 - highest * fit);
        let shares = tilt.map(|tilt| base + tilt * fit);
        let yaw_fit = self.yaw_headroom(&shares, torque.0.z);
        let mut mixed = shares;
        for (share, yaw) in mixed.iter_mut().zip(self.yaw) {
            *share = (*share + yaw * torque.0.z * yaw_fit).clamp(ARMED_MINIMUM, 1.0);
        }
        Mixed {
            shares: mixed,
            saturated: fit < 1.0 || base != wanted || yaw_fit < 1.0,
        }
    }

    /// The share of the yaw demand that no motor is driven past its range by.
    fn yaw_headroom(&self, shares: &[f32; N], demand: f32) -> f32 {
        let mut fit = 1.0f32;
        for (share, yaw) in shares.iter().zip(self.yaw) {
            let step = yaw * demand;
            let room = if step > 0.0 {
                1.0 - share
            } else {
                share - ARMED_MINIMUM
            };
            if step.abs() > room.max(0.0) {
                fit = fit.min(room.max(0.0) / step.abs());
            }
        }
        fit
    }
}

fn range(shares: &[f32]) -> (f32, f32) {
    shares
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &share| {
            (low.min(share), high.max(share))
        })
}

#[cfg(test)]
mod tests;

//! The mixer: torque demands and collective thrust to one command per motor.
//!
//! The allocation comes from the geometry of the airframe, not from a typed table: it is worked out
//! once, at the start. Where the motors cannot give everything, roll and
//! pitch are kept before thrust, and thrust before yaw: a drone that is level can be saved, one
//! that keeps its heading cannot.

mod even;

use super::MotorShares;
use crate::config::GEOMETRY;
use crate::settings::Airframe;
use crate::units::{Thrust, TorqueDemand};

/// Share of full scale that each axis moves each motor by, per unit of demand.
///
/// A unit of roll or pitch is the torque of all motors at full scale on 1/sqrt(2) of an arm, the
/// lever of an X quadrotor's motors; of yaw, the reaction of all propellers at full scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer {
    roll: MotorShares,
    pitch: MotorShares,
    yaw: MotorShares,
    /// Least command of an armed motor.
    least: f32,
}

/// A motor vector and whether a demand had to be cut to reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed {
    /// One command per motor, from the smallest an armed motor may have to 1.
    pub shares: MotorShares,
    /// Some demand was cut: the integrators must not grow.
    pub saturated: bool,
}

/// The mixer of the airframe that was built in.
impl Default for Mixer {
    fn default() -> Self {
        Self::new(&GEOMETRY)
    }
}

impl Mixer {
    /// The mixer of an airframe that was checked.
    #[must_use]
    pub fn new(airframe: &Airframe) -> Self {
        let (steps, count) = (airframe.allocation(), airframe.count());
        Self {
            roll: MotorShares::first(steps.roll, count),
            pitch: MotorShares::first(steps.pitch, count),
            yaw: MotorShares::first(steps.yaw, count),
            least: airframe.armed_minimum(),
        }
    }

    /// The shares themselves: of roll, of pitch, of yaw.
    #[must_use]
    pub const fn axes(&self) -> [&MotorShares; 3] {
        [&self.roll, &self.pitch, &self.yaw]
    }

    /// The least command of an armed motor, as a share of full scale.
    #[must_use]
    pub const fn least(&self) -> f32 {
        self.least
    }

    /// The range of an armed motor's command, as a share of full scale.
    #[must_use]
    pub const fn span(&self) -> f32 {
        1.0 - self.least
    }

    /// Allocates a demand.
    #[must_use]
    pub fn mix(&self, torque: TorqueDemand, thrust: Thrust) -> Mixed {
        let (least, span) = (self.least, self.span());
        let tilt = self.tilt(torque);
        let (lowest, highest) = range(&tilt);
        let fit = if highest - lowest > span {
            span / (highest - lowest)
        } else {
            1.0
        };
        let wanted = least + thrust.share() * span;
        let base = wanted.max(least - lowest * fit).min(1.0 - highest * fit);
        let level = tilt.map(|tilt| base + tilt * fit);
        let yaw_fit = self.yaw_headroom(&level, torque.0.z);
        let turned = |share, yaw| armed(share + yaw * torque.0.z * yaw_fit, least);
        Mixed {
            shares: level.zip(&self.yaw, turned),
            saturated: fit < 1.0 || base != wanted || yaw_fit < 1.0,
        }
    }

    /// What roll and pitch move each motor by.
    #[must_use]
    pub fn tilt(&self, torque: TorqueDemand) -> MotorShares {
        let tilt = |roll, pitch| roll * torque.0.x + pitch * torque.0.y;
        self.roll.zip(&self.pitch, tilt)
    }

    /// The share of the yaw demand that no motor is driven past its range by.
    fn yaw_headroom(&self, shares: &MotorShares, demand: f32) -> f32 {
        shares.fold(&self.yaw, 1.0f32, |fit, share, yaw| {
            let step = yaw * demand;
            let room = if step > 0.0 {
                1.0 - share
            } else {
                share - self.least
            };
            if step.abs() > room.max(0.0) {
                fit.min(room.max(0.0) / step.abs())
            } else {
                fit
            }
        })
    }
}

/// A share from the least of an armed motor to 1; what is no number stays so, for the gate to see.
fn armed(share: f32, least: f32) -> f32 {
    if share < least {
        least
    } else if share > 1.0 {
        1.0
    } else {
        share
    }
}

fn range(shares: &MotorShares) -> (f32, f32) {
    let none = (f32::INFINITY, f32::NEG_INFINITY);
    shares.fold(shares, none, |(low, high), share, _| {
        (low.min(share), high.max(share))
    })
}

#[cfg(test)]
mod tests;

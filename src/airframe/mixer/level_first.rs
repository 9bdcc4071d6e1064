//! Sharing that keeps the drone level: roll and pitch, then thrust, then yaw.
//!
//! A drone that is level can be saved, one that keeps its heading cannot.

use super::{Allocation, Shared, Sharing, range};
use crate::math::{max, min};
use crate::units::{Thrust, TorqueDemand};

/// Roll and pitch first.
#[derive(Clone, Copy, Debug)]
pub struct LevelFirst;

impl Sharing for LevelFirst {
    fn share<const N: usize>(
        &self,
        motors: &Allocation<N>,
        torque: TorqueDemand,
        thrust: Thrust,
    ) -> Shared<N> {
        let (least, span) = (motors.least, motors.span());
        let tilt = motors.tilt(torque);
        let (lowest, highest) = range(&tilt);
        let fit = if highest - lowest > span {
            span / (highest - lowest)
        } else {
            1.0
        };
        let wanted = least + thrust.share() * span;
        let base = min(max(least - lowest * fit, wanted), 1.0 - highest * fit);
        let mut shares = tilt.map(|tilt| base + tilt * fit);
        let yaw_fit = motors.yaw_headroom(&shares, torque.0.z);
        for (share, yaw) in shares.iter_mut().zip(&motors.yaw) {
            *share = motors.armed(*share + yaw * torque.0.z * yaw_fit);
        }
        Shared {
            shares,
            cut: fit < 1.0 || base != wanted || yaw_fit < 1.0,
            spare: f32::INFINITY,
        }
    }
}

impl<const N: usize> Allocation<N> {
    /// The share of the yaw demand that no motor is driven past its range by.
    fn yaw_headroom(&self, shares: &[f32; N], demand: f32) -> f32 {
        let mut fit = 1.0;
        for (share, yaw) in shares.iter().zip(&self.yaw) {
            let step = yaw * demand;
            let room = if step > 0.0 {
                1.0 - share
            } else {
                share - self.least
            };
            let room = max(room, 0.0);
            if step.abs() > room {
                fit = min(room / step.abs(), fit);
            }
        }
        fit
    }
}

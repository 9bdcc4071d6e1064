//! Sharing that keeps the drone level: roll and pitch, then thrust, then yaw.
//!
//! A drone that is level can be saved, one that keeps its heading cannot.

use super::{Allocation, Shared, Sharing};
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
        let fitted = motors.fitted(motors.tilt(torque), thrust);
        let mut shares = fitted.shares;
        let yaw_fit = motors.yaw_headroom(&shares, torque.0.z);
        for (share, yaw) in shares.iter_mut().zip(&motors.yaw) {
            *share = motors.armed(*share + yaw * torque.0.z * yaw_fit);
        }
        Shared {
            shares,
            cut: fitted.cut || fitted.shifted || yaw_fit < 1.0,
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

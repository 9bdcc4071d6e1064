//! The mixer: torque demands and collective thrust to one command per motor.
//!
//! The allocation comes from the geometry in `config/airframes/`, not from a typed table.
//! Where the motors cannot give everything, roll and pitch are kept before thrust, and thrust
//! before yaw: a drone that is level can be saved, one that keeps its heading cannot.

mod even;

use super::MotorShares;
use crate::config::{ARMED_MINIMUM, MOTOR_ANGLES, MOTOR_SPINS, MOTORS};
use crate::math::sin_cos;
use crate::units::{Thrust, TorqueDemand};

/// Share of full scale that each axis moves each motor by, per unit of demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer {
    roll: MotorShares,
    pitch: MotorShares,
    yaw: MotorShares,
}

/// A motor vector and whether a demand had to be cut to reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed {
    /// One command per motor, from the smallest an armed motor may have to 1.
    pub shares: MotorShares,
    /// Some demand was cut: the integrators must not grow.
    pub saturated: bool,
}

impl Default for Mixer {
    fn default() -> Self {
        Self::from_geometry(&MOTOR_ANGLES, &MOTOR_SPINS)
    }
}

impl Mixer {
    /// The mixer of motors at `angles` (rad from forward, clockwise) with `spins`.
    ///
    /// A propeller that turns clockwise (+1) pushes the body counter-clockwise. Each axis is
    /// scaled so that a demand of one moves the most effective motor by its full scale.
    #[must_use]
    pub fn from_geometry(angles: &MotorShares, spins: &MotorShares) -> Self {
        Self {
            roll: normalised(angles.map(|angle| -sin_cos(angle).0)),
            pitch: normalised(angles.map(|angle| sin_cos(angle).1)),
            yaw: normalised(spins.map(|spin| -spin)),
        }
    }

    /// Allocates a demand.
    #[must_use]
    pub fn mix(&self, torque: TorqueDemand, thrust: Thrust) -> Mixed {
        const SPAN: f32 = 1.0 - ARMED_MINIMUM;
        let mut tilt = [0.0; MOTORS];
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
    fn yaw_headroom(&self, shares: &MotorShares, demand: f32) -> f32 {
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

fn normalised(factors: MotorShares) -> MotorShares {
    let largest = factors.iter().fold(0.0f32, |max, f| max.max(f.abs()));
    if largest > 0.0 {
        factors.map(|factor| factor / largest)
    } else {
        factors
    }
}

fn range(shares: &MotorShares) -> (f32, f32) {
    shares
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &share| {
            (low.min(share), high.max(share))
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use proptest::prelude::*;

    fn torque(x: f32, y: f32, z: f32) -> TorqueDemand {
        TorqueDemand(Vec3::new(x, y, z))
    }

    fn half() -> Thrust {
        Thrust::new(0.5).expect("in range")
    }

    /// What the motors do to the body, by the same geometry.
    fn achieved(shares: &MotorShares) -> Vec3 {
        let mixer = Mixer::default();
        let along = |factors: MotorShares| {
            shares.iter().zip(factors).map(|(s, f)| s * f).sum::<f32>()
                / factors.iter().map(|f| f * f).sum::<f32>()
        };
        Vec3::new(along(mixer.roll), along(mixer.pitch), along(mixer.yaw))
    }

    #[test]
    fn a_small_demand_is_given_in_full() {
        let mixed = Mixer::default().mix(torque(0.1, -0.05, 0.02), half());
        assert!(!mixed.saturated);
        assert!((achieved(&mixed.shares) - Vec3::new(0.1, -0.05, 0.02)).max_norm() < 1e-5);
    }

    #[test]
    fn roll_to_the_right_raises_the_left_motors() {
        let mixed = Mixer::default().mix(torque(0.1, 0.0, 0.0), half());
        for (share, angle) in mixed.shares.iter().zip(MOTOR_ANGLES) {
            let on_the_left = sin_cos(angle).0 < 0.0;
            assert_eq!(*share > 0.525, on_the_left);
        }
    }

    proptest! {
        #[test]
        fn commands_never_leave_their_range(
            x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0, t in 0.0f32..=1.0
        ) {
            let thrust = Thrust::new(t).expect("in range");
            let mixed = Mixer::default().mix(torque(x, y, z), thrust);
            for share in mixed.shares {
                prop_assert!((ARMED_MINIMUM..=1.0).contains(&share));
            }
        }

        #[test]
        fn yaw_is_cut_before_roll_and_pitch(
            x in -0.2f32..0.2, y in -0.2f32..0.2, z in -3.0f32..3.0, t in 0.0f32..=1.0
        ) {
            let thrust = Thrust::new(t).expect("in range");
            let mixed = Mixer::default().mix(torque(x, y, z), thrust);
            let got = achieved(&mixed.shares);
            prop_assert!((got.x - x).abs() < 1e-4);
            prop_assert!((got.y - y).abs() < 1e-4);
            prop_assert!(got.z.abs() <= z.abs() + 1e-4);
        }
    }
}

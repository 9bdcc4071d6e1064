//! Allocation that scales roll, pitch and yaw alike, after Cleanflight's air mode.
//!
//! After `mixTable` of Cleanflight 1.13 (`src/main/flight/mixer.c`): what is asked about the three
//! axes is first scaled to fit between the motors' limits, then thrust is shifted so far that
//! nothing is clipped. The original takes each motor's share as symmetric about zero; here its
//! true extremes are kept, which matters where yaw comes with roll.

use super::{Allocation, Shared, Sharing};
use crate::units::{Thrust, TorqueDemand};

/// All three axes alike.
///
/// Saturated where they were cut; a shift of thrust alone is not: all torques are given.
#[derive(Clone, Copy, Debug)]
pub struct Evenly;

impl Sharing for Evenly {
    fn share<const N: usize>(
        &self,
        motors: &Allocation<N>,
        torque: TorqueDemand,
        thrust: Thrust,
    ) -> Shared<N> {
        let mut turn = motors.tilt(torque);
        for (turn, yaw) in turn.iter_mut().zip(&motors.yaw) {
            *turn += yaw * torque.0.z;
        }
        let fitted = motors.fitted(turn, thrust);
        Shared {
            shares: fitted.shares.map(|share| motors.armed(share)),
            cut: fitted.cut,
            spare: f32::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::{Mixer, MotorShares};
    use crate::config::GEOMETRY;
    use crate::math::Vec3;
    use proptest::prelude::*;

    const LEAST: f32 = GEOMETRY.armed_minimum();

    /// The torque that motors give, as the mixer sees them.
    fn given(shares: &MotorShares) -> Vec3 {
        let [x, y, z] = Mixer::default().axes().map(|factors| {
            let along: f32 = shares.iter().zip(factors).map(|(s, f)| s * f).sum();
            along / factors.iter().map(|f| f * f).sum::<f32>()
        });
        Vec3::new(x, y, z)
    }

    proptest! {
        #[test]
        fn commands_never_leave_their_range(
            x in -32.0f32..32.0, y in -32.0f32..32.0, z in -32.0f32..32.0, t in 0.0f32..=1.0
        ) {
            let thrust = Thrust::new(t).expect("in range");
            let mixed = Mixer::default().mix(TorqueDemand(Vec3::new(x, y, z)), thrust, &Evenly);
            for &share in mixed.shares.iter() {
                prop_assert!((LEAST..=1.0).contains(&share));
            }
        }

        #[test]
        fn a_demand_is_given_in_full_or_scaled_alike_about_all_axes(
            x in -2.0f32..2.0, y in -2.0f32..2.0, z in -2.0f32..2.0, t in 0.0f32..=1.0
        ) {
            let asked = Vec3::new(x, y, z);
            let thrust = Thrust::new(t).expect("in range");
            let mixed = Mixer::default().mix(TorqueDemand(asked), thrust, &Evenly);
            let got = given(&mixed.shares);
            let scale = got.dot(asked) / asked.dot(asked).max(1e-9);
            prop_assert!((got - asked * scale).max_norm() < 1e-3);
            let fits = (scale - 1.0).abs() < 1e-2;
            prop_assert!(fits != mixed.saturated || (fits && scale <= 1.0), "{scale} {mixed:?}");
        }

        #[test]
        fn thrust_is_kept_as_long_as_torques_fit_beside_it(
            x in -0.1f32..0.1, y in -0.1f32..0.1, z in -0.1f32..0.1, t in 0.35f32..=0.65
        ) {
            let thrust = Thrust::new(t).expect("in range");
            let mixed = Mixer::default().mix(TorqueDemand(Vec3::new(x, y, z)), thrust, &Evenly);
            let mean = mixed.shares.iter().sum::<f32>() / mixed.shares.len() as f32;
            prop_assert!((mean - LEAST - t * (1.0 - LEAST)).abs() < 1e-4);
        }
    }
}

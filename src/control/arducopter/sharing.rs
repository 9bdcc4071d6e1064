//! How the motors' range is shared where it does not suffice.
//!
//! As in AP_MotorsMatrix: yaw may have what roll and pitch leave at the thrust that is best for
//! them, and a headroom at least; thrust may be raised towards hover to keep the attitude, and
//! where that does not suffice, roll, pitch and yaw shrink together.

use crate::airframe::{Allocation, Shared, Sharing};
use crate::math::{between, limited, max, min};
use crate::settings::gains::arducopter::Thrust as ThrustGains;
use crate::units::{Thrust, TorqueDemand};

/// Thrust may be raised towards that of hover (share) for the attitude.
#[derive(Clone, Copy, Debug)]
pub struct AroundHover<'g> {
    hover: f32,
    gains: &'g ThrustGains,
}

impl<'g> AroundHover<'g> {
    /// Around this thrust of hover (share); the gains say how far thrust may be raised, and what
    /// yaw may have at least.
    #[must_use]
    pub const fn new(hover: f32, gains: &'g ThrustGains) -> Self {
        Self { hover, gains }
    }
}

impl Sharing for AroundHover<'_> {
    fn share<const N: usize>(
        &self,
        motors: &Allocation<N>,
        torque: TorqueDemand,
        thrust: Thrust,
    ) -> Shared<N> {
        let (least, span, priority) = (motors.least, motors.span(), self.gains.attitude_priority);
        let mut turning = motors.tilt(torque);
        let wanted = thrust.share() * span;
        let raised = wanted * (1.0 - priority) + self.hover * span * priority;
        let most = min(max(raised, wanted), span);
        let headroom = motors.yaw_left(&turning, torque.0.z, min(most, 0.5 * span));
        let most_turn = max(headroom, self.gains.yaw_headroom * span);
        let turn = limited(torque.0.z, most_turn);
        for (turning, yaw) in turning.iter_mut().zip(&motors.yaw) {
            *turning += yaw * turn;
        }
        let (base, fit) = fitted(&turning, wanted, most, span);
        let shares = turning.map(|turning| between(least + base + turning * fit, least, 1.0));
        Shared {
            shares,
            cut: fit < 1.0 || base < wanted || turn != torque.0.z,
            spare: most_turn - torque.0.z.abs(),
        }
    }
}

impl<const N: usize> Allocation<N> {
    /// The largest yaw demand that every motor can give beside `base` and `turning`.
    fn yaw_left(&self, turning: &[f32; N], demand: f32, base: f32) -> f32 {
        let mut allowed = 1.0;
        for (turning, yaw) in turning.iter().zip(&self.yaw) {
            let used = base + turning;
            let room = if yaw * demand > 0.0 {
                self.span() - used
            } else {
                used
            };
            if *yaw != 0.0 {
                allowed = min(max(room, 0.0) / yaw.abs(), allowed);
            }
        }
        allowed
    }
}

/// The thrust above the armed minimum, and the part of every torque that fits.
fn fitted(turning: &[f32], wanted: f32, most: f32, span: f32) -> (f32, f32) {
    let (mut low, mut high) = (0.0, 0.0);
    for turning in turning {
        (low, high) = (min(*turning, low), max(*turning, high));
    }
    let mut fit = 1.0;
    if high - low > span {
        fit = span / (high - low);
    }
    if most + low < 0.0 {
        fit = min(-most / low, fit);
    }
    let least = -low * fit;
    if fit < 1.0 {
        return (least, fit);
    }
    (max(min(wanted, span - high), least), fit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::{LevelFirst, Mixed, Mixer, MotorShares};
    use crate::config::GEOMETRY;
    use crate::config::arducopter::GAINS;
    use crate::math::Vec3;
    use proptest::prelude::*;

    const LEAST: f32 = GEOMETRY.armed_minimum();

    fn share(torque: [f32; 3], thrust: f32) -> Mixed {
        let [x, y, z] = torque;
        let thrust = Thrust::new(thrust).expect("in range");
        let rule = AroundHover::new(0.35, &GAINS.thrust);
        Mixer::default().mix(TorqueDemand(Vec3::new(x, y, z)), thrust, &rule)
    }

    /// What the motors do to the body, by the same geometry.
    fn achieved(shares: &MotorShares) -> [f32; 3] {
        Mixer::default().axes().map(|factors| {
            shares
                .iter()
                .zip(factors.iter())
                .map(|(s, f)| s * f)
                .sum::<f32>()
                / factors.iter().map(|f| f * f).sum::<f32>()
        })
    }

    #[test]
    fn a_small_demand_is_given_in_full() {
        let mixed = share([0.1, -0.05, 0.02], 0.5);
        assert!(!mixed.saturated);
        for (got, asked) in achieved(&mixed.shares).into_iter().zip([0.1, -0.05, 0.02]) {
            assert!((got - asked).abs() < 1e-5);
        }
        let plain = Mixer::default().mix(
            TorqueDemand(Vec3::new(0.1, -0.05, 0.02)),
            Thrust::new(0.5).expect("in range"),
            &LevelFirst,
        );
        for (share, plain) in mixed.shares.iter().zip(plain.shares.iter()) {
            assert!((share - plain).abs() < 1e-6);
        }
    }

    #[test]
    fn at_little_thrust_the_attitude_is_kept_up_to_the_priority() {
        let small = share([0.1, 0.0, 0.0], 0.05);
        assert!((achieved(&small.shares)[0] - 0.1).abs() < 1e-5);
        let mean: f32 = small.shares.iter().sum::<f32>() / small.shares.len() as f32;
        assert!((mean - LEAST - 0.1).abs() < 1e-5, "{mean}");
        let large = share([0.4, 0.0, 0.0], 0.0);
        assert!(large.saturated);
        let got = achieved(&large.shares)[0];
        assert!(
            (got - 0.35 * GAINS.thrust.attitude_priority * (1.0 - LEAST)).abs() < 1e-5,
            "{got}"
        );
    }

    #[test]
    fn yaw_keeps_its_headroom_beside_a_full_roll() {
        let [roll, _, yaw] = achieved(&share([0.5, 0.0, 0.5], 0.5).shares);
        assert!(roll > 0.3, "{roll}");
        assert!(yaw > 0.5 * GAINS.thrust.yaw_headroom, "{yaw}");
    }

    proptest! {
        #[test]
        fn commands_never_leave_their_range(
            x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0, t in 0.0f32..=1.0
        ) {
            for share in share([x, y, z], t).shares.iter() {
                prop_assert!((LEAST..=1.0).contains(share));
            }
        }

        #[test]
        fn no_axis_is_given_more_than_it_asked_for_or_the_other_way(
            x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0, t in 0.0f32..=1.0
        ) {
            let got = achieved(&share([x, y, z], t).shares);
            for (got, asked) in got.into_iter().zip([x, y, z]) {
                prop_assert!(got.abs() <= asked.abs() + 1e-4);
                prop_assert!(got * asked >= -1e-4);
            }
        }

        #[test]
        fn a_small_change_of_the_demand_changes_the_command_little(
            x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0, t in 0.0f32..0.99
        ) {
            let before = share([x, y, z], t).shares;
            let after = share([x + 1e-3, y - 1e-3, z + 1e-3], t + 1e-3).shares;
            for (before, after) in before.iter().zip(after.iter()) {
                prop_assert!((before - after).abs() < 0.03);
            }
        }
    }
}

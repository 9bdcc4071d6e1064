//! How the motors' range is shared where it does not suffice.
//!
//! As in AP_MotorsMatrix: yaw may have what roll and pitch leave at the thrust that is best for
//! them, and a headroom at least; thrust may be raised towards hover to keep the attitude, and
//! where that does not suffice, roll, pitch and yaw shrink together.

use crate::airframe::{Mixed, Mixer, MotorShares};
use crate::math::{between, limited};
use crate::settings::gains::arducopter::Thrust as ThrustGains;
use crate::units::{Thrust, TorqueDemand};

/// The motor vector of a demand, given the thrust of hover (share).
#[must_use]
pub fn shared(
    mixer: &Mixer,
    torque: TorqueDemand,
    thrust: Thrust,
    hover: f32,
    gains: &ThrustGains,
) -> Mixed {
    let [_, _, yaw] = mixer.axes();
    let (least, span) = (mixer.least(), mixer.span());
    let turning = mixer.tilt(torque);
    let wanted = thrust.share() * span;
    let raised = wanted * (1.0 - gains.attitude_priority) + hover * span * gains.attitude_priority;
    let most = wanted.max(raised).min(span);
    let headroom = yaw_headroom(&turning, mixer, torque.0.z, most.min(0.5 * span));
    let headroom = headroom.max(gains.yaw_headroom * span);
    let turn = limited(torque.0.z, headroom);
    let turning = turning.zip(yaw, |tilt, yaw| tilt + yaw * turn);
    let (base, fit) = fitted(&turning, wanted, most, span);
    let shares = turning.map(|turning| {
        let share = least + base + turning * fit;
        between(share, least, 1.0)
    });
    Mixed {
        shares,
        saturated: fit < 1.0 || base < wanted || turn != torque.0.z,
    }
}

/// The largest yaw demand that every motor can give beside `base` and `turning`.
fn yaw_headroom(turning: &MotorShares, mixer: &Mixer, demand: f32, base: f32) -> f32 {
    let ([_, _, yaw], span) = (mixer.axes(), mixer.span());
    let mut allowed = 1.0f32;
    for (turning, yaw) in turning.iter().zip(yaw.iter()) {
        let used = base + turning;
        let room = if yaw * demand > 0.0 {
            span - used
        } else {
            used
        };
        if *yaw != 0.0 {
            allowed = allowed.min(room.max(0.0) / yaw.abs());
        }
    }
    allowed
}

/// The thrust above the armed minimum, and the part of every torque that fits.
fn fitted(turning: &MotorShares, wanted: f32, most: f32, span: f32) -> (f32, f32) {
    let (low, high) = turning
        .iter()
        .fold((0.0f32, 0.0f32), |(low, high), &turning| {
            (low.min(turning), high.max(turning))
        });
    let mut fit = 1.0f32;
    if high - low > span {
        fit = span / (high - low);
    }
    if most + low < 0.0 {
        fit = fit.min(-most / low);
    }
    let least = -low * fit;
    if fit < 1.0 {
        return (least, fit);
    }
    (wanted.min(span - high).max(least), fit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GEOMETRY;
    use crate::config::arducopter::GAINS;
    use crate::math::Vec3;
    use proptest::prelude::*;

    const LEAST: f32 = GEOMETRY.armed_minimum();

    fn share(torque: [f32; 3], thrust: f32) -> Mixed {
        let [x, y, z] = torque;
        let thrust = Thrust::new(thrust).expect("in range");
        shared(
            &Mixer::default(),
            TorqueDemand(Vec3::new(x, y, z)),
            thrust,
            0.35,
            &GAINS.thrust,
        )
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

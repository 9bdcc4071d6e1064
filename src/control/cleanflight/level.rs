//! Level mode: missing roll, pitch and heading to desired body rates.

use super::{Aim, Lean};
use crate::control::Wanted;
use crate::math::{Quaternion, Vec3, limited, wrapped};
use crate::settings::gains::cleanflight::Level;
use crate::units::BodyRates;

/// Desired body rates: each angle's error times a gain, about its own axis.
///
/// Yaw is a rate, to which the hold of a heading adds. Not limited: no error exceeds the lean's
/// limit and half a turn.
#[must_use]
pub fn level(attitude: Quaternion, aim: &Aim, gains: &Level) -> Wanted {
    let mut rates = aim.rates.0;
    let mut stiffness = Vec3::ZERO;
    if let Some(wanted) = aim.lean {
        let lean = Lean::of(attitude);
        rates += Vec3::new(wanted.roll - lean.roll, wanted.pitch - lean.pitch, 0.0) * gains.p;
        stiffness += Vec3::new(gains.p, gains.p, 0.0);
    }
    if let Some(heading) = aim.heading {
        rates.z += gains.heading_p * limited(wrapped(heading - attitude.heading()), 4.0);
        stiffness.z = gains.heading_p;
    }
    Wanted {
        rates: BodyRates(rates),
        stiffness,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cleanflight::GAINS;
    use proptest::prelude::*;

    fn towards(roll: f32, pitch: f32) -> Aim {
        Aim {
            lean: Some(Lean { roll, pitch }),
            ..Aim::default()
        }
    }

    #[test]
    fn rolled_right_of_the_aim_asks_for_roll_to_the_left() {
        let attitude = Quaternion::IDENTITY.turned_by(Vec3::new(0.2, 0.0, 0.0));
        let rates = level(attitude, &towards(0.05, 0.0), &GAINS.level).rates.0;
        assert!((rates.x + 0.15 * GAINS.level.p).abs() < 1e-3);
        assert!(rates.y.abs() < 1e-3 && rates.z == 0.0);
    }

    #[test]
    fn nose_above_the_aim_asks_for_nose_down() {
        let attitude = Quaternion::from_heading(2.0).turned_by(Vec3::new(0.0, 0.2, 0.0));
        let rates = level(attitude, &towards(0.0, 0.0), &GAINS.level).rates.0;
        assert!((rates.y + 0.2 * GAINS.level.p).abs() < 1e-3);
    }

    #[test]
    fn a_heading_is_turned_to_the_shorter_way() {
        let aim = Aim {
            heading: Some(-3.0),
            ..towards(0.0, 0.0)
        };
        let rates = level(Quaternion::from_heading(3.0), &aim, &GAINS.level)
            .rates
            .0;
        assert!(rates.z > 0.0 && rates.z < GAINS.level.heading_p);
    }

    #[test]
    fn without_a_lean_the_rates_are_the_setpoint_s_own() {
        let aim = Aim {
            rates: BodyRates(Vec3::new(1.0, -2.0, 0.5)),
            ..Aim::default()
        };
        assert_eq!(
            level(Quaternion::from_heading(1.0), &aim, &GAINS.level).rates,
            aim.rates
        );
    }

    proptest! {
        #[test]
        fn a_small_turn_moves_the_wanted_rates_by_the_stiffness(
            x in -0.01f32..0.01, y in -0.01f32..0.01, z in -0.01f32..0.01
        ) {
            let aim = Aim { heading: Some(0.3), ..towards(0.1, -0.1) };
            let turn = Vec3::new(x, y, z);
            let foreseen = level(Quaternion::IDENTITY, &aim, &GAINS.level).after_turn(turn).0;
            let turned = level(Quaternion::IDENTITY.turned_by(turn), &aim, &GAINS.level).rates.0;
            prop_assert!((foreseen - turned).max_norm() < 1e-3);
        }

        #[test]
        fn rates_are_finite_and_bounded_in_any_attitude(
            x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0, heading in any::<f32>()
        ) {
            let attitude = (0..4).fold(Quaternion::IDENTITY, |attitude, _| {
                attitude.turned_by(Vec3::new(x, y, z) * 0.25)
            });
            let aim = Aim { heading: Some(heading), ..towards(0.8, -0.8) };
            let rates = level(attitude, &aim, &GAINS.level).rates;
            prop_assert!(rates.is_finite());
            prop_assert!(rates.0.max_norm() < GAINS.level.p * 4.1);
        }
    }
}

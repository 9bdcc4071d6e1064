//! The outer loop: attitude error to desired body rates, proportional and limited.

use super::{Setpoint, Yaw};
use crate::math::{Quaternion, Vec3};
use crate::units::BodyRates;

/// Gains and limits of the attitude loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeLaw {
    /// Desired rate per rad of error, 1/s, about each axis.
    pub gain: Vec3,
    /// The largest rate the error may ask for, rad/s, about each axis.
    pub limit: Vec3,
}

/// What the outer loop asks for, and how that moves as the body turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Desired body rates.
    pub rates: BodyRates,
    /// By how much they fall per rad turned, 1/s, about each axis; zero where the loop is
    /// limited or does not act.
    pub stiffness: Vec3,
}

impl Wanted {
    /// The desired rates after a turn of the body (rad), to first order.
    #[must_use]
    pub fn after_turn(&self, turned: Vec3) -> BodyRates {
        BodyRates(self.rates.0 - turned.scale(self.stiffness))
    }

    /// The desired rates integrated over a stretch of time, in rad, to first order.
    ///
    /// `swept` is the angle turned, integrated over that time (rad s), `dt` its length (s).
    #[must_use]
    pub fn integrated(&self, swept: Vec3, dt: f32) -> Vec3 {
        self.rates.0 * dt - swept.scale(self.stiffness)
    }
}

impl AttitudeLaw {
    /// The law of a gain (1/s) and a limit (rad/s), each about roll, pitch and yaw.
    #[must_use]
    pub const fn new(gain: [f32; 3], limit: [f32; 3]) -> Self {
        Self {
            gain: Vec3::from_array(gain),
            limit: Vec3::from_array(limit),
        }
    }

    /// Desired body rates: the setpoint's own, plus what the attitude error asks for.
    #[must_use]
    pub fn wanted(&self, attitude: Quaternion, setpoint: &Setpoint) -> Wanted {
        let Some(target) = setpoint.attitude else {
            return Wanted {
                rates: setpoint.rates,
                stiffness: Vec3::ZERO,
            };
        };
        let (error, axes) = match setpoint.yaw {
            Yaw::Heading => (attitude.error_to(target), Vec3::new(1.0, 1.0, 1.0)),
            Yaw::Rate => (tilt_error(attitude, target), Vec3::new(1.0, 1.0, 0.0)),
        };
        let asked = error.scale(self.gain);
        let free = |asked: f32, limit: f32| f32::from(u8::from(asked.abs() < limit));
        let acts = Vec3::new(
            free(asked.x, self.limit.x),
            free(asked.y, self.limit.y),
            free(asked.z, self.limit.z),
        );
        Wanted {
            rates: BodyRates(asked.limited(self.limit) + setpoint.rates.0),
            stiffness: self.gain.scale(axes).scale(acts),
        }
    }
}

/// The rotation (rad, body axes) that tilts as the target is tilted, heading left alone.
///
/// The target's tilt is taken relative to its own heading, so that a target of another heading
/// still asks for the same forward and right lean. Nothing about the body's z axis.
fn tilt_error(attitude: Quaternion, target: Quaternion) -> Vec3 {
    let down = attitude.down_in_body();
    let wanted = target.down_in_body();
    let error = wanted.cross(down);
    let aligned = down.dot(wanted);
    // Upside down the sine of the angle vanishes: hold the largest error instead.
    let scale = if aligned < 0.0 {
        1.0 / error.norm().max(1e-3)
    } else {
        1.0
    };
    Vec3::new(error.x * scale, error.y * scale, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cascade::GAINS;
    use crate::units::Thrust;
    use proptest::prelude::*;

    const LAW: AttitudeLaw = AttitudeLaw::new(GAINS.attitude.p, GAINS.attitude.rate_limit_rad_s);

    fn target(attitude: Quaternion, yaw: Yaw) -> Setpoint {
        Setpoint {
            attitude: Some(attitude),
            yaw,
            ..Setpoint::level(Thrust::ZERO)
        }
    }

    #[test]
    fn rolled_right_of_the_target_asks_for_roll_to_the_left() {
        let attitude = Quaternion::IDENTITY.turned_by(Vec3::new(0.2, 0.0, 0.0));
        for yaw in [Yaw::Heading, Yaw::Rate] {
            let rates = LAW
                .wanted(attitude, &target(Quaternion::IDENTITY, yaw))
                .rates;
            let expected = -0.2 * GAINS.attitude.p[0];
            assert!((rates.0.x - expected).abs() < 0.02, "{yaw:?} {rates:?}");
            assert!(rates.0.y.abs() < 1e-3);
        }
    }

    #[test]
    fn nose_above_the_target_asks_for_nose_down() {
        let attitude = Quaternion::IDENTITY.turned_by(Vec3::new(0.0, 0.2, 0.0));
        for yaw in [Yaw::Heading, Yaw::Rate] {
            let rates = LAW
                .wanted(attitude, &target(Quaternion::IDENTITY, yaw))
                .rates;
            assert!(
                (rates.0.y + 0.2 * GAINS.attitude.p[1]).abs() < 0.02,
                "{yaw:?} {rates:?}"
            );
        }
    }

    #[test]
    fn with_a_yaw_rate_the_heading_is_free() {
        let law = LAW;
        let setpoint = target(Quaternion::from_heading(2.0), Yaw::Rate);
        let rates = law.wanted(Quaternion::IDENTITY, &setpoint).rates;
        assert!(rates.0.max_norm() < 1e-5);
        let setpoint = target(Quaternion::from_heading(0.5), Yaw::Heading);
        assert!(law.wanted(Quaternion::IDENTITY, &setpoint).rates.0.z > 1.0);
    }

    #[test]
    fn a_small_turn_moves_the_wanted_rates_by_the_stiffness() {
        let law = LAW;
        let turn = Vec3::new(0.01, -0.02, 0.005);
        for yaw in [Yaw::Heading, Yaw::Rate] {
            let setpoint = target(
                Quaternion::IDENTITY.turned_by(Vec3::new(0.1, 0.05, 0.0)),
                yaw,
            );
            let before = law.wanted(Quaternion::IDENTITY, &setpoint);
            let foreseen = before.after_turn(turn).0;
            let turned = law.wanted(Quaternion::IDENTITY.turned_by(turn), &setpoint);
            let miss = (foreseen - turned.rates.0).max_norm();
            assert!(
                miss < 0.1 * turn.max_norm() * GAINS.attitude.p[0],
                "{yaw:?} {miss}"
            );
        }
    }

    #[test]
    fn upside_down_still_asks_for_a_turn() {
        let attitude = Quaternion::from_up(Vec3::new(0.0, 0.05, 1.0)).expect("a direction");
        let rates = LAW
            .wanted(attitude, &target(Quaternion::IDENTITY, Yaw::Rate))
            .rates;
        assert!(rates.0.max_norm() > 1.0);
    }

    proptest! {
        #[test]
        fn what_the_error_asks_for_is_limited(
            x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0, heading in -3.0f32..3.0
        ) {
            let attitude = Quaternion::from_heading(heading);
            let goal = Quaternion::IDENTITY.turned_by(Vec3::new(x, y, z) * 0.3);
            for yaw in [Yaw::Heading, Yaw::Rate] {
                let rates = LAW.wanted(attitude, &target(goal, yaw)).rates;
                prop_assert!(rates.is_finite());
                prop_assert!(rates.0.max_norm() <= 4.0);
            }
        }
    }
}

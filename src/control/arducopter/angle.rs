//! The angle loop: where the thrust points is corrected before the heading.

use core::f32::consts::{FRAC_PI_3, FRAC_PI_6};

use super::approach::{Approach, approach};
use crate::control::{Setpoint, Wanted, Yaw};
use crate::math::{Quaternion, Vec3, atan2, between, limited, sqrt, wrapped};
use crate::settings::gains::arducopter::Angle;
use crate::units::BodyRates;

/// What the angle loop asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    /// Desired body rates, and by how much they fall as the body turns.
    pub wanted: Wanted,
    /// Share of an error of the yaw rate that counts, 0 to 1.
    ///
    /// None while the thrust points far off: yaw would take what roll and pitch need.
    pub heading: f32,
}

/// Body rates that bring the attitude to the setpoint's, its own rates added.
#[must_use]
pub fn angle_loop(attitude: Quaternion, setpoint: &Setpoint, gains: &Angle) -> Asked {
    let Some(target) = setpoint.attitude else {
        return Asked {
            wanted: Wanted {
                rates: setpoint.rates,
                stiffness: Vec3::ZERO,
            },
            heading: 1.0,
        };
    };
    let error = match setpoint.yaw {
        Yaw::Heading => thrust_then_heading(attitude, target),
        Yaw::Rate => thrust_alone(attitude, target),
    };
    let [px, py, pz] = gains.p;
    let [ax, ay, az] = gains.acceleration_rad_s2;
    let [x, y] = [
        approach(error.turn.x, px, ax),
        approach(error.turn.y, py, ay),
    ];
    let z = match setpoint.yaw {
        Yaw::Heading if error.turn.z.abs() <= gains.yaw_error_limit_rad => {
            approach(error.turn.z, pz, az)
        }
        Yaw::Heading => Approach {
            slope: 0.0,
            ..approach(limited(error.turn.z, gains.yaw_error_limit_rad), pz, az)
        },
        Yaw::Rate => Approach::default(),
    };
    let trust = trusted(error.tilt);
    let own = setpoint.rates.0;
    let rates = Vec3::new(
        x.speed + own.x * trust,
        y.speed + own.y * trust,
        z.speed + own.z,
    );
    Asked {
        wanted: Wanted {
            rates: BodyRates(rates),
            stiffness: Vec3::new(x.slope, y.slope, z.slope),
        },
        heading: trust,
    }
}

/// The way from an attitude to a target.
struct AngleError {
    /// Tilt about x and y, then yaw about z, in rad, body axes.
    turn: Vec3,
    /// Angle between thrust and where it shall point, in rad, 0 to pi.
    tilt: f32,
}

/// First the shortest turn that points the thrust right, then one about the thrust.
fn thrust_then_heading(attitude: Quaternion, target: Quaternion) -> AngleError {
    let Quaternion { w, v } = attitude.conjugate().then_body(target);
    let about_thrust = sqrt(w * w + v.z * v.z);
    // Upside down no yaw is defined: take none.
    let [cos, sin] = if about_thrust > 1e-6 {
        [w / about_thrust, v.z / about_thrust]
    } else {
        [1.0, 0.0]
    };
    let tilting = sqrt(v.x * v.x + v.y * v.y);
    let tilt = 2.0 * atan2(tilting, about_thrust);
    let scale = per_sine(tilt, tilting);
    AngleError {
        turn: Vec3::new(
            (cos * v.x - sin * v.y) * scale,
            (cos * v.y + sin * v.x) * scale,
            wrapped(2.0 * atan2(sin, cos)),
        ),
        tilt,
    }
}

/// The turn that tilts as the target does relative to its own heading; yaw is free.
fn thrust_alone(attitude: Quaternion, target: Quaternion) -> AngleError {
    let down = attitude.down_in_body();
    let wanted = target.down_in_body();
    let across = wanted.cross(down);
    let size = across.norm();
    let tilt = atan2(size, wanted.dot(down));
    if size <= 1e-6 && tilt > 1.0 {
        // Exactly upside down every turn is the shortest: roll.
        return AngleError {
            turn: Vec3::new(tilt, 0.0, 0.0),
            tilt,
        };
    }
    let scale = per_sine(tilt, size);
    AngleError {
        turn: Vec3::new(across.x * scale, across.y * scale, 0.0),
        tilt,
    }
}

/// Angle over its sine or that of its half; where they vanish, any finite number.
fn per_sine(angle: f32, sine: f32) -> f32 {
    if sine > 1e-6 { angle / sine } else { 2.0 }
}

/// 1 up to a thrust error of 30 degrees, falling to 0 at 60.
fn trusted(tilt: f32) -> f32 {
    between((FRAC_PI_3 - tilt) * (1.0 / FRAC_PI_6), 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::arducopter::GAINS;
    use crate::units::Thrust;
    use proptest::prelude::*;

    fn asked(attitude: Quaternion, setpoint: &Setpoint) -> Asked {
        angle_loop(attitude, setpoint, &GAINS.angle)
    }

    fn towards(attitude: Quaternion, yaw: Yaw) -> Setpoint {
        Setpoint {
            attitude: Some(attitude),
            yaw,
            ..Setpoint::level(Thrust::ZERO)
        }
    }

    fn turned(x: f32, y: f32, z: f32) -> Quaternion {
        Quaternion::IDENTITY.turned_by(Vec3::new(x, y, z))
    }

    #[test]
    fn small_errors_are_corrected_in_proportion() {
        for yaw in [Yaw::Heading, Yaw::Rate] {
            let asked = asked(turned(0.1, -0.05, 0.0), &towards(Quaternion::IDENTITY, yaw));
            let rates = asked.wanted.rates.0;
            assert!((rates.x + 0.1 * GAINS.angle.p[0]).abs() < 0.01, "{yaw:?}");
            assert!((rates.y - 0.05 * GAINS.angle.p[1]).abs() < 0.01, "{yaw:?}");
            assert_eq!(asked.heading, 1.0);
        }
    }

    #[test]
    fn thrust_is_turned_the_shortest_way_whatever_the_heading() {
        let target = Quaternion::from_heading(2.0).then_body(turned(0.2, 0.0, 0.0));
        let asked = asked(
            Quaternion::from_heading(-1.0),
            &towards(target, Yaw::Heading),
        );
        let rates = asked.wanted.rates.0;
        let tilt = sqrt(rates.x * rates.x + rates.y * rates.y);
        assert!((tilt - 0.2 * GAINS.angle.p[0]).abs() < 0.01, "{rates:?}");
        let most = approach(
            GAINS.angle.yaw_error_limit_rad,
            GAINS.angle.p[2],
            GAINS.angle.acceleration_rad_s2[2],
        )
        .speed;
        assert!((rates.z - most).abs() < 1e-4, "{rates:?}");
        assert_eq!(asked.wanted.stiffness.z, 0.0);
    }

    #[test]
    fn far_from_the_thrust_wanted_heading_counts_for_nothing() {
        let tilted = |angle: f32| {
            let attitude =
                Quaternion::from_up(Vec3::new(0.0, -libm::sinf(angle), -libm::cosf(angle)));
            let attitude = attitude.expect("a direction");
            asked(attitude, &towards(Quaternion::IDENTITY, Yaw::Heading)).heading
        };
        assert_eq!(tilted(0.5), 1.0);
        assert!((tilted(0.785) - 0.5).abs() < 0.01);
        assert_eq!(tilted(1.1), 0.0);
    }

    #[test]
    fn upside_down_still_asks_for_a_turn() {
        let over = Quaternion {
            w: 0.0,
            v: Vec3::new(1.0, 0.0, 0.0),
        };
        for yaw in [Yaw::Heading, Yaw::Rate] {
            let asked = asked(over, &towards(Quaternion::IDENTITY, yaw));
            assert!(asked.wanted.rates.0.x.abs() > 5.0, "{yaw:?}");
        }
    }

    #[test]
    fn with_a_yaw_rate_the_heading_is_free() {
        let setpoint = towards(Quaternion::from_heading(2.0), Yaw::Rate);
        let asked = asked(Quaternion::IDENTITY, &setpoint).wanted;
        assert!(asked.rates.0.max_norm() < 1e-5);
        assert_eq!(asked.stiffness.z, 0.0);
    }

    #[test]
    fn a_small_turn_moves_the_wanted_rates_by_the_stiffness() {
        let turn = Vec3::new(0.01, -0.02, 0.005);
        for yaw in [Yaw::Heading, Yaw::Rate] {
            for lean in [0.1, 1.0] {
                let setpoint = towards(turned(lean, 0.0, 0.0), yaw);
                let before = asked(Quaternion::IDENTITY, &setpoint).wanted;
                let after = asked(Quaternion::IDENTITY.turned_by(turn), &setpoint).wanted;
                let miss =
                    (before.after_turn(turn).0 - after.rates.0).scale(Vec3::new(1.0, 0.0, 0.0));
                assert!(miss.max_norm() < 0.02, "{yaw:?} {lean} {miss:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn what_an_error_asks_for_is_finite_and_bounded(
            a in prop::array::uniform4(-1.0f32..1.0), b in prop::array::uniform4(-1.0f32..1.0),
        ) {
            let unit = |q: [f32; 4]| {
                let size = q.iter().map(|q| q * q).sum::<f32>().sqrt();
                Quaternion::from_array(q.map(|q| q / size)).unwrap_or_default()
            };
            for yaw in [Yaw::Heading, Yaw::Rate] {
                let asked = asked(unit(a), &towards(unit(b), yaw));
                prop_assert!(asked.wanted.rates.is_finite());
                prop_assert!(asked.wanted.stiffness.is_finite());
                let most = approach(3.2, GAINS.angle.p[0], GAINS.angle.acceleration_rad_s2[0]).speed;
                prop_assert!(asked.wanted.rates.0.max_norm() <= most);
                prop_assert!((0.0..=1.0).contains(&asked.heading));
            }
        }

        #[test]
        fn following_it_ends_at_the_target(
            x in -2.5f32..2.5, y in -2.5f32..2.5, heading in -3.0f32..3.0
        ) {
            let target = Quaternion::from_heading(heading);
            let mut attitude = (0..20).fold(Quaternion::IDENTITY, |q, _| {
                q.turned_by(Vec3::new(x, y, 0.0) * 0.05)
            });
            for _ in 0..1000 {
                let rates = asked(attitude, &towards(target, Yaw::Heading)).wanted.rates.0;
                attitude = attitude.turned_by(rates * 0.01);
            }
            prop_assert!(attitude.error_to(target).max_norm() < 0.02);
        }
    }
}

//! What the rate PID promises.

use super::*;
use crate::control::cleanflight::{Lean, level};
use crate::math::Quaternion;
use crate::units::BodyRates;
use proptest::prelude::*;

fn about_roll(x: f32) -> Vec3 {
    Vec3::new(x, 0.0, 0.0)
}

const DOWN: Vec3 = Vec3::new(0.0, 0.0, 1.0);

fn steady(rate: f32) -> Wanted {
    Wanted {
        rates: BodyRates(about_roll(rate)),
        stiffness: Vec3::ZERO,
    }
}

fn turned(angle: f32, dt: f32) -> Increment {
    Increment {
        angle: about_roll(angle),
        swept: about_roll(0.5 * angle * dt),
        dt,
        ..Increment::default()
    }
}

fn mixed(saturated: bool) -> Mixed {
    Mixed {
        saturated,
        ..crate::airframe::MIXER.mix_evenly(TorqueDemand::default(), half())
    }
}

fn half() -> Thrust {
    Thrust::new(0.5).expect("in range")
}

fn flying() -> Aim {
    Aim {
        thrust: half(),
        ..Aim::default()
    }
}

/// The integrals after a stretch in which the desired rate was steady.
fn after(state: &RateIntegrals, wanted: f32, motion: Increment, saturated: bool) -> RateIntegrals {
    let wanted = steady(wanted);
    let stretch = Stretch {
        motion: &motion,
        before: &wanted,
        after: &wanted,
        correction: Vec3::ZERO,
        aim: &flying(),
        down: DOWN,
    };
    integrated(state, &stretch, &mixed(saturated))
}

#[test]
fn without_time_the_output_follows_and_the_state_stays() {
    let state = after(&RateIntegrals::default(), 1.0, turned(0.0, 0.01), false);
    assert_eq!(after(&state, 5.0, Increment::default(), false), state);
    let out = demand(&state, &steady(2.0), &Rotation::default(), &flying(), false);
    assert!((out.0.x - 2.0 * RATE_P[0] - 0.01 * RATE_I[0]).abs() < 1e-6);
}

#[test]
fn a_saturated_integral_shrinks_and_comes_back_but_does_not_grow() {
    let grown = after(&RateIntegrals::default(), 1.0, turned(0.0, 0.1), false);
    assert_eq!(after(&grown, 1.0, turned(0.0, 0.1), true), grown);
    let shrunk = after(&grown, -0.5, turned(0.0, 0.1), true);
    assert!(shrunk.shares.x < grown.shares.x);
    assert_eq!(after(&shrunk, 5.0, turned(0.0, 0.1), true), grown);
}

#[test]
fn without_thrust_no_integral_grows() {
    let (motion, wanted) = (turned(0.0, 0.1), steady(1.0));
    let stretch = Stretch {
        motion: &motion,
        before: &wanted,
        after: &wanted,
        correction: Vec3::ZERO,
        aim: &Aim::default(),
        down: DOWN,
    };
    let state = integrated(&RateIntegrals::default(), &stretch, &mixed(false));
    assert_eq!(state, RateIntegrals::default());
}

#[test]
fn yaw_is_limited_to_what_its_desired_rate_allows() {
    let yaw = |wanted: f32, measured: f32| {
        let about_yaw = |rate| BodyRates(Vec3::new(0.0, 0.0, rate));
        let wanted = Wanted {
            rates: about_yaw(wanted),
            ..Wanted::default()
        };
        let rotation = Rotation {
            rates: about_yaw(measured),
            ..Rotation::default()
        };
        demand(
            &RateIntegrals::default(),
            &wanted,
            &rotation,
            &flying(),
            false,
        )
        .0
        .z
    };
    assert!((yaw(0.0, -10.0) - RATE_YAW_JUMP_LIMIT).abs() < 1e-6);
    assert!((yaw(0.5, -10.0) - RATE_YAW_JUMP_LIMIT - 0.5 * RATE_YAW_JUMP_SLOPE).abs() < 1e-6);
    assert!((yaw(30.0, 0.0) - RATE_YAW_P_LIMIT).abs() < 1e-6);
}

#[test]
fn blind_nothing_is_demanded() {
    let state = after(&RateIntegrals::default(), 1.0, turned(0.0, 0.1), false);
    let out = demand(&state, &steady(2.0), &Rotation::default(), &flying(), true);
    assert_eq!(out, TorqueDemand::default());
}

#[test]
fn full_thrust_takes_the_share_that_attenuation_says() {
    let full = Thrust::new(1.0).expect("in range");
    assert!((attenuation(full) - (1.0 - TPA_ATTENUATION)).abs() < 1e-6);
    assert_eq!(attenuation(Thrust::ZERO), 1.0);
}

proptest! {
    /// One stiff axis that levels itself, in one stretch and in fifty.
    #[test]
    fn rare_stretches_integrate_what_frequent_ones_do(
        rate in -2.0f32..2.0, start in -1.0f32..1.0, stiffness in 0.0f32..10.0
    ) {
        let wanted = |angle: f32| Wanted {
            rates: BodyRates(about_roll(start - stiffness * angle)),
            stiffness: about_roll(stiffness),
        };
        let run = |runs: u32, dt: f32| (0..runs).fold(RateIntegrals::default(), |state, step| {
            let motion = turned(rate * dt, dt);
            let at = |step: u32| wanted(rate * dt * step as f32);
            let (before, after) = (at(step), at(step + 1));
            let stretch = Stretch {
                motion: &motion,
                before: &before,
                after: &after,
                correction: Vec3::ZERO,
        aim: &flying(),
        down: DOWN,
            };
            integrated(&state, &stretch, &mixed(false))
        });
        let (often, rarely) = (run(50, 0.001), run(1, 0.05));
        prop_assert!((often.shares - rarely.shares).max_norm() < 1e-5);
    }

    /// A body that turns steadily from any lean, rolling over or not, levels itself.
    #[test]
    fn rare_stretches_know_that_roll_and_pitch_are_no_turns_of_the_body(
        roll in -3.1f32..3.1, pitch in -0.6f32..0.6, yaw in -3.0f32..3.0, rate in -3.0f32..3.0
    ) {
        let aim = Aim { lean: Some(Lean::default()), heading: None, ..flying() };
        let turn = Vec3::new(rate, 0.0, yaw);
        let start = Quaternion::IDENTITY
            .then_body(Quaternion::from_up(Vec3::new(
                libm::sinf(pitch),
                -libm::sinf(roll) * libm::cosf(pitch),
                -libm::cosf(roll) * libm::cosf(pitch),
            )).expect("a direction"));
        let run = |runs: u32, dt: f32| {
            let steps = (0..runs).scan(start, |attitude, _| {
                let before = *attitude;
                *attitude = (0..20).fold(before, |part, _| part.turned_by(turn * (dt / 20.0)));
                Some([before, *attitude])
            });
            steps.fold(RateIntegrals::default(), |state, [before, after]| {
                let motion = Increment {
                    angle: turn * dt,
                    swept: turn * (0.5 * dt * dt),
                    dt,
                    ..Increment::default()
                };
                let stretch = Stretch {
                    motion: &motion,
                    before: &level(before, &aim),
                    after: &level(after, &aim),
                    correction: Vec3::ZERO,
                    aim: &aim,
                    down: before.down_in_body(),
                };
                integrated(&state, &stretch, &mixed(false))
            })
        };
        let (often, rarely) = (run(40, 0.000_5), run(1, 0.02));
        prop_assert!((often.shares - rarely.shares).max_norm() < 1e-4, "{often:?} {rarely:?}");
    }

    #[test]
    fn demands_and_integrals_stay_bounded_whatever_comes(
        steps in prop::collection::vec(
            (any::<f32>(), any::<f32>(), any::<f32>(), 0.0f32..1.0, any::<bool>()), 1..100)
    ) {
        let mut state = RateIntegrals::default();
        for (wanted, angle, measured, dt, saturated) in steps {
            state = after(&state, wanted, turned(angle, dt), saturated);
            let rotation = Rotation {
                rates: BodyRates(Vec3::new(measured, angle, wanted)),
                acceleration: Vec3::new(angle, measured, measured),
            };
            let out = demand(&state, &steady(wanted), &rotation, &flying(), false);
            prop_assert!(out.0.max_norm() <= LARGEST, "{out:?}");
            prop_assert!(out.is_finite());
            prop_assert!(state.shares.max_norm() <= RATE_INTEGRAL_LIMIT);
        }
    }
}

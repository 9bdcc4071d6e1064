//! The rate PID, floating-point: Cleanflight's controller 2, called LuxFloat.

use super::Aim;
use crate::airframe::Mixed;
use crate::control::Wanted;
use crate::estimate::{Increment, Rotation};
use crate::math::{Vec3, between, limited, sqrt};
use crate::settings::gains::cleanflight::{Gains, Level, Tpa};
use crate::units::{Thrust, TorqueDemand};
use core::f32::consts::PI;

/// The largest demand, in full authorities: the original's has 16 bits of us.
const LARGEST: f32 = 32.0;

/// The least that counts of what is left of the vertical across the nose, squared.
///
/// That of 80 degrees: nearer to the vertical, roll and heading turn without bound.
const STEEPEST: f32 = 0.03;

/// What the rate PID remembers between runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateIntegrals {
    /// Integral terms, already multiplied by their gain.
    shares: Vec3,
    /// Their sizes when the motors could last give what was asked for.
    limits: Vec3,
}

/// A run's stretch of time, as the integral terms see it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<'a> {
    /// The motion in it.
    pub motion: &'a Increment,
    /// Desired rates at its beginning.
    pub before: &'a Wanted,
    /// Desired rates at its end.
    pub after: &'a Wanted,
    /// The turn (rad) by which the attitude's estimate was corrected in it.
    pub correction: Vec3,
    /// What was flown in it.
    pub aim: &'a Aim,
    /// Down in body axes at its beginning.
    pub down: Vec3,
}

impl Stretch<'_> {
    /// Desired rates integrated over it, less the angle turned, in rad.
    ///
    /// They fall as the body turns, and evenly with the correction. What they differ by in the
    /// end grew about as the square of the time; where the roll passed half a turn, at once.
    fn error(&self, gains: &Level) -> Vec3 {
        let (motion, dt) = (self.motion, self.motion.dt);
        let swept = motion.swept + self.correction * (0.5 * dt);
        let turned = motion.angle + self.correction;
        let moved = self.after.rates.0 - self.before.rates.0;
        let [jump, share] = self.rolled_over(moved.x, gains);
        let about_roll = |x| Vec3::new(x, 0.0, 0.0);
        let beside = moved + self.fallen(turned) - about_roll(jump);
        let mean = self.before.rates.0 + beside * (1.0 / 3.0) + about_roll(jump * share);
        mean * dt - self.fallen(swept) - motion.angle
    }

    /// By how much the desired rates fall with a turn (rad) of the body, to first order.
    ///
    /// Roll, pitch and heading are angles, not turns about the body's axes: the drone rolls with
    /// every turn to another heading while its nose is up or down.
    fn fallen(&self, turn: Vec3) -> Vec3 {
        let Vec3 { x, y, z } = self.down;
        let across = (y * y + z * z).max(STEEPEST);
        let heading = (y * turn.y + z * turn.z) / across;
        let pitch = (z * turn.y - y * turn.z) / sqrt(across);
        Vec3::new(turn.x - x * heading, pitch, heading).scale(self.before.stiffness)
    }

    /// By how much (rad/s) a roll past half a turn moved the desired rate, and for what share of
    /// the stretch; zero where it did not.
    fn rolled_over(&self, moved: f32, gains: &Level) -> [f32; 2] {
        let half = PI * gains.p;
        let Some(lean) = self.aim.lean.filter(|_| moved.abs() > half) else {
            return [0.0, 0.0];
        };
        let jump = (2.0 * half).copysign(moved);
        let asked = |wanted: &Wanted| wanted.rates.0.x - self.aim.rates.0.x;
        let start = lean.roll * gains.p - asked(self.before);
        let change = asked(self.before) - (asked(self.after) - jump);
        let past = (start + change).abs() - half;
        [jump, between(past / change.abs().max(1e-6), 0.0, 1.0)]
    }
}

/// The integral terms after a stretch; one of no length leaves them as they are.
///
/// While the motors saturate, and while there is next to no thrust, no term grows past the size
/// that it had before.
#[must_use]
pub fn integrated(
    state: &RateIntegrals,
    stretch: &Stretch,
    last: &Mixed,
    gains: &Gains,
) -> RateIntegrals {
    if stretch.motion.dt <= 0.0 {
        return *state;
    }
    let [x, y, z] = gains.rate.i;
    let step = stretch.error(&gains.level).scale(Vec3::new(x, y, z));
    let most = Vec3::new(
        gains.rate.integral_limit,
        gains.rate.integral_limit,
        gains.rate.integral_limit,
    );
    let shares = (state.shares + step).limited(most);
    if last.saturated || stretch.aim.thrust.share() < gains.altitude.low_thrust {
        return RateIntegrals {
            shares: shares.limited(state.limits),
            limits: state.limits,
        };
    }
    RateIntegrals {
        shares,
        limits: Vec3::new(shares.x.abs(), shares.y.abs(), shares.z.abs()),
    }
}

/// Torque demands: P and I on the rate's error, D on the measured rate.
///
/// Blind, nothing: the last demand, held for ever, would turn the drone over.
#[must_use]
pub fn demand(
    state: &RateIntegrals,
    wanted: &Wanted,
    rotation: &Rotation,
    aim: &Aim,
    blind: bool,
    gains: &Gains,
) -> TorqueDemand {
    if blind {
        return TorqueDemand::default();
    }
    let error = wanted.rates.0 - rotation.rates.0;
    let measured = rotation.acceleration;
    let [px, py, pz] = gains.rate.p;
    let [dx, dy, dz] = gains.rate.d;
    let damping = |gain: f32, acceleration: f32| limited(gain * acceleration, gains.rate.d_limit);
    let weight = attenuation(aim.thrust, &gains.tpa);
    let roll = weight * (px * error.x - damping(dx, measured.x)) + state.shares.x;
    let pitch = weight * (py * error.y - damping(dy, measured.y)) + state.shares.y;
    let yaw =
        limited(pz * error.z, gains.rate.yaw_p_limit) - damping(dz, measured.z) + state.shares.z;
    let yaw_limit = gains.rate.yaw_jump_limit + gains.rate.yaw_jump_slope * wanted.rates.0.z.abs();
    TorqueDemand(Vec3::new(
        limited(roll, LARGEST),
        limited(pitch, LARGEST),
        limited(limited(yaw, yaw_limit), LARGEST),
    ))
}

/// Throttle PID attenuation: the share of roll's and pitch's P and D that is left.
fn attenuation(thrust: Thrust, gains: &Tpa) -> f32 {
    let over = thrust.share() - gains.breakpoint;
    if over > 0.0 {
        1.0 - gains.attenuation * over / (1.0 - gains.breakpoint)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cleanflight::GAINS;
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
            ..crate::airframe::Mixer::default().mix(
                TorqueDemand::default(),
                half(),
                &crate::airframe::Evenly,
            )
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
    fn after(
        state: &RateIntegrals,
        wanted: f32,
        motion: Increment,
        saturated: bool,
    ) -> RateIntegrals {
        let wanted = steady(wanted);
        let stretch = Stretch {
            motion: &motion,
            before: &wanted,
            after: &wanted,
            correction: Vec3::ZERO,
            aim: &flying(),
            down: DOWN,
        };
        integrated(state, &stretch, &mixed(saturated), &GAINS)
    }

    #[test]
    fn without_time_the_output_follows_and_the_state_stays() {
        let state = after(&RateIntegrals::default(), 1.0, turned(0.0, 0.01), false);
        assert_eq!(after(&state, 5.0, Increment::default(), false), state);
        let out = demand(
            &state,
            &steady(2.0),
            &Rotation::default(),
            &flying(),
            false,
            &GAINS,
        );
        assert!((out.0.x - 2.0 * GAINS.rate.p[0] - 0.01 * GAINS.rate.i[0]).abs() < 1e-6);
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
        let state = integrated(&RateIntegrals::default(), &stretch, &mixed(false), &GAINS);
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
                &GAINS,
            )
            .0
            .z
        };
        assert!((yaw(0.0, -10.0) - GAINS.rate.yaw_jump_limit).abs() < 1e-6);
        assert!(
            (yaw(0.5, -10.0) - GAINS.rate.yaw_jump_limit - 0.5 * GAINS.rate.yaw_jump_slope).abs()
                < 1e-6
        );
        assert!((yaw(30.0, 0.0) - GAINS.rate.yaw_p_limit).abs() < 1e-6);
    }

    #[test]
    fn blind_nothing_is_demanded() {
        let state = after(&RateIntegrals::default(), 1.0, turned(0.0, 0.1), false);
        let out = demand(
            &state,
            &steady(2.0),
            &Rotation::default(),
            &flying(),
            true,
            &GAINS,
        );
        assert_eq!(out, TorqueDemand::default());
    }

    #[test]
    fn full_thrust_takes_the_share_that_attenuation_says() {
        let full = Thrust::new(1.0).expect("in range");
        assert!((attenuation(full, &GAINS.tpa) - (1.0 - GAINS.tpa.attenuation)).abs() < 1e-6);
        assert_eq!(attenuation(Thrust::ZERO, &GAINS.tpa), 1.0);
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
                integrated(&state, &stretch, &mixed(false), &GAINS)
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
                        before: &level(before, &aim, &GAINS.level),
                        after: &level(after, &aim, &GAINS.level),
                        correction: Vec3::ZERO,
                        aim: &aim,
                        down: before.down_in_body(),
                    };
                    integrated(&state, &stretch, &mixed(false), &GAINS)
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
                let out = demand(&state, &steady(wanted), &rotation, &flying(), false, &GAINS);
                prop_assert!(out.0.max_norm() <= LARGEST, "{out:?}");
                prop_assert!(out.is_finite());
                prop_assert!(state.shares.max_norm() <= GAINS.rate.integral_limit);
            }
        }
    }
}

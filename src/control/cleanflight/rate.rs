//! The rate PID, floating-point: Cleanflight's controller 2, called LuxFloat.

use super::Aim;
use crate::airframe::Mixed;
use crate::config::cleanflight::{
    ALTITUDE_LOW_THRUST, LEVEL_P, RATE_D, RATE_D_LIMIT, RATE_I, RATE_INTEGRAL_LIMIT, RATE_P,
    RATE_YAW_JUMP_LIMIT, RATE_YAW_JUMP_SLOPE, RATE_YAW_P_LIMIT, TPA_ATTENUATION, TPA_BREAKPOINT,
};
use crate::control::Wanted;
use crate::estimate::{Increment, Rotation};
use crate::math::{Vec3, between, limited, sqrt};
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
    fn error(&self) -> Vec3 {
        let (motion, dt) = (self.motion, self.motion.dt);
        let swept = motion.swept + self.correction * (0.5 * dt);
        let turned = motion.angle + self.correction;
        let moved = self.after.rates.0 - self.before.rates.0;
        let [jump, share] = self.rolled_over(moved.x);
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
    fn rolled_over(&self, moved: f32) -> [f32; 2] {
        const HALF: f32 = PI * LEVEL_P;
        let Some(lean) = self.aim.lean.filter(|_| moved.abs() > HALF) else {
            return [0.0, 0.0];
        };
        let jump = (2.0 * HALF).copysign(moved);
        let asked = |wanted: &Wanted| wanted.rates.0.x - self.aim.rates.0.x;
        let start = lean.roll * LEVEL_P - asked(self.before);
        let change = asked(self.before) - (asked(self.after) - jump);
        let past = (start + change).abs() - HALF;
        [jump, between(past / change.abs().max(1e-6), 0.0, 1.0)]
    }
}

/// The integral terms after a stretch; one of no length leaves them as they are.
///
/// While the motors saturate, and while there is next to no thrust, no term grows past the size
/// that it had before.
#[must_use]
pub fn integrated(state: &RateIntegrals, stretch: &Stretch, last: &Mixed) -> RateIntegrals {
    if stretch.motion.dt <= 0.0 {
        return *state;
    }
    let [x, y, z] = RATE_I;
    let step = stretch.error().scale(Vec3::new(x, y, z));
    let most = Vec3::new(
        RATE_INTEGRAL_LIMIT,
        RATE_INTEGRAL_LIMIT,
        RATE_INTEGRAL_LIMIT,
    );
    let shares = (state.shares + step).limited(most);
    if last.saturated || stretch.aim.thrust.share() < ALTITUDE_LOW_THRUST {
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
) -> TorqueDemand {
    if blind {
        return TorqueDemand::default();
    }
    let error = wanted.rates.0 - rotation.rates.0;
    let measured = rotation.acceleration;
    let [px, py, pz] = RATE_P;
    let [dx, dy, dz] = RATE_D;
    let damping = |gain: f32, acceleration: f32| limited(gain * acceleration, RATE_D_LIMIT);
    let weight = attenuation(aim.thrust);
    let roll = weight * (px * error.x - damping(dx, measured.x)) + state.shares.x;
    let pitch = weight * (py * error.y - damping(dy, measured.y)) + state.shares.y;
    let yaw = limited(pz * error.z, RATE_YAW_P_LIMIT) - damping(dz, measured.z) + state.shares.z;
    let yaw_limit = RATE_YAW_JUMP_LIMIT + RATE_YAW_JUMP_SLOPE * wanted.rates.0.z.abs();
    TorqueDemand(Vec3::new(
        limited(roll, LARGEST),
        limited(pitch, LARGEST),
        limited(limited(yaw, yaw_limit), LARGEST),
    ))
}

/// Throttle PID attenuation: the share of roll's and pitch's P and D that is left.
fn attenuation(thrust: Thrust) -> f32 {
    let over = thrust.share() - TPA_BREAKPOINT;
    if over > 0.0 {
        1.0 - TPA_ATTENUATION * over / (1.0 - TPA_BREAKPOINT)
    } else {
        1.0
    }
}

#[cfg(test)]
#[path = "rate_tests.rs"]
mod tests;

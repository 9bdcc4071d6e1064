//! The rate PID, floating-point: Cleanflight's controller 2, called LuxFloat.

use super::Aim;
use crate::airframe::Mixed;
use crate::config::cleanflight::{
    ALTITUDE_LOW_THRUST, RATE_D, RATE_D_LIMIT, RATE_I, RATE_INTEGRAL_LIMIT, RATE_P,
    RATE_YAW_JUMP_LIMIT, RATE_YAW_JUMP_SLOPE, RATE_YAW_P_LIMIT, TPA_ATTENUATION, TPA_BREAKPOINT,
};
use crate::control::Wanted;
use crate::estimate::{Increment, Rotation};
use crate::math::{Vec3, limited};
use crate::units::{Thrust, TorqueDemand};

/// The largest demand, in full authorities: the original's has 16 bits of us.
const LARGEST: f32 = 32.0;

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
}

impl Stretch<'_> {
    /// Desired rates integrated over it, less the angle turned, in rad.
    ///
    /// They fall as the body turns, to first order by the stiffness, and evenly with the
    /// correction. What they differ by in the end grew about as the square of the time.
    fn error(&self) -> Vec3 {
        let (motion, dt) = (self.motion, self.motion.dt);
        let swept = motion.swept + self.correction * (0.5 * dt);
        let turned = motion.angle + self.correction;
        let beside = self.after.rates.0 - self.before.after_turn(turned).0;
        self.before.integrated(swept, dt) + beside * (dt * (1.0 / 3.0)) - motion.angle
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
    thrust: Thrust,
    last: &Mixed,
) -> RateIntegrals {
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
    if last.saturated || thrust.share() < ALTITUDE_LOW_THRUST {
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

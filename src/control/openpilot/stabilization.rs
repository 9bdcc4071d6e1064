//! OpenPilot's Stabilization module: attitude PI to rates, rate PID to torque.
//!
//! What `outerloop.c` and `innerloop.c` do in LibrePilot 16.09 at fixed rates, for any spacing of
//! runs. Both integrals are held by `ILimit` alone, as there: no feedback from the motors stops
//! them. The derivative acts on the measured rate (`DerivativeGamma` 0, where the default is 1):
//! the kick from a step of the desired rate dies within 8 ms, and a command held for longer would
//! keep it.

use super::ErrorStretch;
use super::stretch::mean_limited;
use crate::control::{RateInput, RateLaw, RateState, RateStretch, Setpoint, Yaw};
use crate::math::{Quaternion, Vec3, atan2};
use crate::settings::gains::openpilot::Gains;
use crate::units::{BodyRates, TorqueDemand};

/// By how much an attitude misses a setpoint, and about which axes that counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeError {
    /// The turn that is missing, in rad, body axes, at most pi long.
    ///
    /// The original takes Euler angles of the same turn. True angles, not sines: they fall evenly
    /// as the body turns.
    pub angle: Vec3,
    /// 1 where the attitude is held, 0 where only a rate is asked for.
    pub axes: Vec3,
}

impl AttitudeError {
    /// The error of an attitude.
    ///
    /// Where the yaw flies a rate the target's tilt is taken relative to its own heading.
    #[must_use]
    pub fn of(attitude: Quaternion, setpoint: &Setpoint) -> Self {
        let Some(target) = setpoint.attitude else {
            return Self::default();
        };
        match setpoint.yaw {
            Yaw::Heading => {
                let turn = attitude.conjugate().then_body(target);
                let half = turn.v.norm();
                let (real, v) = if turn.w < 0.0 {
                    (-turn.w, -turn.v)
                } else {
                    (turn.w, turn.v)
                };
                Self {
                    angle: v * (2.0 * atan2(half, real) / half.max(SMALLEST)),
                    axes: Vec3::new(1.0, 1.0, 1.0),
                }
            }
            Yaw::Rate => {
                let (down, wanted) = (attitude.down_in_body(), target.down_in_body());
                let tilt = wanted.cross(down);
                let sine = tilt.norm();
                let scale = atan2(sine, wanted.dot(down)) / sine.max(SMALLEST);
                Self {
                    angle: Vec3::new(tilt.x * scale, tilt.y * scale, 0.0),
                    axes: Vec3::new(1.0, 1.0, 0.0),
                }
            }
        }
    }
}

/// The smallest sine that shows an axis; any below stands for no error.
const SMALLEST: f32 = 1e-6;

/// Gains and limits of the attitude loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudePi {
    /// Desired rate per rad of error, 1/s, about each axis.
    pub proportional: Vec3,
    /// Desired rate per integrated error, 1/s2, about each axis.
    pub integral: Vec3,
    /// The largest rate that integration may reach, rad/s, about each axis.
    pub integral_limit: Vec3,
    /// The largest rate that the error may ask for, rad/s, about each axis.
    pub maximum_rate: Vec3,
    /// The largest of a setpoint's own rates, rad/s, about each axis.
    pub manual_rate: Vec3,
}

/// Gains of both loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stabilization {
    /// The outer loop.
    pub attitude: AttitudePi,
    /// The inner loop.
    pub rate: RateLaw,
    /// The largest torque demand, as a share of full authority.
    pub output_limit: f32,
}

/// What both loops remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Integrals {
    /// Of the attitude loop, already multiplied by its gain, in rad/s.
    attitude: Vec3,
    /// Of the rate loop.
    rate: RateState,
    /// Measured rates when they last advanced.
    measured: BodyRates,
}

/// A stretch of time as both loops see it, flown with one setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StabilizedStretch {
    /// Error of the attitude.
    pub error: ErrorStretch,
    /// Axes about which it counts.
    pub axes: Vec3,
    /// Angle that the body turned, in rad.
    pub turned: Vec3,
    /// Measured rates at its end.
    pub measured: BodyRates,
}

impl Stabilization {
    /// The loops of some gains.
    #[must_use]
    pub const fn new(gains: &Gains) -> Self {
        let Gains { attitude, rate, .. } = gains;
        Self {
            attitude: AttitudePi {
                proportional: Vec3::from_array(attitude.kp),
                integral: Vec3::from_array(attitude.ki),
                integral_limit: Vec3::from_array(attitude.integral_limit_rad_s),
                maximum_rate: Vec3::from_array(attitude.maximum_rate_rad_s),
                manual_rate: Vec3::from_array(attitude.manual_rate_rad_s),
            },
            rate: RateLaw::new([rate.kp, rate.ki, rate.kd], rate.integral_limit),
            output_limit: rate.output_limit,
        }
    }

    /// Desired rates: what the attitude asks for, and the setpoint's own.
    #[must_use]
    pub fn wanted(
        &self,
        error: &AttitudeError,
        integrals: &Integrals,
        setpoint: &Setpoint,
    ) -> BodyRates {
        let law = &self.attitude;
        let asked = law.asked(error.angle, integrals.attitude.scale(error.axes));
        BodyRates(asked.limited(law.maximum_rate) + law.own(setpoint))
    }

    /// The integrals after a stretch of time; one of no length leaves them as they are.
    ///
    /// Without thrust there are none (`LowThrottleZeroIntegral`): on the ground they only wind up.
    /// The attitude loop's are none about axes that fly a rate.
    #[must_use]
    pub fn after(
        &self,
        before: &Integrals,
        setpoint: &Setpoint,
        stretch: &StabilizedStretch,
    ) -> Integrals {
        if setpoint.thrust.share() <= 0.0 {
            return Integrals::default();
        }
        let (dt, measured) = (stretch.error.dt, stretch.measured);
        if dt <= 0.0 {
            return *before;
        }
        let law = &self.attitude;
        let held = before.attitude.scale(stretch.axes);
        let attitude = stretch
            .error
            .integrated(held, law.integral, law.integral_limit);
        let [start, mean, end] = law.rates(&stretch.error, [held, attitude], setpoint);
        let rate_error = ErrorStretch {
            start: start - before.measured.0,
            end: end - measured.0,
            mean: mean - stretch.turned * (1.0 / dt),
            dt,
        };
        let rate = rate_error.parts().iter().fold(before.rate, |state, part| {
            let part = RateStretch {
                wanted: *part,
                ..RateStretch::default()
            };
            self.rate.after(&state, &part)
        });
        Integrals {
            attitude,
            rate,
            measured,
        }
    }

    /// Torque demands in a state.
    #[must_use]
    pub fn demand(&self, integrals: &Integrals, input: &RateInput) -> TorqueDemand {
        let limit = self.output_limit;
        let demand = self.rate.demand(&integrals.rate, input).0;
        TorqueDemand(demand.limited(Vec3::new(limit, limit, limit)))
    }
}

impl AttitudePi {
    fn asked(&self, error: Vec3, integral: Vec3) -> Vec3 {
        error.scale(self.proportional) + integral
    }

    fn own(&self, setpoint: &Setpoint) -> Vec3 {
        setpoint.rates.0.limited(self.manual_rate)
    }

    /// Desired rates at a stretch's start, in the mean and at its end.
    fn rates(
        &self,
        error: &ErrorStretch,
        [before, after]: [Vec3; 2],
        setpoint: &Setpoint,
    ) -> [Vec3; 3] {
        let own = self.own(setpoint);
        let start = self.asked(error.start, before);
        let end = self.asked(error.end, after);
        let mean = self.asked(error.mean, (before + after) * 0.5);
        let limit = self.maximum_rate;
        let mean = Vec3::new(
            mean_limited([start.x, end.x], mean.x, limit.x),
            mean_limited([start.y, end.y], mean.y, limit.y),
            mean_limited([start.z, end.z], mean.z, limit.z),
        );
        [
            start.limited(limit) + own,
            mean + own,
            end.limited(limit) + own,
        ]
    }
}

#[cfg(test)]
mod tests;

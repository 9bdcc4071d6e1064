//! OpenPilot's path follower and altitude hold: a goal to lean and thrust.
//!
//! The position asks for a velocity, the velocity for a lean north and east (a PID with
//! `ILimit`, and a share of the velocity asked for), the heading turns that into roll and pitch:
//! `vtolpathfollower.c` of OpenPilot 15.02. The height asks for a climb, the climb for thrust
//! about a neutral one, by the two-degree-of-freedom PID of AltitudeHold in LibrePilot 16.09,
//! whose integral is drawn back while the thrust is at a limit.
//!
//! The original steps every 50 ms; here each place covers the time since the one before, in which
//! the error goes in a straight line.

use super::ErrorStretch;
use crate::config::openpilot as gains;
use crate::control::{Goal, Setpoint, Yaw};
use crate::estimate::Place;
use crate::math::{Quaternion, Vec3, limited, sin_cos, wrapped};
use crate::units::{BodyRates, Thrust};

/// Time constant of the derivative's low-pass, of the original's 20 Hz, in s.
const DERIVATIVE_TIME: f32 = 1.0 / (core::f32::consts::TAU * 20.0);

/// How fast the thrust's integral is drawn back from a limit, in 1/s.
///
/// The original's: one over the mean of integral and derivative time.
const DRAWN_BACK: f32 = if gains::CLIMB_KI > 0.0 && gains::CLIMB_KP > 0.0 {
    2.0 / (gains::CLIMB_KP / gains::CLIMB_KI + gains::CLIMB_KD / gains::CLIMB_KP)
} else {
    0.0
};

/// What the path follower remembers between places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathState {
    /// A goal is flown to, and a place was seen since it was given.
    engaged: bool,
    /// Integral terms: lean north and east in rad, thrust below neutral along down.
    integral: Vec3,
    /// Error of the velocity at the last place, in m/s.
    error: Vec3,
    /// Velocity at the last place, in m/s.
    velocity: Vec3,
    /// Filtered acceleration, in m/s2.
    acceleration: Vec3,
}

/// The laws; the gains are those of the configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathFollower;

/// The velocity (m/s) that a goal asks for at a place, limited.
#[must_use]
pub fn velocity_wanted(goal: &Goal, place: &Place) -> Vec3 {
    let away = goal.position.0 - place.position.0;
    let asked = away.scale(Vec3::new(
        gains::POSITION_P,
        gains::POSITION_P,
        gains::ALTITUDE_P,
    )) + goal.velocity.0;
    let speed = Vec3::new(asked.x, asked.y, 0.0).norm();
    let fit = (gains::SPEED_LIMIT / speed.max(1e-3)).min(1.0);
    Vec3::new(
        asked.x * fit,
        asked.y * fit,
        limited(asked.z, gains::CLIMB_LIMIT),
    )
}

impl PathFollower {
    /// The state after a place; `flown` is the thrust flown until then.
    ///
    /// Without a goal there is none. With the first place the thrust's integral starts from what
    /// flew so far, where that is a thrust in flight. A place that covers no time advances none.
    #[must_use]
    pub fn after(
        &self,
        before: &PathState,
        place: &Place,
        goal: Option<&Goal>,
        flown: Thrust,
    ) -> PathState {
        let Some(goal) = goal else {
            return PathState::default();
        };
        let velocity = place.velocity.0;
        let error = velocity_wanted(goal, place) - velocity;
        let integral = if before.engaged {
            before.integral
        } else {
            Vec3::new(0.0, 0.0, started_from(flown))
        };
        let mut after = PathState {
            engaged: true,
            integral,
            error,
            velocity,
            acceleration: Vec3::ZERO,
        };
        if before.engaged && place.dt > 0.0 {
            let dt = place.dt;
            after.acceleration = (before.acceleration * DERIVATIVE_TIME + velocity
                - before.velocity)
                * (1.0 / (DERIVATIVE_TIME + dt));
            after.integral = grown(before, &after, dt);
        }
        after
    }

    /// The setpoint that flies to a goal; none until a place was seen.
    #[must_use]
    pub fn setpoint(&self, state: &PathState, place: &Place, goal: &Goal) -> Option<Setpoint> {
        if !state.engaged {
            return None;
        }
        let wanted = velocity_wanted(goal, place);
        let velocity = place.velocity.0;
        let lean = (wanted - velocity) * gains::VELOCITY_KP + state.integral
            - state.acceleration * gains::VELOCITY_KD
            + wanted * gains::VELOCITY_FEEDFORWARD;
        let thrust =
            proportional_thrust(wanted.z, velocity.z) + derivative_thrust(state) - state.integral.z;
        Some(Setpoint {
            attitude: Some(leaning(lean, goal.heading)),
            rates: BodyRates::default(),
            yaw: Yaw::Heading,
            thrust: Thrust::new(within_limits(thrust)).unwrap_or_default(),
        })
    }
}

/// The integral (thrust below neutral) that continues a flown thrust, if any.
fn started_from(flown: Thrust) -> f32 {
    let share = flown.share();
    if share < gains::THRUST_MINIMUM {
        return 0.0;
    }
    gains::THRUST_NEUTRAL - within_limits(share - gains::THRUST_NEUTRAL)
}

/// Thrust of an offset from neutral, within its limits.
fn within_limits(offset: f32) -> f32 {
    // Cannot panic: the ranges of the configuration keep the limits in order.
    (gains::THRUST_NEUTRAL + offset).clamp(gains::THRUST_MINIMUM, gains::THRUST_MAXIMUM)
}

fn proportional_thrust(wanted: f32, velocity: f32) -> f32 {
    -gains::CLIMB_KP * (gains::CLIMB_BETA * wanted - velocity)
}

fn derivative_thrust(state: &PathState) -> f32 {
    state.acceleration.z * gains::CLIMB_KD
}

/// The integral terms after the time (s) between two states.
fn grown(before: &PathState, after: &PathState, dt: f32) -> Vec3 {
    const GAIN: Vec3 = Vec3::new(gains::VELOCITY_KI, gains::VELOCITY_KI, gains::CLIMB_KI);
    const LIMIT: Vec3 = Vec3::new(gains::LEAN_INTEGRAL_LIMIT, gains::LEAN_INTEGRAL_LIMIT, 1.0);
    let error = ErrorStretch {
        start: before.error,
        end: after.error,
        mean: (before.error + after.error) * 0.5,
        dt,
    };
    let free = error.integrated(before.integral, GAIN, LIMIT);
    let z = drawn_back(
        [before.integral.z, free.z],
        [before, after].map(beside_integral),
        dt,
    );
    Vec3::new(free.x, free.y, z)
}

/// What a state adds to neutral thrust beside its integral.
fn beside_integral(state: &PathState) -> f32 {
    let velocity = state.velocity.z;
    proportional_thrust(state.error.z + velocity, velocity) + derivative_thrust(state)
}

/// The thrust's integral, which strives back by what the thrust is beyond a limit.
///
/// The exact course of `dI/dt = growth + rate * beyond` over the time, where growth is even and
/// what stands beside the integral goes in a straight line.
fn drawn_back([before, free]: [f32; 2], beside: [f32; 2], dt: f32) -> f32 {
    let beyond = |beside: f32, integral: f32| {
        let offset = beside - integral;
        gains::THRUST_NEUTRAL + offset - within_limits(offset)
    };
    let [start, end] = beside;
    if beyond(end, free) == 0.0 {
        return free;
    }
    let x = DRAWN_BACK * dt;
    let gone = -libm::expm1f(-x);
    let lasting = if x > 1e-3 { gone / x } else { 1.0 };
    let pushed = (free - before) * lasting + (end - start) * (1.0 - lasting);
    limited(before + beyond(start, before) * gone + pushed, 1.0)
}

/// The attitude with a heading (rad) that leans north and east (rad), limited.
///
/// The original turns the lean by the present heading. Turned by the one that is asked for, the
/// target leans the right way on Earth while the yaw is still under way too.
fn leaning(lean: Vec3, heading: f32) -> Quaternion {
    let heading = wrapped(heading);
    let (sin, cos) = sin_cos(heading);
    let roll = limited(lean.y * cos - lean.x * sin, gains::MAXIMUM_LEAN);
    let pitch = limited(-lean.x * cos - lean.y * sin, gains::MAXIMUM_LEAN);
    let about = |angle: f32, axis: Vec3| {
        let (sin, cos) = sin_cos(0.5 * angle);
        Quaternion {
            w: cos,
            v: axis * sin,
        }
    };
    Quaternion::from_heading(heading)
        .then_body(about(pitch, Vec3::new(0.0, 1.0, 0.0)))
        .then_body(about(roll, Vec3::new(1.0, 0.0, 0.0)))
}

#[cfg(test)]
mod tests;

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
use crate::control::{Goal, Setpoint, Yaw};
use crate::estimate::Place;
use crate::math::{Quaternion, Vec3, between, limited, sin_cos, wrapped};
use crate::settings::gains::openpilot::{Altitude, Gains, Position};
use crate::units::{BodyRates, Thrust};

/// Time constant of the derivative's low-pass, of the original's 20 Hz, in s.
const DERIVATIVE_TIME: f32 = 1.0 / (core::f32::consts::TAU * 20.0);

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

impl PathState {
    /// What remains while the drone stands: its thrust grows until it lifts off, its lean does not.
    #[must_use]
    pub fn standing(&self) -> Self {
        Self {
            integral: Vec3::new(0.0, 0.0, self.integral.z),
            ..*self
        }
    }
}

/// The laws of some gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathFollower {
    position: Position,
    altitude: Altitude,
    /// How fast the thrust's integral is drawn back from a limit, in 1/s.
    drawn_back: f32,
}

impl PathFollower {
    /// The laws of some gains.
    #[must_use]
    pub const fn new(gains: &Gains) -> Self {
        let altitude = gains.altitude;
        let (kp, ki) = (altitude.velocity_kp, altitude.velocity_ki);
        Self {
            position: gains.position,
            altitude,
            // As in the original: one over the mean of integral and derivative time.
            drawn_back: if ki > 0.0 && kp > 0.0 {
                2.0 / (kp / ki + altitude.velocity_kd / kp)
            } else {
                0.0
            },
        }
    }

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
        let error = self.velocity_wanted(goal, place) - velocity;
        let integral = if before.engaged {
            before.integral
        } else {
            Vec3::new(0.0, 0.0, self.started_from(flown))
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
            after.integral = self.grown(before, &after, dt);
        }
        after
    }

    /// The setpoint that flies to a goal; none until a place was seen.
    #[must_use]
    pub fn setpoint(&self, state: &PathState, place: &Place, goal: &Goal) -> Option<Setpoint> {
        if !state.engaged {
            return None;
        }
        let wanted = self.velocity_wanted(goal, place);
        let velocity = place.velocity.0;
        let lean = (wanted - velocity) * self.position.velocity_kp + state.integral
            - state.acceleration * self.position.velocity_kd
            + wanted * self.position.velocity_feedforward;
        let thrust = self.proportional_thrust(wanted.z, velocity.z) + self.derivative_thrust(state)
            - state.integral.z;
        Some(Setpoint {
            attitude: Some(self.leaning(lean, goal.heading)),
            rates: BodyRates::default(),
            yaw: Yaw::Heading,
            thrust: Thrust::new(self.within_limits(thrust)).unwrap_or_default(),
        })
    }

    /// The velocity (m/s) that a goal asks for at a place, limited.
    #[must_use]
    fn velocity_wanted(&self, goal: &Goal, place: &Place) -> Vec3 {
        let away = goal.position.0 - place.position.0;
        let asked = away.scale(Vec3::new(self.position.p, self.position.p, self.altitude.p))
            + goal.velocity.0;
        let speed = Vec3::new(asked.x, asked.y, 0.0).norm();
        let fit = (self.position.speed_limit_m_s / speed.max(1e-3)).min(1.0);
        Vec3::new(
            asked.x * fit,
            asked.y * fit,
            limited(asked.z, self.altitude.speed_limit_m_s),
        )
    }

    /// The integral (thrust below neutral) that continues a flown thrust, if any.
    fn started_from(&self, flown: Thrust) -> f32 {
        let share = flown.share();
        if share < self.altitude.thrust_minimum {
            return 0.0;
        }
        self.altitude.thrust_neutral - self.within_limits(share - self.altitude.thrust_neutral)
    }

    /// Thrust of an offset from neutral, within its limits.
    fn within_limits(&self, offset: f32) -> f32 {
        let Altitude {
            thrust_minimum: least,
            thrust_maximum: most,
            thrust_neutral: neutral,
            ..
        } = self.altitude;
        between(neutral + offset, least, most)
    }

    fn proportional_thrust(&self, wanted: f32, velocity: f32) -> f32 {
        -self.altitude.velocity_kp * (self.altitude.velocity_beta * wanted - velocity)
    }

    fn derivative_thrust(&self, state: &PathState) -> f32 {
        state.acceleration.z * self.altitude.velocity_kd
    }

    /// The integral terms after the time (s) between two states.
    fn grown(&self, before: &PathState, after: &PathState, dt: f32) -> Vec3 {
        let gain = Vec3::new(
            self.position.velocity_ki,
            self.position.velocity_ki,
            self.altitude.velocity_ki,
        );
        let limit = Vec3::new(
            self.position.integral_limit_rad,
            self.position.integral_limit_rad,
            1.0,
        );
        let error = ErrorStretch {
            start: before.error,
            end: after.error,
            mean: (before.error + after.error) * 0.5,
            dt,
        };
        let free = error.integrated(before.integral, gain, limit);
        let z = self.drawn_back(
            [before.integral.z, free.z],
            [before, after].map(|state| self.beside_integral(state)),
            dt,
        );
        Vec3::new(free.x, free.y, z)
    }

    /// What a state adds to neutral thrust beside its integral.
    fn beside_integral(&self, state: &PathState) -> f32 {
        let velocity = state.velocity.z;
        self.proportional_thrust(state.error.z + velocity, velocity) + self.derivative_thrust(state)
    }

    /// The thrust's integral, which strives back by what the thrust is beyond a limit.
    ///
    /// The exact course of `dI/dt = growth + rate * beyond` over the time, where growth is even and
    /// what stands beside the integral goes in a straight line.
    fn drawn_back(&self, [before, free]: [f32; 2], beside: [f32; 2], dt: f32) -> f32 {
        let beyond = |beside: f32, integral: f32| {
            let offset = beside - integral;
            self.altitude.thrust_neutral + offset - self.within_limits(offset)
        };
        let [start, end] = beside;
        if beyond(end, free) == 0.0 {
            return free;
        }
        let x = self.drawn_back * dt;
        let gone = -libm::expm1f(-x);
        let lasting = if x > 1e-3 { gone / x } else { 1.0 };
        let pushed = (free - before) * lasting + (end - start) * (1.0 - lasting);
        limited(before + beyond(start, before) * gone + pushed, 1.0)
    }

    /// The attitude with a heading (rad) that leans north and east (rad), limited.
    ///
    /// The original turns the lean by the present heading. Turned by the one that is asked for, the
    /// target leans the right way on Earth while the yaw is still under way too.
    fn leaning(&self, lean: Vec3, heading: f32) -> Quaternion {
        let heading = wrapped(heading);
        let (sin, cos) = sin_cos(heading);
        let roll = limited(lean.y * cos - lean.x * sin, self.position.maximum_lean_rad);
        let pitch = limited(-lean.x * cos - lean.y * sin, self.position.maximum_lean_rad);
        let turn_about = |angle: f32, axis: Vec3| {
            let (sin, cos) = sin_cos(0.5 * angle);
            Quaternion {
                w: cos,
                v: axis * sin,
            }
        };
        Quaternion::from_heading(heading)
            .then_body(turn_about(pitch, Vec3::new(0.0, 1.0, 0.0)))
            .then_body(turn_about(roll, Vec3::new(1.0, 0.0, 0.0)))
    }
}

#[cfg(test)]
mod tests;

//! Altitude and GPS hold: from goal and place to a lean and a thrust.
//!
//! Both begin with the first place behind a goal and forget everything when the goal goes. Errors
//! are taken as linear between two places, so that rare places integrate what frequent ones do.

use super::{Climb, beyond};
use crate::config::cleanflight::{
    ALTITUDE_CLIMB_LIMIT, ALTITUDE_D_LIMIT, ALTITUDE_DEADBAND, ALTITUDE_ERROR_LIMIT,
    ALTITUDE_HOVER_THRUST, ALTITUDE_INTEGRAL_LIMIT, ALTITUDE_LOW_THRUST, ALTITUDE_P,
    ALTITUDE_P_LIMIT, ALTITUDE_VELOCITY_D, ALTITUDE_VELOCITY_I, ALTITUDE_VELOCITY_P,
    POSITION_D_LEAST_SPEED, POSITION_INTEGRAL_LIMIT, POSITION_LEAN_LIMIT, POSITION_P,
    POSITION_SLEW, POSITION_SPEED_LIMIT, POSITION_VELOCITY_D, POSITION_VELOCITY_I,
    POSITION_VELOCITY_P,
};
use crate::control::Goal;
use crate::estimate::Place;
use crate::math::limited;
use crate::units::Thrust;

/// The largest error that is integrated, in m/s and m: no hold begins farther off.
const LARGEST: f32 = 100.0;

/// What the hold sees: where it shall be, where it is, and the setpoint's thrust.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// The place to hold, if one is to be held.
    pub goal: Option<Goal>,
    /// The newest place.
    pub place: Place,
    /// The setpoint's thrust: that of hovering, when a hold begins in flight.
    pub thrust: Thrust,
}

/// One horizontal axis of the GPS hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Along {
    /// Integral term, in rad.
    integral: f32,
    /// What the integral takes, as of the last place.
    error: f32,
    /// Lean asked for, in rad, after the slew limit.
    lean: f32,
}

/// What altitude and GPS hold remember between places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hold {
    /// A place was seen since the goal came.
    pub(super) begun: bool,
    /// Thrust taken for hovering.
    hover: f32,
    /// Integral term of the altitude, a share of full thrust.
    integral: f32,
    /// Error of the climb rate as of the last place, in m/s.
    error: f32,
    /// Thrust beside that of hovering.
    adjustment: f32,
    north: Along,
    east: Along,
}

impl Hold {
    /// Lean to the north and to the east, in rad.
    #[must_use]
    pub fn lean(&self) -> [f32; 2] {
        [self.north.lean, self.east.lean]
    }

    /// Collective thrust; that of hovering alone where thrust does not lift.
    #[must_use]
    pub fn thrust(&self, lifting: bool) -> Thrust {
        let adjustment = if lifting { self.adjustment } else { 0.0 };
        let share = (self.hover + adjustment).clamp(0.0, 1.0);
        Thrust::new(share).unwrap_or(Thrust::ZERO)
    }
}

/// The hold after a new place; one with `dt` of zero integrates nothing.
#[must_use]
pub fn held(before: &Hold, sight: &Sight, climb: &Climb) -> Hold {
    let Some(goal) = sight.goal else {
        return Hold::default();
    };
    let (mut hold, dt) = if before.begun {
        (*before, sight.place.dt)
    } else {
        (begun(sight.thrust), 0.0)
    };
    hold.take_altitude(&goal, &sight.place, climb, dt);
    let position = goal.position.0 - sight.place.position.0;
    let (wanted, actual) = (goal.velocity.0, sight.place.velocity.0);
    hold.north.take(position.x, wanted.x, actual.x, dt);
    hold.east.take(position.y, wanted.y, actual.y, dt);
    hold
}

/// A hold that begins now: the setpoint's thrust hovers, unless it is too low.
fn begun(thrust: Thrust) -> Hold {
    let hovering = thrust.share() >= ALTITUDE_LOW_THRUST;
    Hold {
        begun: true,
        hover: if hovering {
            thrust.share()
        } else {
            ALTITUDE_HOVER_THRUST
        },
        ..Hold::default()
    }
}

impl Hold {
    /// Altitude to climb rate to thrust, all counted upwards.
    fn take_altitude(&mut self, goal: &Goal, place: &Place, climb: &Climb, dt: f32) {
        let missing = place.position.0.z - goal.position.0.z;
        let missing = beyond(limited(missing, ALTITUDE_ERROR_LIMIT), ALTITUDE_DEADBAND);
        let wanted = limited(ALTITUDE_P * missing, ALTITUDE_CLIMB_LIMIT) - goal.velocity.0.z;
        let error = limited(wanted + place.velocity.0.z, LARGEST);
        let step = ALTITUDE_VELOCITY_I * mean(&mut self.error, error) * dt;
        self.integral = limited(self.integral + step, ALTITUDE_INTEGRAL_LIMIT);
        let damping = ALTITUDE_VELOCITY_D * climb.acceleration;
        self.adjustment = limited(ALTITUDE_VELOCITY_P * error, ALTITUDE_P_LIMIT) + self.integral
            - limited(damping, ALTITUDE_D_LIMIT);
    }
}

impl Along {
    /// Position to speed to lean, all counted towards the axis.
    ///
    /// As published the integral takes the position's error too, and the derivative is that of
    /// the position's error: a difference of speeds.
    fn take(&mut self, missing: f32, wanted: f32, actual: f32, dt: f32) {
        let speed = limited(POSITION_P * missing, POSITION_SPEED_LIMIT) + wanted;
        let error = limited(speed - actual, LARGEST);
        let integrated = limited(error + limited(missing, LARGEST), LARGEST);
        let step = POSITION_VELOCITY_I * mean(&mut self.error, integrated) * dt;
        self.integral = limited(self.integral + step, POSITION_INTEGRAL_LIMIT);
        let derivative = if actual.abs() < POSITION_D_LEAST_SPEED {
            0.0
        } else {
            limited(
                POSITION_VELOCITY_D * (wanted - actual),
                POSITION_INTEGRAL_LIMIT,
            )
        };
        let lean = POSITION_VELOCITY_P * error + self.integral + derivative;
        let lean = limited(lean, POSITION_LEAN_LIMIT);
        self.lean += limited(lean - self.lean, POSITION_SLEW * dt);
    }
}

/// The mean of an error since the last place, which `last` then holds.
fn mean(last: &mut f32, now: f32) -> f32 {
    let mean = 0.5 * (*last + now);
    *last = now;
    mean
}

#[cfg(test)]
#[path = "hold_tests.rs"]
mod tests;

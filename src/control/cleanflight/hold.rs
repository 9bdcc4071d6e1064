//! Altitude and GPS hold: from goal and place to a lean and a thrust.
//!
//! Both begin with the first place behind a goal and forget everything when the goal goes. Errors
//! are taken as linear between two places, so that rare places integrate what frequent ones do.

use super::{Climb, beyond};
use crate::control::Goal;
use crate::estimate::Place;
use crate::math::{between, limited};
use crate::settings::gains::cleanflight::{Altitude, Gains, Position};
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
        let share = between(self.hover + adjustment, 0.0, 1.0);
        Thrust::new(share).unwrap_or(Thrust::ZERO)
    }
}

/// The hold after a new place; one with `dt` of zero integrates nothing.
#[must_use]
pub fn held(before: &Hold, sight: &Sight, climb: &Climb, gains: &Gains) -> Hold {
    let Some(goal) = sight.goal else {
        return Hold::default();
    };
    let (mut hold, dt) = if before.begun {
        (*before, sight.place.dt)
    } else {
        (begun(sight.thrust, &gains.altitude), 0.0)
    };
    hold.take_altitude(&goal, &sight.place, climb, dt, &gains.altitude);
    let position = goal.position.0 - sight.place.position.0;
    let (wanted, actual) = (goal.velocity.0, sight.place.velocity.0);
    hold.north
        .take(position.x, wanted.x, actual.x, dt, &gains.position);
    hold.east
        .take(position.y, wanted.y, actual.y, dt, &gains.position);
    hold
}

/// A hold that begins now: the setpoint's thrust hovers, unless it is too low.
fn begun(thrust: Thrust, gains: &Altitude) -> Hold {
    let hovering = thrust.share() >= gains.low_thrust;
    Hold {
        begun: true,
        hover: if hovering {
            thrust.share()
        } else {
            gains.hover_thrust
        },
        ..Hold::default()
    }
}

impl Hold {
    /// Altitude to climb rate to thrust, all counted upwards.
    fn take_altitude(
        &mut self,
        goal: &Goal,
        place: &Place,
        climb: &Climb,
        dt: f32,
        gains: &Altitude,
    ) {
        let missing = place.position.0.z - goal.position.0.z;
        let missing = beyond(limited(missing, gains.error_limit_m), gains.deadband_m);
        let wanted = limited(gains.p * missing, gains.climb_limit_m_s) - goal.velocity.0.z;
        let error = limited(wanted + place.velocity.0.z, LARGEST);
        let step = gains.velocity_i * mean(&mut self.error, error) * dt;
        self.integral = limited(self.integral + step, gains.integral_limit);
        let damping = gains.velocity_d * climb.acceleration;
        self.adjustment = limited(gains.velocity_p * error, gains.p_limit) + self.integral
            - limited(damping, gains.d_limit);
    }
}

impl Along {
    /// Position to speed to lean, all counted towards the axis.
    ///
    /// As published the integral takes the position's error too, and the derivative is that of
    /// the position's error: a difference of speeds.
    fn take(&mut self, missing: f32, wanted: f32, actual: f32, dt: f32, gains: &Position) {
        let speed = limited(gains.p * missing, gains.speed_limit_m_s) + wanted;
        let error = limited(speed - actual, LARGEST);
        let integrated = limited(error + limited(missing, LARGEST), LARGEST);
        let step = gains.velocity_i * mean(&mut self.error, integrated) * dt;
        self.integral = limited(self.integral + step, gains.integral_limit_rad);
        let derivative = if actual.abs() < gains.d_least_speed_m_s {
            0.0
        } else {
            limited(
                gains.velocity_d * (wanted - actual),
                gains.integral_limit_rad,
            )
        };
        let lean = gains.velocity_p * error + self.integral + derivative;
        let lean = limited(lean, gains.lean_limit_rad);
        self.lean += limited(lean - self.lean, gains.slew_rad_s * dt);
    }
}

/// The mean of an error since the last place, which `last` then holds.
fn mean(last: &mut f32, now: f32) -> f32 {
    let mean = 0.5 * (*last + now);
    *last = now;
    mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::cleanflight::GAINS;
    use crate::math::Vec3;
    use crate::units::{Position, Velocity};
    use proptest::prelude::*;

    fn place(position: Vec3, velocity: Vec3, dt: f32) -> Place {
        Place {
            position: Position(position),
            velocity: Velocity(velocity),
            dt,
        }
    }

    /// A goal at the origin, seen from a place.
    fn seen(place: Place, thrust: f32) -> Sight {
        Sight {
            goal: Some(Goal::default()),
            place,
            thrust: Thrust::new(thrust).expect("in range"),
        }
    }

    fn run(runs: u32, sight: &Sight) -> Hold {
        (0..runs).fold(Hold::default(), |hold, _| {
            held(&hold, sight, &Climb::default(), &GAINS)
        })
    }

    #[test]
    fn a_hold_that_begins_in_flight_hovers_with_the_thrust_it_finds() {
        let at_goal = place(Vec3::ZERO, Vec3::ZERO, 0.02);
        let found = run(1, &seen(at_goal, 0.42)).thrust(true);
        assert!((found.share() - 0.42).abs() < 1e-6);
        let given = run(1, &seen(at_goal, 0.0)).thrust(true);
        assert!((given.share() - GAINS.altitude.hover_thrust).abs() < 1e-6);
    }

    #[test]
    fn below_the_goal_or_sinking_asks_for_more_thrust() {
        let below = seen(place(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 0.02), 0.4);
        assert!(run(1, &below).thrust(true).share() > 0.5);
        let sinking = seen(place(Vec3::ZERO, Vec3::new(0.0, 0.0, 0.5), 0.02), 0.4);
        assert!(run(1, &sinking).thrust(true).share() > 0.5);
        assert!((run(1, &sinking).thrust(false).share() - 0.4).abs() < 1e-6);
    }

    #[test]
    fn upward_acceleration_is_damped() {
        let sight = seen(place(Vec3::ZERO, Vec3::ZERO, 0.02), 0.4);
        let climb = Climb { acceleration: 10.0 };
        let share = held(&Hold::default(), &sight, &climb, &GAINS)
            .thrust(true)
            .share();
        assert!((share - 0.4 + 10.0 * GAINS.altitude.velocity_d).abs() < 1e-6);
    }

    #[test]
    fn without_time_nothing_is_integrated_and_no_lean_changes() {
        let start = run(
            10,
            &seen(place(Vec3::new(3.0, -2.0, 1.0), Vec3::ZERO, 0.1), 0.4),
        );
        let still = seen(place(Vec3::new(3.0, -2.0, 1.0), Vec3::ZERO, 0.0), 0.4);
        assert_eq!(held(&start, &still, &Climb::default(), &GAINS), start);
    }

    #[test]
    fn without_a_goal_everything_is_forgotten() {
        let start = run(
            10,
            &seen(place(Vec3::new(3.0, 0.0, 1.0), Vec3::ZERO, 0.1), 0.4),
        );
        let sight = Sight::default();
        assert_eq!(
            held(&start, &sight, &Climb::default(), &GAINS),
            Hold::default()
        );
    }

    #[test]
    fn a_drone_that_leans_as_asked_comes_to_the_goal_and_stays() {
        let dt = 0.05;
        let (mut hold, mut position, mut velocity) =
            (Hold::default(), Vec3::new(3.0, -2.0, 2.0), Vec3::ZERO);
        // A wind that pushes with a tenth of 1 g, and a drone heavier than was taken.
        for _ in 0..6_000 {
            let sight = seen(place(position, velocity, dt), 0.4);
            hold = held(&hold, &sight, &Climb::default(), &GAINS);
            let [north, east] = hold.lean();
            let upward = (hold.thrust(true).share() / 0.45 - 1.0) * 9.8;
            let acceleration = Vec3::new(9.8 * north - 0.3, 9.8 * east, -upward);
            velocity += acceleration * dt;
            position += velocity * dt;
        }
        assert!(position.max_norm() < 0.5, "{position:?}");
        assert!(velocity.max_norm() < 0.1, "{velocity:?}");
    }

    proptest! {
        #[test]
        fn rare_places_come_to_the_same_as_frequent_ones(
            x in -5.0f32..5.0, z in -3.0f32..3.0, vx in -2.0f32..2.0, vz in -1.0f32..1.0
        ) {
            // A drone that coasts, seen every 10 ms and every 100 ms.
            let coasting = |every: u32| {
                (0..=200u32).step_by(every as usize).fold(Hold::default(), |hold, step| {
                    let (from, velocity) = (Vec3::new(x, 0.0, z), Vec3::new(vx, 0.0, vz));
                    let at = from + velocity * (step as f32 * 0.01);
                    let sight = seen(place(at, velocity, every as f32 * 0.01), 0.4);
                    held(&hold, &sight, &Climb::default(), &GAINS)
                })
            };
            let (often, rarely) = (coasting(1), coasting(10));
            prop_assert!((often.north.integral - rarely.north.integral).abs() < 1e-4);
            prop_assert!((often.integral - rarely.integral).abs() < 1e-4);
            prop_assert!((often.thrust(true).share() - rarely.thrust(true).share()).abs() < 1e-3);
            prop_assert!((often.north.lean - rarely.north.lean).abs() < 1e-3);
        }

        #[test]
        fn lean_and_thrust_stay_bounded_whatever_comes(
            places in prop::collection::vec(
                (any::<f32>(), any::<f32>(), any::<f32>(), any::<f32>(), 0.0f32..2.0), 1..50)
        ) {
            let mut hold = Hold::default();
            for (x, z, vx, vz, dt) in places {
                let sight = seen(place(Vec3::new(x, -x, z), Vec3::new(vx, z, vz), dt), 0.4);
                hold = held(&hold, &sight, &Climb { acceleration: vz }, &GAINS);
                for lean in hold.lean() {
                    prop_assert!(lean.abs() <= GAINS.position.lean_limit_rad + 1e-6, "{hold:?}");
                }
                prop_assert!((0.0..=1.0).contains(&hold.thrust(true).share()));
                prop_assert!(hold.adjustment.is_finite());
            }
        }
    }
}

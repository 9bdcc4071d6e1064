//! Position and velocity loops: from a goal to a lean and a vertical acceleration.

use super::approach::approach;
use crate::control::one_pole::{gone, time_constant};
use crate::control::{Goal, Setpoint, Yaw};
use crate::estimate::Place;
use crate::math::{Quaternion, Vec3, between, limited, sin_cos};
use crate::sensors::GRAVITY;
use crate::settings::gains::arducopter::Gains;
use crate::units::BodyRates;

/// The largest error told from larger ones, in m and m/s: squares stay finite.
const FARTHEST: Vec3 = Vec3::new(10_000.0, 10_000.0, 10_000.0);

/// What the velocity loop remembers between places; all in north-east-down axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Whether there was a goal.
    following: bool,
    /// Filtered error of the velocity, in m/s.
    error: Vec3,
    /// Its filtered derivative, in m/s2.
    slope: Vec3,
    /// Integral term, in m/s2; nothing vertical.
    integral: Vec3,
    /// Downward speed, in m/s.
    descent: f32,
}

/// What the altitude loop asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Climb {
    /// Upward acceleration, in m/s2.
    pub acceleration: f32,
    /// Present climb rate, in m/s.
    pub rate: f32,
}

/// The course after a new place; without a goal it is forgotten.
///
/// A place of no `dt`, the first one or one after a silence, begins the filters anew.
#[must_use]
pub fn moved(course: &Course, place: &Place, goal: Option<Goal>, gains: &Gains) -> Course {
    let Some(goal) = goal else {
        return Course::default();
    };
    let velocity = place.velocity.0;
    let error = (wanted_velocity(&goal, place, gains) - velocity).limited(FARTHEST);
    let dt = place.dt;
    let begun = Course {
        following: true,
        error,
        slope: Vec3::ZERO,
        descent: velocity.z,
        ..*course
    };
    if !course.following || dt <= 0.0 {
        return begun;
    }
    let share = gone(dt, time_constant(gains.velocity.cutoff_hz));
    let change = (error - course.error) * share;
    let slope = course.slope + (change * (1.0 / dt) - course.slope) * share;
    let filtered = course.error + change;
    let before = Course {
        error: filtered,
        slope,
        ..begun
    };
    Course {
        integral: integral(&before, dt, gains),
        ..before
    }
}

/// The integral term after `dt` (s); it does not grow while the lean is limited.
fn integral(course: &Course, dt: f32, gains: &Gains) -> Vec3 {
    let horizontal = Vec3 {
        z: 0.0,
        ..course.error
    };
    let next = course.integral + horizontal * (gains.velocity.i * dt);
    let leaning = asked(course, gains).norm() > most_acceleration(gains);
    if leaning && next.dot(next) > course.integral.dot(course.integral) {
        return course.integral;
    }
    shortened(next, gains.velocity.integral_limit_m_s2)
}

/// The velocity that brings the drone to its goal.
fn wanted_velocity(goal: &Goal, place: &Place, gains: &Gains) -> Vec3 {
    let error = (goal.position.0 - place.position.0).limited(FARTHEST);
    let across = Vec3 { z: 0.0, ..error };
    let distance = across.norm();
    let speed = approach(distance, gains.position.p, gains.position.acceleration_m_s2).speed;
    let horizontal = if distance > 1e-6 {
        across * (speed.min(gains.position.speed_m_s) / distance)
    } else {
        Vec3::ZERO
    };
    let down = approach(error.z, gains.altitude.p, gains.altitude.acceleration_m_s2).speed;
    let vertical = Vec3::new(
        0.0,
        0.0,
        between(down, -gains.altitude.climb_m_s, gains.altitude.descent_m_s),
    );
    horizontal + vertical + goal.velocity.0
}

/// The horizontal acceleration that the velocity loop asks for, before its limit.
fn asked(course: &Course, gains: &Gains) -> Vec3 {
    let asked = course.error * gains.velocity.p + course.integral + course.slope * gains.velocity.d;
    Vec3 { z: 0.0, ..asked }
}

/// The acceleration that the steepest lean gives at constant altitude, in m/s2.
fn most_acceleration(gains: &Gains) -> f32 {
    let (sin, cos) = sin_cos(gains.velocity.lean_limit_rad);
    GRAVITY * sin / cos
}

fn shortened(vector: Vec3, longest: f32) -> Vec3 {
    let length = vector.norm();
    if length > longest {
        vector * (longest / length)
    } else {
        vector
    }
}

/// What the altitude loop asks for; nothing without a goal.
#[must_use]
pub fn climbing(goal: Option<Goal>, course: &Course, gains: &Gains) -> Option<Climb> {
    (goal.is_some() && course.following).then(|| Climb {
        acceleration: limited(-course.error.z * gains.altitude.climb_p, GRAVITY),
        rate: -course.descent,
    })
}

/// The setpoint to fly: the lean towards the goal, else the one given.
///
/// Thrust points against gravity plus the acceleration asked for; a goal's heading is held.
#[must_use]
pub fn steered(
    goal: Option<Goal>,
    course: &Course,
    setpoint: &Setpoint,
    gains: &Gains,
) -> Setpoint {
    let Some(goal) = goal.filter(|_| course.following) else {
        return *setpoint;
    };
    let wanted = shortened(asked(course, gains), most_acceleration(gains));
    let heading = Quaternion::from_heading(goal.heading);
    let up = heading.to_body(wanted) - Vec3::new(0.0, 0.0, GRAVITY);
    let tilt = Quaternion::from_up(up).map_or(Quaternion::IDENTITY, Quaternion::conjugate);
    Setpoint {
        attitude: Some(heading.then_body(tilt)),
        rates: BodyRates::default(),
        yaw: Yaw::Heading,
        thrust: setpoint.thrust,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::arducopter::GAINS;
    use crate::units::{Position, Velocity};
    use proptest::prelude::*;

    fn at(position: Vec3, velocity: Vec3, dt: f32) -> Place {
        Place {
            position: Position(position),
            velocity: Velocity(velocity),
            dt,
        }
    }

    fn origin() -> Option<Goal> {
        Some(Goal::default())
    }

    fn lean(course: &Course, goal: Option<Goal>) -> Quaternion {
        steered(goal, course, &Setpoint::default(), &GAINS)
            .attitude
            .expect("an attitude")
    }

    #[test]
    fn without_a_goal_the_setpoint_is_flown() {
        let course = moved(&Course::default(), &Place::default(), None, &GAINS);
        let given = Setpoint {
            yaw: Yaw::Heading,
            ..Setpoint::default()
        };
        assert_eq!(steered(None, &course, &given, &GAINS), given);
        assert_eq!(steered(origin(), &course, &given, &GAINS), given);
        assert_eq!(climbing(None, &course, &GAINS), None);
    }

    #[test]
    fn north_of_the_goal_it_leans_south_in_any_heading() {
        for heading in [0.0, 1.0, -2.5] {
            let goal = Some(Goal {
                heading,
                ..Goal::default()
            });
            let place = at(Vec3::new(1.0, 0.0, 0.0), Vec3::ZERO, 0.02);
            let course = moved(&Course::default(), &place, goal, &GAINS);
            let attitude = lean(&course, goal);
            let thrust = attitude.to_earth(Vec3::new(0.0, 0.0, -1.0));
            assert!(thrust.x < -0.1 && thrust.y.abs() < 1e-4, "{thrust:?}");
            assert!((attitude.heading() - heading).abs() < 0.05);
        }
    }

    #[test]
    fn below_the_goal_it_climbs() {
        let place = at(Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO, 0.02);
        let course = moved(&Course::default(), &place, origin(), &GAINS);
        let asked = climbing(origin(), &course, &GAINS).expect("a goal");
        assert!((asked.acceleration - GAINS.altitude.p * GAINS.altitude.climb_p).abs() < 1e-4);
    }

    #[test]
    fn a_place_of_no_time_begins_the_filters_and_integrates_nothing() {
        let goal = origin();
        let place = at(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, 0.02);
        let flown = (0..10).fold(Course::default(), |course, _| {
            moved(&course, &place, goal, &GAINS)
        });
        let again = moved(&flown, &Place { dt: 0.0, ..place }, goal, &GAINS);
        assert_eq!(again.integral, flown.integral);
        assert_eq!(again.slope, Vec3::ZERO);
        assert_eq!(
            moved(&again, &Place { dt: 0.0, ..place }, goal, &GAINS),
            again
        );
    }

    #[test]
    fn a_point_mass_comes_to_its_goal_whatever_the_rate_of_places() {
        for dt in [0.01, 0.02, 0.1] {
            let mut course = Course::default();
            let mut position = Vec3::new(8.0, -5.0, 0.0);
            let mut velocity = Vec3::ZERO;
            let wind = Vec3::new(0.5, 0.3, 0.0);
            for _ in 0..(40.0 / dt) as u32 {
                course = moved(&course, &at(position, velocity, dt), origin(), &GAINS);
                let thrust = lean(&course, origin()).to_earth(Vec3::new(0.0, 0.0, -1.0));
                let horizontal = Vec3 { z: 0.0, ..thrust } * (GRAVITY / -thrust.z);
                velocity += (horizontal + wind) * dt;
                position += velocity * dt;
            }
            assert!(position.max_norm() < 0.05, "{dt} {position:?}");
        }
    }

    proptest! {
        #[test]
        fn lean_and_climb_are_finite_and_limited_on_any_input(
            places in prop::collection::vec(
                (prop::array::uniform3(-1e30f32..1e30), prop::array::uniform3(-1e4f32..1e4),
                 prop::array::uniform3(-50.0f32..50.0), 0.0f32..1.0), 1..30),
            heading in -4.0f32..4.0
        ) {
            let mut course = Course::default();
            let vector = |[x, y, z]: [f32; 3]| Vec3::new(x, y, z);
            for (goal, position, velocity, dt) in places {
                let goal = Some(Goal { position: Position(vector(goal)), heading, ..Goal::default() });
                course = moved(&course, &at(vector(position), vector(velocity), dt), goal, &GAINS);
                let down = lean(&course, goal).down_in_body();
                prop_assert!(down.is_finite());
                let (_, cos) = sin_cos(GAINS.velocity.lean_limit_rad);
                prop_assert!(down.z > cos - 1e-3, "{down:?}");
                let climb = climbing(origin(), &course, &GAINS).expect("a goal");
                prop_assert!(climb.acceleration.abs() <= GRAVITY && climb.rate.is_finite());
                prop_assert!(course.integral.norm() <= GAINS.velocity.integral_limit_m_s2 * 1.001);
            }
        }

        #[test]
        fn many_places_of_a_steady_error_are_one_of_their_time(
            x in -2.0f32..2.0, y in -2.0f32..2.0
        ) {
            let place = |dt| at(Vec3::new(x, y, 0.3), Vec3::ZERO, dt);
            let begun = moved(&Course::default(), &place(0.0), origin(), &GAINS);
            let often = (0..10).fold(begun, |course, _| moved(&course, &place(0.01), origin(), &GAINS));
            let rarely = moved(&begun, &place(0.1), origin(), &GAINS);
            prop_assert!((often.integral - rarely.integral).max_norm() < 1e-4);
            prop_assert!((often.error - rarely.error).max_norm() < 1e-4);
        }
    }
}

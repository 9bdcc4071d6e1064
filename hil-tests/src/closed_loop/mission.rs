//! What is flown: a point that moves ahead of the drone, from the ground on.
//!
//! The point climbs to flying height, then hovers or goes round waypoints. It slows down for
//! corners, and waits for a drone that falls behind, as the leash of an autopilot's waypoint
//! controller does. It knows the drone's true place: errors of the places that the drone is told
//! change no goal. The heading stays north, as some logics turn at a few degrees per second only;
//! the mission `turn` turns slowly.

use std::f64::consts::TAU;

use clap::ValueEnum;
use nalgebra::{Vector2, Vector3};
use rand_distr::{Distribution, StandardUniform};
use random_streams::generator;

/// Height flown at, m (Bregu et al. 2016, section 7.1).
pub const HEIGHT_M: f64 = 5.0;
/// Highest speed between waypoints, m/s (same section).
const SPEED_M_S: f64 = 3.0;
/// Waypoints of a path (same section).
const WAYPOINTS: usize = 8;
/// Speed of the climb to flying height, m/s.
const CLIMB_M_S: f64 = 1.0;
/// How fast the point gathers speed and loses it, m/s2.
const ACCELERATION_M_S2: f64 = 1.0;
/// How far the drone may be behind before the point slows, and before it stops, m.
const LEASH_M: [f64; 2] = [1.0, 3.0];
/// How fast the heading turns where that is the mission, rad/s: once a minute.
const TURN_RAD_S: f64 = TAU / 60.0;
/// Two waypoints are at least this share of the area's side apart.
const NEAREST: f64 = 0.25;

/// What the drone is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mission {
    /// Hover above the start.
    Hover,
    /// Hover above the start, and turn to the right, once a minute.
    Turn,
    /// Loop over 8 random waypoints at up to 3 m/s.
    Waypoints,
}

impl Mission {
    /// As on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Hover => "hover",
            Self::Turn => "turn",
            Self::Waypoints => "waypoints",
        }
    }
}

/// Where the drone shall be at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// North, east, down, m.
    pub position: Vector3<f64>,
    /// How the target itself moves, m/s.
    pub velocity: Vector3<f64>,
    /// Heading, rad from north, clockwise.
    pub heading: f64,
}

/// A mission under way.
#[derive(Clone, Debug)]
pub struct Course {
    /// Empty for hovering.
    corners: Vec<Vector2<f64>>,
    turn_rad_s: f64,
    next: usize,
    speed: f64,
    target: Target,
}

impl Course {
    /// A mission before take-off at the origin, its waypoints within a square around that.
    #[must_use]
    pub fn new(mission: Mission, side_m: f64, seed: u64) -> Self {
        Self {
            corners: match mission {
                Mission::Hover | Mission::Turn => Vec::new(),
                Mission::Waypoints => waypoints(side_m, seed),
            },
            turn_rad_s: match mission {
                Mission::Turn => TURN_RAD_S,
                Mission::Hover | Mission::Waypoints => 0.0,
            },
            next: 0,
            speed: 0.0,
            target: Target {
                position: Vector3::zeros(),
                velocity: Vector3::zeros(),
                heading: 0.0,
            },
        }
    }

    /// Where the drone shall be now.
    #[must_use]
    pub fn target(&self) -> Target {
        self.target
    }

    /// Moves on by a time, with the drone at a place.
    pub fn advance(&mut self, dt_s: f64, drone: &Vector3<f64>) {
        let before = self.target.position;
        let behind = (before - drone).norm();
        let slack = (LEASH_M[1] - behind) / (LEASH_M[1] - LEASH_M[0]);
        let free = slack.clamp(0.0, 1.0);
        if before.z > -HEIGHT_M {
            self.target.position.z = (before.z - CLIMB_M_S * free * dt_s).max(-HEIGHT_M);
        } else {
            self.target.heading = wrapped(self.target.heading + self.turn_rad_s * dt_s);
            if !self.corners.is_empty() {
                self.travel(free, dt_s);
            }
        }
        if dt_s > 0.0 {
            self.target.velocity = (self.target.position - before) / dt_s;
        }
    }

    fn travel(&mut self, free: f64, dt_s: f64) {
        let corner = self.corners[self.next];
        let way = corner - self.target.position.xy();
        let left = way.norm();
        // As fast as still lets it stop at the corner.
        let brakes = (2.0 * ACCELERATION_M_S2 * left).sqrt();
        let allowed = (SPEED_M_S * free).min(brakes).max(0.1 * free);
        self.speed = (self.speed + ACCELERATION_M_S2 * dt_s).min(allowed);
        let step = (self.speed * dt_s).min(left);
        if left > 0.0 {
            let moved = way * (step / left);
            self.target.position += Vector3::new(moved.x, moved.y, 0.0);
        }
        if step >= left {
            self.next = (self.next + 1) % self.corners.len();
        }
    }
}

/// An angle within -pi to pi.
pub(super) fn wrapped(angle: f64) -> f64 {
    let turns = (angle / TAU).round();
    angle - turns * TAU
}

fn waypoints(side_m: f64, seed: u64) -> Vec<Vector2<f64>> {
    let mut random = generator(seed, 0);
    let mut coordinate = move || {
        let share: f64 = StandardUniform.sample(&mut random);
        (share - 0.5) * side_m
    };
    let mut corners: Vec<Vector2<f64>> = Vec::with_capacity(WAYPOINTS);
    while corners.len() < WAYPOINTS {
        let corner = Vector2::new(coordinate(), coordinate());
        let before = corners.last().copied().unwrap_or_default();
        if (corner - before).norm() >= NEAREST * side_m {
            corners.push(corner);
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Targets of a drone that is always there, every 10 ms.
    fn flown(mission: Mission, seed: u64, seconds: u64) -> Vec<Target> {
        let mut course = Course::new(mission, 40.0, seed);
        let step = |_| {
            let place = course.target().position;
            course.advance(0.01, &place);
            course.target()
        };
        (0..seconds * 100).map(step).collect()
    }

    #[test]
    fn hovering_climbs_and_stays() {
        let targets = flown(Mission::Hover, 1, 10);
        assert!((targets[99].position.z + 1.0).abs() < 1e-9);
        let last = targets.last().expect("ten seconds");
        assert_eq!(last.position, Vector3::new(0.0, 0.0, -HEIGHT_M));
        assert_eq!(last.velocity, Vector3::zeros());
    }

    #[test]
    fn the_same_seed_leads_round_the_same_waypoints() {
        let [first, again, other] = [1, 1, 2].map(|seed| flown(Mission::Waypoints, seed, 60));
        assert_eq!(first, again);
        assert_ne!(first, other);
    }

    #[test]
    fn the_point_waits_for_a_drone_that_falls_behind() {
        let mut course = Course::new(Mission::Waypoints, 40.0, 1);
        for _ in 0..100_000 {
            course.advance(0.01, &Vector3::zeros());
        }
        let ahead = course.target().position.norm();
        assert!((LEASH_M[0]..=LEASH_M[1] + 0.1).contains(&ahead), "{ahead}");
    }

    proptest! {
        #[test]
        fn waypoints_are_looped_within_the_area_and_its_speed(seed in 0u64..1000) {
            let targets = flown(Mission::Waypoints, seed, 300);
            let mut fastest = 0.0f64;
            for pair in targets.windows(2) {
                let step = pair[1].position - pair[0].position;
                prop_assert!(step.norm() <= SPEED_M_S * 0.01 + 1e-9);
                prop_assert!(pair[1].position.xy().amax() <= 20.0 + 1e-9);
                let gained = pair[1].velocity.norm() - pair[0].velocity.norm();
                prop_assert!(gained <= ACCELERATION_M_S2 * 0.01 + CLIMB_M_S + 1e-9);
                fastest = fastest.max(pair[1].velocity.norm());
            }
            prop_assert!(fastest > 2.0);
        }
    }
}

//! The ground: feet and hubs on damped springs, with friction that holds.
//!
//! Each point that is below the ground is pushed out by a spring and a damper that never pulls.
//! Sideways a spring to the spot where the point touched down holds it without creeping, up to
//! what friction allows; beyond, the spot is dragged along. Spots move between steps, not within.
//! The springs are soft enough for steps of 1 ms: at rest the drone sinks in by 3 mm.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::frame::{Frame, Wrench};
use crate::state::State;
use crate::vehicle::{MAX_MOTORS, STANDARD_GRAVITY};

/// Feet of a drone.
const FEET: usize = 4;
/// Points that may touch the ground: feet and hubs.
const POINTS: usize = FEET + MAX_MOTORS;
/// Frequency of bouncing on all four feet, rad/s.
const BOUNCE: f64 = 60.0;
/// Damping of bouncing, as a share of critical damping.
const DAMPING: f64 = 0.6;

/// Where each point holds on the ground, north and east in m; `None` in the air.
pub type Anchors = [Option<Vector2<f64>>; POINTS];

/// Where the drone is and how it moves.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Earth axes, m.
    pub position: Vector3<f64>,
    /// Earth axes, m/s.
    pub velocity: Vector3<f64>,
    /// Turns body vectors into earth vectors.
    pub to_earth: Matrix3<f64>,
    /// Body axes, rad/s.
    pub rates: Vector3<f64>,
}

impl Pose {
    fn of(state: &State) -> Self {
        Self {
            position: state.position,
            velocity: state.velocity,
            to_earth: *state.attitude.to_rotation_matrix().matrix(),
            rates: state.rates,
        }
    }

    /// Velocity of a point of the drone, earth axes, m/s.
    fn velocity_of(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.velocity + self.to_earth * self.rates.cross(point)
    }
}

/// The points that may touch, and how the ground answers.
#[derive(Clone, Debug)]
pub struct Ground {
    points: Vec<Vector3<f64>>,
    /// Of one point, N/m.
    stiffness: f64,
    /// Of one point, N per m/s.
    damping: f64,
    friction: f64,
    /// Farthest point from the centre of mass, m.
    reach: f64,
}

impl Ground {
    /// The ground under a vehicle.
    pub fn new(frame: &Frame) -> Self {
        let vehicle = &frame.vehicle;
        let (reach, height) = (vehicle.skids.reach, vehicle.skids.height);
        let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)];
        let feet = corners.map(|(x, y)| Vector3::new(x * reach, y * reach, height));
        let hubs = frame.rotors.iter().map(|rotor| rotor.at);
        let points: Vec<_> = feet.into_iter().chain(hubs).collect();
        let share = vehicle.mass / FEET as f64;
        Self {
            stiffness: share * BOUNCE * BOUNCE,
            damping: share * 2.0 * DAMPING * BOUNCE,
            friction: vehicle.skids.friction,
            reach: points.iter().map(Vector3::norm).fold(0.0, f64::max),
            points,
        }
    }

    /// Depth to which the feet sink in at rest, m.
    pub fn sag() -> f64 {
        STANDARD_GRAVITY / (BOUNCE * BOUNCE)
    }

    fn is_near(&self, position: &Vector3<f64>) -> bool {
        position.z + self.reach > 0.0
    }

    /// Push of a point out of the ground, N; none above it.
    fn normal(&self, depth: f64, sinking: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        (self.stiffness * depth + self.damping * sinking).max(0.0)
    }

    /// Force of friction, N, north and east.
    fn hold(&self, stretch: Vector2<f64>, sliding: Vector2<f64>, normal: f64) -> Vector2<f64> {
        let wanted = -(stretch * self.stiffness + sliding * self.damping);
        wanted.cap_magnitude(self.friction * normal)
    }

    /// Adds what the ground does.
    pub fn push(&self, pose: &Pose, anchors: &Anchors, wrench: &mut Wrench) {
        if !self.is_near(&pose.position) {
            return;
        }
        for (point, anchor) in self.points.iter().zip(anchors) {
            let place = pose.position + pose.to_earth * point;
            if place.z <= 0.0 {
                continue;
            }
            let velocity = pose.velocity_of(point);
            let normal = self.normal(place.z, velocity.z);
            let stretch = anchor.map_or(Vector2::zeros(), |held| place.xy() - held);
            let along = self.hold(stretch, velocity.xy(), normal);
            let force = Vector3::new(along.x, along.y, -normal);
            let force = pose.to_earth.tr_mul(&force);
            wrench.force += force;
            wrench.moment += point.cross(&force);
        }
    }

    /// Sets down, drags along and lifts the spots where points hold after a step.
    pub fn settle(&self, before: &State, after: &State, anchors: &mut Anchors) -> Touch {
        let mut touch = Touch::default();
        if !self.is_near(&after.position) {
            *anchors = Anchors::default();
            return touch;
        }
        let (before, pose) = (Pose::of(before), Pose::of(after));
        for (point, anchor) in self.points.iter().zip(anchors) {
            let place = pose.position + pose.to_earth * point;
            if place.z <= 0.0 {
                *anchor = None;
                continue;
            }
            touch.any = true;
            let Some(held) = anchor else {
                *anchor = Some(place.xy());
                // The ground has braked it since.
                let velocity = before.velocity_of(point);
                touch.impact = touch.impact.max(velocity.norm());
                continue;
            };
            let velocity = pose.velocity_of(point);
            let most = self.friction * self.normal(place.z, velocity.z) / self.stiffness;
            let stretch = place.xy() - *held;
            *held = place.xy() - stretch.cap_magnitude(most);
        }
        touch
    }
}

/// How the drone touches the ground.
#[derive(Clone, Copy, Debug, Default)]
pub struct Touch {
    /// Some point is on the ground.
    pub any: bool,
    /// Largest speed of a point that has just touched down, m/s.
    pub impact: f64,
}

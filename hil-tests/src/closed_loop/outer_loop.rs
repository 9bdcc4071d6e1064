//! Position control from the ground, for control logics without loops of their own.
//!
//! A companion computer's part: from the place of the drone to an attitude and a thrust, which
//! the link carries as SET_ATTITUDE_TARGET. Proportional on place and velocity, an integral
//! against wind, and one that finds the thrust of hovering.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::mission::Target;
use chip_models::stimulus::STANDARD_GRAVITY;

/// Acceleration per m of distance, 1/s2.
const PLACE: f64 = 1.2;
/// Acceleration per m/s of velocity, 1/s.
const VELOCITY: f64 = 1.8;
/// Acceleration gathered per m and s, 1/s3.
const WIND: f64 = 0.3;
/// The most that is gathered, m/s2.
const MOST_WIND: f64 = 3.0;
/// The most that is asked for along each axis, m/s2.
const MOST: f64 = 4.0;
/// Thrust of hovering before it is found, as a share.
const HOVER: f64 = 0.45;
/// Shares between which thrust is asked for.
const THRUST: [f64; 2] = [0.1, 0.9];

/// An attitude and a thrust to fly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Demand {
    pub(super) attitude: UnitQuaternion<f64>,
    /// Share of full thrust.
    pub(super) thrust: f64,
}

impl Demand {
    /// On the ground: level, no thrust.
    pub(super) const NONE: Self = Self {
        attitude: UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.0, 0.0, 0.0, 0.0)),
        thrust: 0.0,
    };
}

/// What it has gathered, in m/s2.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OuterLoop {
    gathered: Vector3<f64>,
}

impl OuterLoop {
    /// What to fly for a target, seen from a place with a velocity, after a time.
    pub(super) fn steer(
        &mut self,
        target: &Target,
        (position, velocity): (&Vector3<f64>, &Vector3<f64>),
        dt_s: f64,
    ) -> Demand {
        let miss = target.position - position;
        self.gathered += miss * (WIND * dt_s);
        self.gathered = self.gathered.map(|axis| axis.clamp(-MOST_WIND, MOST_WIND));
        let asked = miss * PLACE + (target.velocity - velocity) * VELOCITY + self.gathered;
        let asked = asked.map(|axis| axis.clamp(-MOST, MOST));
        // Thrust points upwards against gravity, which is downwards in these axes.
        let lift = asked - Vector3::new(0.0, 0.0, STANDARD_GRAVITY);
        let thrust = HOVER * lift.norm() / STANDARD_GRAVITY;
        Demand {
            attitude: attitude(-lift, target.heading),
            thrust: thrust.clamp(THRUST[0], THRUST[1]),
        }
    }
}

/// The attitude whose down axis lies along a vector, with a heading.
fn attitude(down: Vector3<f64>, heading: f64) -> UnitQuaternion<f64> {
    let down = down.normalize();
    let ahead = Vector3::new(heading.cos(), heading.sin(), 0.0);
    let right = down.cross(&ahead).normalize();
    let forward = right.cross(&down);
    let axes = Matrix3::from_columns(&[forward, right, down]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn demand(north: f64, heading: f64) -> Demand {
        let target = Target {
            position: Vector3::new(north, 0.0, -5.0),
            velocity: Vector3::zeros(),
            heading,
        };
        let here = Vector3::new(0.0, 0.0, -5.0);
        OuterLoop::default().steer(&target, (&here, &Vector3::zeros()), 0.0)
    }

    #[test]
    fn at_its_target_the_drone_is_level_and_turned_to_its_heading() {
        let at_rest = demand(0.0, 1.0);
        let (roll, pitch, yaw) = at_rest.attitude.euler_angles();
        assert!(roll.abs() < 1e-9 && pitch.abs() < 1e-9 && (yaw - 1.0).abs() < 1e-9);
        assert!((at_rest.thrust - HOVER).abs() < 1e-9);
    }

    #[test]
    fn a_target_ahead_lowers_the_nose() {
        let (_, pitch, _) = demand(1.0, 0.0).attitude.euler_angles();
        assert!(
            (pitch + (PLACE / STANDARD_GRAVITY).atan()).abs() < 1e-9,
            "{pitch}"
        );
        let (roll, _, _) = demand(1.0, std::f64::consts::FRAC_PI_2)
            .attitude
            .euler_angles();
        assert!(roll < -0.1, "facing east, north is to the left: {roll}");
    }
}

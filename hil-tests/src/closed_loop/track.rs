//! A flight over time, to look at.

use nalgebra::Vector3;

/// Time between two moments that are kept, ns.
pub(super) const KEPT_NS: u64 = 100_000_000;

/// The drone at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// s from take-off.
    pub at_s: f64,
    /// Where it was, north, east, down, m.
    pub position: Vector3<f64>,
    /// Where it should have been.
    pub target: Vector3<f64>,
    /// Roll, pitch and yaw, degrees.
    pub angles_deg: [f64; 3],
    /// Desired less actual angles, degrees; none where not asked for.
    pub off_deg: [Option<f64>; 3],
    /// Speed of the air over the ground, m/s.
    pub wind_m_s: f64,
}

//! Unit quaternions as a log holds them: w, x, y, z.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::track::Track;

/// A unit quaternion from w, x, y, z.
pub(super) fn from_array([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// The components w, x, y, z.
pub(super) fn to_array(q: UnitQuaternion<f64>) -> [f64; 4] {
    [q.w, q.i, q.j, q.k]
}

/// A turn about the vertical.
pub(super) fn about_down(angle: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
}

/// The heading of an attitude, rad; without meaning where the nose is vertical.
pub(super) fn heading(q: UnitQuaternion<f64>) -> f64 {
    let nose = q * Vector3::x();
    nose.y.atan2(nose.x)
}

/// The same attitudes with signs chosen so that neighbours are close.
pub(super) fn continuous(track: &Track<4>) -> Track<4> {
    let mut last: Option<[f64; 4]> = None;
    track.map(|q| {
        let dot = last.map_or(1.0, |l| l.iter().zip(q).map(|(a, b)| a * b).sum());
        let near = if dot < 0.0 { q.map(|c| -c) } else { q };
        last = Some(near);
        near
    })
}

/// Components scaled to a unit quaternion; the last one where there are none.
pub(super) fn renormalised(track: &Track<4>) -> Track<4> {
    let mut last = [1.0, 0.0, 0.0, 0.0];
    track.map(|q| {
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if norm > 1e-6 {
            last = q.map(|c| c / norm);
        }
        last
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quaternion_signs_are_made_continuous() {
        let mut track = Track::new();
        track.push(0, [1.0, 0.0, 0.0, 0.0]);
        track.push(1, [-0.9, -0.1, 0.0, 0.0]);
        assert_eq!(continuous(&track).at(1), Some([0.9, 0.1, 0.0, 0.0]));
    }
}

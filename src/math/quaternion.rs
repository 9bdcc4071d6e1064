//! Attitude as a unit quaternion, body (FRD) to Earth (NED).

use super::{Vec3, atan2, sin_cos, sqrt};

/// A rotation from body axes to Earth axes, of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Quaternion {
    /// Real part.
    pub w: f32,
    /// Imaginary part.
    pub v: Vec3,
}

impl Default for Quaternion {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Quaternion {
    /// Level, heading north.
    pub const IDENTITY: Self = Self {
        w: 1.0,
        v: Vec3::ZERO,
    };

    /// From `[w, x, y, z]`, scaled to unit length; `None` where that cannot be done.
    ///
    /// Zero, infinite and not-a-number components are refused, and so is a length further
    /// than 10 % from one: such an attitude was not meant as a rotation.
    #[must_use]
    pub fn from_array([w, x, y, z]: [f32; 4]) -> Option<Self> {
        let v = Vec3::new(x, y, z);
        let length = sqrt(w * w + v.dot(v));
        (0.9..=1.1).contains(&length).then(|| Self {
            w: w / length,
            v: v * (1.0 / length),
        })
    }

    /// The components as `[w, x, y, z]`.
    #[must_use]
    pub const fn to_array(self) -> [f32; 4] {
        [self.w, self.v.x, self.v.y, self.v.z]
    }

    /// The rotation by `angle` rad about the vertical, clockwise seen from above.
    #[must_use]
    pub fn from_heading(angle: f32) -> Self {
        let (sin, cos) = sin_cos(0.5 * angle);
        Self {
            w: cos,
            v: Vec3::new(0.0, 0.0, sin),
        }
    }

    /// The attitude of least rotation that brings measured `up` (body axes) to vertical.
    ///
    /// `up` is the specific force at rest, which points up, of any length but zero.
    #[must_use]
    pub fn from_up(up: Vec3) -> Option<Self> {
        let length = up.norm();
        if !(length > 1e-3 && length.is_finite()) {
            return None;
        }
        let up = up * (1.0 / length);
        // The shortest arc from `up` to Earth's up (0, 0, -1); upside down, turn about roll.
        let real = 1.0 - up.z;
        if real < 1e-6 {
            return Some(Self {
                w: 0.0,
                v: Vec3::new(1.0, 0.0, 0.0),
            });
        }
        let axis = up.cross(Vec3::new(0.0, 0.0, -1.0));
        let scale = 1.0 / sqrt(real * real + axis.dot(axis));
        Some(Self {
            w: real * scale,
            v: axis * scale,
        })
    }

    /// The same heading with the vertical that measured `up` shows; see [`Self::from_up`].
    #[must_use]
    pub fn levelled(self, up: Vec3) -> Option<Self> {
        let tilted = Self::from_up(up)?;
        let missing = self.heading() - tilted.heading();
        Some(Self::from_heading(missing).then_body(tilted))
    }

    /// True where no component is infinite or not a number.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.w.is_finite() && self.v.is_finite()
    }

    /// The inverse rotation.
    #[must_use]
    pub fn conjugate(self) -> Self {
        Self {
            w: self.w,
            v: -self.v,
        }
    }

    /// This rotation after `other`: `(a.then_body(b))` turns by `b` in the body's own axes.
    #[must_use]
    pub fn then_body(self, other: Self) -> Self {
        Self {
            w: self.w * other.w - self.v.dot(other.v),
            v: other.v * self.w + self.v * other.w + self.v.cross(other.v),
        }
    }

    /// Turned by a small angle vector in body axes (rad), with the length pulled back to one.
    ///
    /// Third-order in the angle; exact to 1e-6 up to 0.3 rad. One Newton step of the inverse
    /// square root replaces a root and a division.
    #[must_use]
    pub fn turned_by(self, angle: Vec3) -> Self {
        let half = angle * 0.5;
        let square = half.dot(half);
        let turn = Self {
            w: 1.0 - square * (0.5 - square * (1.0 / 24.0)),
            v: half * (1.0 - square * (1.0 / 6.0)),
        };
        self.then_body(turn).renormalised()
    }

    fn renormalised(self) -> Self {
        let square = self.w * self.w + self.v.dot(self.v);
        let scale = 0.5 * (3.0 - square);
        Self {
            w: self.w * scale,
            v: self.v * scale,
        }
    }

    /// A vector of Earth axes seen in body axes.
    #[must_use]
    pub fn to_body(self, earth: Vec3) -> Vec3 {
        self.conjugate().to_earth(earth)
    }

    /// A vector of body axes seen in Earth axes.
    #[must_use]
    pub fn to_earth(self, body: Vec3) -> Vec3 {
        let twice = self.v.cross(body) * 2.0;
        body + twice * self.w + self.v.cross(twice)
    }

    /// Earth's down axis seen in body axes: the third row of the rotation matrix.
    #[must_use]
    pub fn down_in_body(self) -> Vec3 {
        let Vec3 { x, y, z } = self.v;
        Vec3::new(
            2.0 * (x * z - self.w * y),
            2.0 * (y * z + self.w * x),
            1.0 - 2.0 * (x * x + y * y),
        )
    }

    /// Heading in rad, -pi to pi.
    #[must_use]
    pub fn heading(self) -> f32 {
        let Vec3 { x, y, z } = self.v;
        atan2(2.0 * (self.w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    }

    /// The rotation vector (rad, body axes) that takes this attitude to `target`.
    ///
    /// Along the shorter way round; twice the sine of the half angle, exact to 4 % at 1 rad.
    #[must_use]
    pub fn error_to(self, target: Self) -> Vec3 {
        let error = self.conjugate().then_body(target);
        error.v * if error.w < 0.0 { -2.0 } else { 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(a: Vec3, b: Vec3, within: f32) -> bool {
        (a - b).max_norm() < within
    }

    #[test]
    fn from_up_makes_the_measured_up_vertical() {
        for up in [
            Vec3::new(0.0, 0.0, -9.8),
            Vec3::new(3.0, -2.0, -8.0),
            Vec3::new(0.0, 0.0, 9.8),
            Vec3::new(9.8, 0.0, 0.0),
        ] {
            let attitude = Quaternion::from_up(up).expect("not zero");
            let vertical = attitude.to_earth(up * (1.0 / up.norm()));
            assert!(close(vertical, Vec3::new(0.0, 0.0, -1.0), 1e-5), "{up:?}");
        }
        assert_eq!(Quaternion::from_up(Vec3::ZERO), None);
    }

    #[test]
    fn an_attitude_that_is_no_rotation_is_refused() {
        assert_eq!(Quaternion::from_array([0.0; 4]), None);
        assert_eq!(Quaternion::from_array([f32::NAN, 0.0, 0.0, 0.0]), None);
        assert_eq!(Quaternion::from_array([2.0, 0.0, 0.0, 0.0]), None);
    }

    proptest! {
        #[test]
        fn many_small_turns_keep_unit_length(
            x in -0.2f32..0.2, y in -0.2f32..0.2, z in -0.2f32..0.2
        ) {
            let mut attitude = Quaternion::IDENTITY;
            for _ in 0..1000 {
                attitude = attitude.turned_by(Vec3::new(x, y, z));
            }
            let [w, i, j, k] = attitude.to_array();
            prop_assert!((w * w + i * i + j * j + k * k - 1.0).abs() < 1e-4);
        }

        #[test]
        fn turning_by_the_error_reaches_the_target(
            x in -0.3f32..0.3, y in -0.3f32..0.3, z in -0.3f32..0.3, heading in -3.0f32..3.0
        ) {
            let from = Quaternion::from_heading(heading);
            let target = from.turned_by(Vec3::new(x, y, z));
            let reached = from.turned_by(from.error_to(target));
            prop_assert!(reached.error_to(target).max_norm() < 0.02);
        }

        #[test]
        fn body_and_earth_axes_are_inverse(
            x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0, heading in -3.0f32..3.0
        ) {
            let attitude = Quaternion::from_heading(heading).turned_by(Vec3::new(x, y, z) * 0.3);
            let vector = Vec3::new(z, x, y);
            prop_assert!(close(attitude.to_body(attitude.to_earth(vector)), vector, 1e-4));
            prop_assert!(close(attitude.down_in_body(), attitude.to_body(Vec3::new(0.0, 0.0, 1.0)), 1e-4));
        }
    }
}

//! Three axes and their arithmetic.

use super::max;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};

/// Three components; the type around it says of what, and in which frame.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Vec3 {
    /// Forward, or north.
    pub x: f32,
    /// Right, or east.
    pub y: f32,
    /// Down.
    pub z: f32,
}

/// Vectors that follow a motion are seldom the same: the first axis settles most.
impl PartialEq for Vec3 {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        if self.x != other.x {
            return false;
        }
        core::hint::cold_path();
        self.y == other.y && self.z == other.z
    }
}

impl Vec3 {
    /// All components zero.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);

    /// A vector of three components.
    #[must_use]
    pub const fn new(x: f32, y: f32, z: f32) -> Self {
        Self { x, y, z }
    }

    /// A vector of its components, in order.
    #[must_use]
    pub const fn from_array([x, y, z]: [f32; 3]) -> Self {
        Self { x, y, z }
    }

    /// The components, in order.
    #[must_use]
    pub const fn to_array(self) -> [f32; 3] {
        [self.x, self.y, self.z]
    }

    /// The scalar product.
    #[must_use]
    pub fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The vector product.
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Componentwise product.
    #[must_use]
    pub fn scale(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    /// The Euclidean length.
    #[must_use]
    pub fn norm(self) -> f32 {
        super::sqrt(self.dot(self))
    }

    /// The largest absolute component, as the chips compare: any axis past the threshold.
    #[must_use]
    pub fn max_norm(self) -> f32 {
        max(max(self.x.abs(), self.y.abs()), self.z.abs())
    }

    /// Each component limited to plus or minus the same component of `limit`.
    #[must_use]
    pub fn limited(self, limit: Self) -> Self {
        Self::new(
            super::limited(self.x, limit.x),
            super::limited(self.y, limit.y),
            super::limited(self.z, limit.z),
        )
    }

    /// True where no component is infinite or not a number.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl AddAssign for Vec3 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f32> for Vec3 {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

//! Vectors, quaternions and the few functions of flight arithmetic, in `f32`.
//!
//! Every operation is a plain IEEE multiplication, addition or division in a written order, so
//! that the emulated core and the host give the same bits. Trigonometry is by polynomials:
//! `libm::sinf` passes through `f64`, which the Cortex-M4F does in software.

mod mean;
mod quaternion;
mod trigonometry;
mod vector;

pub use mean::RunningMean;
pub use quaternion::Quaternion;
pub use trigonometry::{atan2, sin_cos, wrapped};
pub use vector::Vec3;

/// Square root; of a negative number, not a number.
///
/// The one place that names an implementation: `libm`'s is correctly rounded, hence the same
/// bits as the core's `vsqrt`.
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// `x` within `-limit..=limit`, for `limit` of zero or more.
///
/// Unlike `f32::clamp`, which panics where its bounds are in disorder, and brings the text of
/// that panic with it: 17 KiB of flash.
#[must_use]
pub fn limited(x: f32, limit: f32) -> f32 {
    between(x, -limit, limit)
}

/// `x` within `low..=high`, for `low` of at most `high`; see [`limited`].
#[must_use]
pub fn between(x: f32, low: f32, high: f32) -> f32 {
    min(max(x, low), high)
}

/// The larger of two; `b` where `a` is not a number.
///
/// One comparison, unlike `f32::max`, which is a call of 17 instructions on the target.
#[must_use]
#[inline]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two; `b` where `a` is not a number. See [`max`].
#[must_use]
#[inline]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Each number by this share of the way to another.
#[must_use]
#[inline]
pub fn towards<const N: usize>(mut from: [f32; N], to: [f32; N], share: f32) -> [f32; N] {
    for (from, to) in from.iter_mut().zip(to) {
        *from += (to - *from) * share;
    }
    from
}

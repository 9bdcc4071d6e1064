//! Sine, cosine and arc tangent as `f32` polynomials.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Sine and cosine of an angle in rad, within 1e-6 for angles up to 100 rad.
///
/// Reduced to an eighth of a turn, then the Taylor polynomials of degree 7 and 8.
#[must_use]
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let quarter = libm::floorf(angle * (1.0 / FRAC_PI_2) + 0.5);
    // Two-part pi/2 keeps the reduced angle exact.
    let reduced = (angle - quarter * 1.570_312_5) - quarter * 4.838_268e-4;
    let square = reduced * reduced;
    let sin =
        reduced * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0))));
    let cos = 1.0
        - square
            * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square * (1.0 / 40320.0))));
    match (quarter as i32) & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The angle of the point `(x, y)` in rad, -pi to pi, within 1e-5; zero at the origin.
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let larger = ax.max(ay);
    if larger == 0.0 {
        return 0.0;
    }
    let ratio = ax.min(ay) / larger;
    let first = if ay > ax {
        FRAC_PI_2 - atan_unit(ratio)
    } else {
        atan_unit(ratio)
    };
    let upper = if x < 0.0 { PI - first } else { first };
    if y < 0.0 { -upper } else { upper }
}

/// Arc tangent for 0 to 1, by the half-angle step `tan(pi/8)` and a series of degree 9.
fn atan_unit(ratio: f32) -> f32 {
    const TAN_EIGHTH: f32 = 0.414_213_57;
    let (offset, z) = if ratio > TAN_EIGHTH {
        (FRAC_PI_4, (ratio - 1.0) / (ratio + 1.0))
    } else {
        (0.0, ratio)
    };
    let square = z * z;
    let series =
        1.0 - square * (1.0 / 3.0 - square * (0.2 - square * (1.0 / 7.0 - square * (1.0 / 9.0))));
    offset + z * series
}

/// An angle in rad brought within -pi to pi.
#[must_use]
pub fn wrapped(angle: f32) -> f32 {
    angle - 2.0 * PI * libm::floorf((angle + PI) / (2.0 * PI))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sine_and_cosine_agree_with_the_library(angle in -100.0f32..100.0) {
            let (sin, cos) = sin_cos(angle);
            prop_assert!((f64::from(sin) - f64::from(angle).sin()).abs() < 2e-6);
            prop_assert!((f64::from(cos) - f64::from(angle).cos()).abs() < 2e-6);
        }

        #[test]
        fn arc_tangent_agrees_with_the_library(x in -10.0f32..10.0, y in -10.0f32..10.0) {
            prop_assert!((f64::from(atan2(y, x)) - f64::from(y).atan2(f64::from(x))).abs() < 2e-5);
        }
    }
}

//! How the log's axes lie in the board's body frame (forward, right, down).
//!
//! Names follow MAVLink's `MAV_SENSOR_ROTATION`: roll, then pitch, then yaw,
//! each a multiple of 45 degrees, turned in that order about the body's fixed
//! axes (`R = Rz(yaw) Ry(pitch) Rx(roll)`, `body = R log`).

use std::fmt;
use std::str::FromStr;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// A rotation by multiples of 45 degrees; the default turns nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rotation {
    /// Roll, pitch and yaw in steps of 45 degrees, 0 to 7.
    steps: [u8; 3],
}

const AXES: [&str; 3] = ["roll", "pitch", "yaw"];
const STEP_DEGREES: u16 = 45;

impl Rotation {
    /// The log's axes are the body's.
    pub const NONE: Self = Self { steps: [0, 0, 0] };
    /// From forward-left-up to forward-right-down.
    pub const ROLL_180: Self = Self { steps: [4, 0, 0] };
    /// From up-right-forward to forward-right-down.
    pub const PITCH_90: Self = Self { steps: [0, 2, 0] };

    /// The matrix that takes a vector from the log's axes to the body's.
    #[must_use]
    pub fn matrix(self) -> Matrix3<f64> {
        let [(sr, cr), (sp, cp), (sy, cy)] = self.steps.map(sine_cosine);
        let roll = Matrix3::new(1.0, 0.0, 0.0, 0.0, cr, -sr, 0.0, sr, cr);
        let pitch = Matrix3::new(cp, 0.0, sp, 0.0, 1.0, 0.0, -sp, 0.0, cp);
        let yaw = Matrix3::new(cy, -sy, 0.0, sy, cy, 0.0, 0.0, 0.0, 1.0);
        yaw * pitch * roll
    }

    /// A vector of the log in the body's axes.
    #[must_use]
    pub fn vector(self, v: [f64; 3]) -> [f64; 3] {
        if self == Self::NONE {
            return v;
        }
        (self.matrix() * Vector3::from(v)).into()
    }

    /// The same turn as a quaternion.
    #[must_use]
    pub fn quaternion(self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_matrix(&self.matrix())
    }
}

/// Sine and cosine, exact for right angles.
fn sine_cosine(step: u8) -> (f64, f64) {
    const H: f64 = std::f64::consts::FRAC_1_SQRT_2;
    match step % 8 {
        0 => (0.0, 1.0),
        1 => (H, H),
        2 => (1.0, 0.0),
        3 => (H, -H),
        4 => (0.0, -1.0),
        5 => (-H, -H),
        6 => (-1.0, 0.0),
        _ => (-H, H),
    }
}

impl fmt::Display for Rotation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NONE {
            return f.write_str("none");
        }
        for (name, &step) in AXES.iter().zip(&self.steps) {
            if step != 0 {
                write!(f, "{name}{}", u16::from(step) * STEP_DEGREES)?;
            }
        }
        Ok(())
    }
}

/// A rotation that cannot be read; says what can.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RotationError(String);

impl fmt::Display for RotationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "unknown rotation {}: use auto, none, or roll, pitch, yaw in this order, each a \
             multiple of 45 below 360, as in roll180 or roll180yaw90",
            super::error::quoted(&self.0)
        )
    }
}

impl std::error::Error for RotationError {}

impl FromStr for Rotation {
    type Err = RotationError;

    /// Reads `none`, `roll180`, `yaw90`, `ROLL_180_YAW_90` and the like.
    fn from_str(text: &str) -> Result<Self, RotationError> {
        let error = || RotationError(text.to_owned());
        let name = text.to_ascii_lowercase().replace(['_', '-'], "");
        if name == "none" {
            return Ok(Self::NONE);
        }
        let mut steps = [0; 3];
        let mut rest = name.as_str();
        for (axis, step) in AXES.iter().zip(&mut steps) {
            if let Some(after) = rest.strip_prefix(axis) {
                let digits = after
                    .find(|c: char| !c.is_ascii_digit())
                    .unwrap_or(after.len());
                *step = steps_of(&after[..digits]).ok_or_else(error)?;
                rest = &after[digits..];
            }
        }
        if !rest.is_empty() || name.is_empty() {
            return Err(error());
        }
        Ok(Self { steps })
    }
}

/// Steps of 45 degrees in a number of degrees.
fn steps_of(degrees: &str) -> Option<u8> {
    let degrees: u16 = degrees.parse().ok()?;
    let whole = degrees.is_multiple_of(STEP_DEGREES) && degrees < 360;
    whole.then(|| u8::try_from(degrees / STEP_DEGREES).ok())?
}

/// The rotation a user asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rotate {
    /// That of the format; for CSV `roll180` where the flight shows that the log's
    /// z axis points up.
    #[default]
    Auto,
    /// This one, without a look at the log.
    Named(Rotation),
}

impl FromStr for Rotate {
    type Err = RotationError;

    fn from_str(text: &str) -> Result<Self, RotationError> {
        if text.eq_ignore_ascii_case("auto") {
            return Ok(Self::Auto);
        }
        text.parse().map(Self::Named)
    }
}

impl fmt::Display for Rotate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Named(rotation) => rotation.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(name: &str, v: [f64; 3]) -> [f64; 3] {
        name.parse::<Rotation>().expect(name).vector(v)
    }

    #[test]
    fn named_rotations_move_the_axes_as_mavlink_says() {
        assert_eq!(turned("none", [1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert_eq!(turned("roll180", [1.0, 2.0, 3.0]), [1.0, -2.0, -3.0]);
        assert_eq!(turned("yaw90", [1.0, 2.0, 3.0]), [-2.0, 1.0, 3.0]);
        assert_eq!(turned("pitch90", [1.0, 2.0, 3.0]), [3.0, 2.0, -1.0]);
        assert_eq!(turned("roll180yaw90", [1.0, 2.0, 3.0]), [2.0, 1.0, -3.0]);
        assert_eq!(turned("ROLL_180_YAW_90", [1.0, 2.0, 3.0]), [2.0, 1.0, -3.0]);
    }

    #[test]
    fn every_name_reads_back_as_itself() {
        for code in 0..512_u16 {
            let steps = [code % 8, code / 8 % 8, code / 64].map(|s| s as u8);
            let rotation = Rotation { steps };
            assert_eq!(rotation.to_string().parse(), Ok(rotation));
            assert!((rotation.matrix().determinant() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn senseless_names_are_refused() {
        for name in [
            "",
            "left",
            "roll",
            "roll30",
            "roll360",
            "yaw90roll180",
            "roll90roll90",
        ] {
            let error = name.parse::<Rotate>().expect_err(name).to_string();
            assert!(error.contains("roll180yaw90"), "{error}");
        }
    }

    #[test]
    fn the_quaternion_is_the_same_turn() {
        let rotation: Rotation = "roll90pitch45yaw270".parse().expect("a known name");
        let by_quaternion = rotation.quaternion() * Vector3::new(1.0, 2.0, 3.0);
        let by_matrix = rotation.matrix() * Vector3::new(1.0, 2.0, 3.0);
        assert!((by_quaternion - by_matrix).norm() < 1e-12);
    }
}

//! `airframes/*.toml`: where the motors are and how they turn.

use serde::Deserialize;

use crate::allocation::{self, Allocation};
use crate::document::Document;
use crate::{ConfigError, range};

/// The content of a file of `airframes/`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Airframe {
    /// Least command of an armed motor as a share of full scale, 0 to 0.3.
    #[serde(deserialize_with = "range::armed_minimum")]
    pub armed_minimum: f64,
    /// Four to eight motors in the order of the outputs.
    pub motors: Vec<Motor>,
}

/// One motor.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Direction of its arm in degrees from forward, clockwise seen from above.
    #[serde(deserialize_with = "range::direction")]
    pub angle_deg: f64,
    /// The way its propeller turns.
    pub spin: Spin,
}

/// The way a propeller turns, seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Spin {
    /// Clockwise.
    Cw,
    /// Counter-clockwise.
    Ccw,
}

impl Airframe {
    /// What only several values together can show.
    pub(crate) fn check(&self, document: &Document) -> Result<(), ConfigError> {
        let count = self.motors.len();
        if !(4..=8).contains(&count) {
            let message = format!("{count} motors are out of range, must be 4 to 8");
            return Err(document.error_at("motors", message));
        }
        let clockwise = self
            .motors
            .iter()
            .filter(|motor| motor.spin == Spin::Cw)
            .count();
        if clockwise * 2 != count {
            let message = format!("{clockwise} of {count} spin cw, must be half of them");
            return Err(document.error_at("motors", message));
        }
        allocation::check(&self.motors).map_err(|message| document.error_at("motors", message))
    }

    /// What each motor must do for a torque, of an airframe that was read from a file.
    #[must_use]
    pub fn allocation(&self) -> Allocation {
        Allocation::of(&self.motors)
    }
}

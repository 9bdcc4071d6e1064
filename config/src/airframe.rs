//! `airframes/*.toml`: where the motors are and how they turn.

use reflex_settings::{Airframe as Geometry, AirframeError, MOST_MOTORS};
use serde::Deserialize;

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
        if self.motors.len() > MOST_MOTORS {
            let count = AirframeError::Count(self.motors.len());
            return Err(document.error_at("motors", count.to_string()));
        }
        let checked = self.geometry().check();
        checked.map_err(|refused| document.error_at("motors", refused.to_string()))
    }

    /// What the firmware takes, of an airframe that was read from a file.
    #[must_use]
    pub fn geometry(&self) -> Geometry {
        let motors: Vec<_> = self.motors.iter().map(Motor::placed).collect();
        Geometry::new(self.armed_minimum as f32, &motors)
    }
}

impl Motor {
    fn placed(&self) -> reflex_settings::Motor {
        reflex_settings::Motor {
            angle_deg: self.angle_deg as f32,
            clockwise: self.spin == Spin::Cw,
        }
    }
}

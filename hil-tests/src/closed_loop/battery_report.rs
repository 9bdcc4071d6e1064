//! What a simulated flight left of its battery.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The battery at the end, and what the firmware made of it on the way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BatteryReport {
    /// Share of its charge that is left.
    pub charge: f64,
    /// At its terminals, V.
    pub volts: f64,
    /// As the firmware has it: `unmeasured`, `good`, `low` or `critical` (nearly empty).
    pub state: String,
    /// When the firmware first found it low, s from take-off; null where it did not.
    pub low_s: Option<f64>,
    /// When it first found it nearly empty: from there on the flight is not scored.
    pub critical_s: Option<f64>,
    /// When it was empty, whatever the firmware knew.
    pub empty_s: Option<f64>,
    /// When the drone stood on the ground for it, and the flight ended before its time.
    pub ended_s: Option<f64>,
}

impl fmt::Display for BatteryReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = 100.0 * self.charge;
        write!(f, "{left:.1} % left, {:.1} V, {}", self.volts, self.state)?;
        for (word, at_s) in [
            ("low", self.low_s),
            ("nearly empty", self.critical_s),
            ("empty", self.empty_s),
        ] {
            if let Some(at_s) = at_s {
                write!(f, "; {word} from {at_s:.1} s")?;
            }
        }
        match self.ended_s {
            None => Ok(()),
            Some(at_s) => write!(f, "; on the ground at {at_s:.1} s, the flight ends there"),
        }
    }
}

//! What came of the faults of a flight.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What came of the faults of a script.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FaultReport {
    /// When the firmware first counted a fault, or entered a state or a phase, that the flight had not shown before, ms
    /// behind the first fault of the script; null where it noticed nothing.
    pub detected_ms: Option<f64>,
    /// What that was.
    pub detected_by: Option<String>,
    /// The flight states from the first fault on, in their order.
    pub states: Vec<String>,
    /// When the firmware stopped the motors, ms behind the first fault; null where they turned to the end.
    pub stopped_ms: Option<f64>,
    /// When all that it noticed was over for good: the state and phase of before, and no more faults of kinds that the
    /// flight had not shown; ms behind the first fault, null where it noticed nothing or that was not so.
    pub recovered_ms: Option<f64>,
    /// Largest tilt from level between the first fault and the end, or the cut of the motors, degrees.
    pub largest_tilt_deg: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// Motor commands with a share that is no number from 0 to 1.
    pub bad_commands: u64,
    /// Longest time between two runs of control while armed, ms.
    pub longest_gap_ms: f64,
    /// Longest time that a task kept a bus, ms; null on the emulated board, where gaps show it.
    pub longest_transfer_ms: Option<f64>,
}

/// How a flight with a fault ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It flies on, to the end of the simulation.
    Flies,
    /// The firmware disarmed on the ground, unharmed.
    Landed,
    /// The firmware cut the motors in the air.
    Cut,
    /// It hit the ground or turned over, with motors that turned.
    Crashed,
}

impl Outcome {
    /// Every one.
    pub const ALL: [Self; 4] = [Self::Flies, Self::Landed, Self::Cut, Self::Crashed];

    /// As in tables and files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Flies => "flies",
            Self::Landed => "landed",
            Self::Cut => "cut",
            Self::Crashed => "crashed",
        }
    }
}

impl fmt::Display for FaultReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.detected_ms, &self.detected_by) {
            (Some(ms), Some(by)) => write!(f, "detected by {by} after {ms:.1} ms")?,
            _ => write!(f, "not detected")?,
        }
        write!(
            f,
            ", {}, {}; tilt up to {:.0} degrees, {} bad commands, runs at most {:.0} ms apart",
            self.states.join(", "),
            self.outcome.word(),
            self.largest_tilt_deg,
            self.bad_commands,
            self.longest_gap_ms
        )
    }
}

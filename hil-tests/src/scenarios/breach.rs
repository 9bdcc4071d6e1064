//! What no fault may ever lead to, whatever a script says.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::closed_loop::{FaultReport, Outcome};

/// Longest time between two runs while armed, ms: a failsafe period, a hyperperiod, and the time of a task.
const LONGEST_GAP_MS: f64 = 102.0;
/// Longest time that a task may keep a bus, ms: that of configuring the inertial sensor anew.
const LONGEST_TRANSFER_MS: f64 = 5.0;
/// Largest tilt, in degrees, at which a fault that nobody told of has done no harm.
const HARMLESS_TILT_DEG: f64 = 30.0;

/// A promise that a flight broke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Breach {
    /// Commands that are no numbers from 0 to 1.
    BadCommands(u64),
    /// No run of control for so long while armed, ms.
    Gap(f64),
    /// A task kept a bus for so long, ms.
    Wait(f64),
    /// The drone was harmed, and the firmware had told nothing: its largest tilt, degrees.
    Unreported(f64),
}

impl Breach {
    /// Every promise that a flight broke.
    pub(super) fn any(came: &FaultReport) -> impl Iterator<Item = Self> {
        let is_harmed = came.detected_ms.is_none() && !Self::is_harmless(came);
        let unreported = is_harmed.then_some(Self::Unreported(came.largest_tilt_deg));
        Self::of_control(came).chain(unreported)
    }

    /// Those of commands and times alone, whatever became of the drone.
    pub(super) fn of_control(came: &FaultReport) -> impl Iterator<Item = Self> + use<> {
        let (bad, gap_ms) = (came.bad_commands, came.longest_gap_ms);
        let wait = came
            .longest_transfer_ms
            .filter(|ms| *ms > LONGEST_TRANSFER_MS);
        let breaches = [
            (bad > 0).then_some(Self::BadCommands(bad)),
            (gap_ms > LONGEST_GAP_MS).then_some(Self::Gap(gap_ms)),
            wait.map(Self::Wait),
        ];
        breaches.into_iter().flatten()
    }

    /// Nothing was told, and nothing need be: the drone flew on as if nothing had broken.
    pub(super) fn is_harmless(came: &FaultReport) -> bool {
        came.detected_ms.is_none()
            && came.outcome == Outcome::Flies
            && came.largest_tilt_deg <= HARMLESS_TILT_DEG
    }

    /// The same promise.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadCommands(count) => write!(f, "{count} bad commands"),
            Self::Gap(ms) => write!(f, "{ms:.0} ms without a run"),
            Self::Wait(ms) => write!(f, "a bus kept for {ms:.1} ms"),
            Self::Unreported(tilt) => write!(f, "harmed and not told: tilted by {tilt:.0} degrees"),
        }
    }
}

//! Watches a flight for crashes and upsets.

use std::f64::consts::FRAC_PI_3;

use crate::drone::State;
use crate::faults::Crash;
use crate::ground::Touch;

/// Hardest touch-down that is none, m/s.
const HARDEST_LANDING: f64 = 2.5;
/// Largest tilt on the ground that is no crash, rad.
const LARGEST_TILT: f64 = FRAC_PI_3;
/// How long a drone may be upside down in the air, s.
const LONGEST_UPSET: f64 = 1.0;

/// What happened so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Watch {
    /// The first crash.
    pub(super) crash: Option<Crash>,
    /// When the first upset had lasted a second.
    pub(super) upset_ns: Option<u64>,
    /// Time upside down in the air, s.
    upside_down: f64,
}

impl Watch {
    /// Looks at the end of a step of `dt` seconds.
    pub(super) fn see(&mut self, state: &State, touch: Touch, dt: f64) {
        // Cosines: the angle itself is computed only for a report.
        let upright = state.uprightness();
        let hard = touch.impact > HARDEST_LANDING;
        if self.crash.is_none() && touch.any && (hard || upright < LARGEST_TILT.cos()) {
            self.crash = Some(Crash {
                at_ns: state.time_ns,
                speed: touch.impact.max(state.velocity.norm()),
                tilt: state.tilt(),
            });
        }
        let upside_down = !touch.any && upright < 0.0;
        self.upside_down = if upside_down {
            self.upside_down + dt
        } else {
            0.0
        };
        if self.upset_ns.is_none() && self.upside_down > LONGEST_UPSET {
            self.upset_ns = Some(state.time_ns);
        }
    }
}

//! Whether the warm-up of a replay under way is over: from there on it is scored.

use anyhow::Result;
use reflex::reactive::Phase;
use reflex::settings::Policy;

use crate::logics::Start;
use crate::record::{Mirror, Observation};

/// Follows the firmware's calls until control is reactive.
pub(super) struct Learning {
    mirror: Mirror,
    taken: usize,
    /// Only reactive control learns; other control is scored from the start of the flight.
    learns: bool,
    flight_start_ns: u64,
}

impl Learning {
    pub(super) fn new(start: &Start, flight_start_ns: u64) -> Self {
        Self {
            mirror: Mirror::new(start),
            taken: 0,
            learns: start.settings.policy == Policy::Reactive,
            flight_start_ns,
        }
    }

    /// Whether it is over at an instant, until which everything was observed.
    ///
    /// # Errors
    /// The firmware computed other bits than the host.
    pub(super) fn is_over(&mut self, observation: &Observation, now_ns: u64) -> Result<bool> {
        if !self.learns {
            return Ok(now_ns >= self.flight_start_ns);
        }
        for stamped in &observation.calls[self.taken..] {
            self.taken += 1;
            self.mirror.take(stamped)?;
            if self.mirror.autopilot().telemetry().phase == Phase::Reactive {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

//! One log, flown as configured and in every trial.

use super::Flight;
use crate::replay::native::Learned;
use crate::scoring::Score;

/// One log, flown as configured and in every trial.
pub(super) struct Flown {
    pub(super) log: String,
    pub(super) configured: Score,
    pub(super) learned: Vec<Learned>,
    pub(super) trials: Vec<Score>,
}

impl Flown {
    /// From the flights of a log, the configured one first; `None` of none.
    pub(super) fn new(log: &str, flights: Vec<Flight>) -> Option<Self> {
        let mut flights = flights.into_iter();
        let configured = flights.next()?;
        Some(Self {
            log: log.to_owned(),
            configured: configured.score,
            learned: configured.learned,
            trials: flights.map(|flight| flight.score).collect(),
        })
    }

    /// Whether the flight as configured says anything.
    pub(super) fn is_scored(&self) -> bool {
        self.configured.scored
    }

    /// Length of what is scored, s.
    pub(super) fn scored_s(&self) -> f64 {
        self.configured.duration_s - self.configured.warm_up_s
    }
}

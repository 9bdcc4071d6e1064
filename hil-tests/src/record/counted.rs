//! The instructions of a part of a flight, with what they were executed for.

use reflex::app::Call;

use super::Observation;
use emulated_board::{Board, Outcome, SensorLine, Tally};

/// Every instruction from an instant to the end of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Counted {
    /// The instructions.
    pub tally: Tally,
    /// Instructions that the core executes in a second without sleep.
    pub instructions_per_second: u64,
    /// Samples of the inertial sensor in that time.
    pub samples: u64,
    /// Runs of the control logic in that time.
    pub runs: u64,
}

/// What had been observed where counting began.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CountedFrom {
    samples: usize,
    calls: usize,
}

impl CountedFrom {
    /// Counts from here on.
    pub(crate) fn here(board: &mut dyn Board, observation: &Observation) -> Self {
        board.count();
        Self {
            samples: samples(observation),
            calls: observation.calls.len(),
        }
    }

    /// Everything since; none where the board counted nothing.
    pub(crate) fn to_end(self, observation: &Observation, outcome: &Outcome) -> Option<Counted> {
        let calls = observation.calls.get(self.calls..)?.iter();
        let runs = calls.filter(|stamped| matches!(stamped.call, Call::Ran(_)));
        Some(Counted {
            tally: outcome.tally.clone()?,
            instructions_per_second: outcome.load.instructions_per_second,
            samples: (samples(observation) - self.samples) as u64,
            runs: runs.count() as u64,
        })
    }
}

fn samples(observation: &Observation) -> usize {
    observation.edges[SensorLine::ImuReady.pin() as usize].len()
}

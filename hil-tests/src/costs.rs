//! What the firmware costs: instructions on the emulated core, memory, locks.
//!
//! | file | measures |
//! |---|---|
//! | `parts` | parts of the library one by one, in a program of their own |
//! | `logics`, `steps` | every control logic in four ways, on made-up steps and recorded flights |
//! | `flight` | the firmware while it flies: handlers, interrupt to motors, locks |
//! | `hover`, `budget` | parts of the firmware in a hover, per sample, against `budget.toml` |
//! | `activations`, `locks` | who executed which instructions; how long idle holds a lock |
//! | `table` | all of it, against its limits |
//!
//! The core counts every instruction as one cycle, and every run is the same: numbers are exact,
//! and lower bounds of the cycles on silicon.

mod activations;
mod budget;
mod flight;
mod hover;
mod locks;
mod logics;
mod parts;
mod program;
mod steps;
mod table;
#[cfg(test)]
mod tests;

use anyhow::Result;

pub use budget::Budget;
pub use logics::{FlightCost, LogicCost, WayCost};
#[cfg(test)]
pub(crate) use program::at_rest;
pub use table::{Cost, Costs, Memory};

use logics::LogicProgram;

use crate::firmware::Firmware;
use crate::logics::LogicName;
use crate::progress::Progress;
use recorded_flights::Flight;

/// Instructions of the emulated core in a second, one a cycle.
pub const CORE_HZ: u64 = 168_000_000;
/// Most instructions under the lock that swaps a model: 5 us, in which no sample is late.
const SWAP_LIMIT: u64 = 840;

/// Builds and measures everything; control logics over recorded flights too, where some are given.
///
/// # Errors
/// A program that cannot be built, a fault of the board, or a program that is not as expected.
pub fn measure(flights: &[Flight], progress: &mut dyn Progress) -> Result<Costs> {
    let program = Firmware::build_parts(progress)?;
    let mut parts = parts::measure(program, progress)?;
    let logics = measure_logics(flights, progress)?;
    let firmware = Firmware::build(LogicName::configured(), progress)?;
    let flown = flight::measure(&firmware, progress)?;
    let hover = hover::measure(&firmware, progress)?;
    parts.extend(flown.parts);
    Ok(Costs {
        core_hz: CORE_HZ,
        parts,
        hover,
        logics,
        firmware: flown.memory,
        locks: flown.locks,
    })
}

/// Builds and measures control logics alone, over recorded flights too, where some are given.
///
/// # Errors
/// As those of [`measure`].
pub fn measure_logics(flights: &[Flight], progress: &mut dyn Progress) -> Result<Vec<LogicCost>> {
    let program = LogicProgram::build(progress)?;
    let measured = program.measure()?.into_iter();
    let with_flights = measured.map(|(name, mut cost)| {
        cost.flights = program.measure_flights(name, flights, progress)?;
        Ok(cost)
    });
    with_flights.collect()
}

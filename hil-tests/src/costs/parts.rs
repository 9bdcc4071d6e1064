//! Parts of the library one by one, between the marks of a program.

use std::sync::Arc;

use anyhow::{Result, ensure};
use reflex_bench::{NOTHING, PARTS};

use super::CORE_HZ;
use super::program::{Program, at_rest};
use super::table::Cost;
use crate::firmware::Firmware;
use crate::progress::Progress;
use emulated_board::Elf;

/// Runs the program of the parts and counts.
pub(super) fn measure(program: Firmware, progress: &mut dyn Progress) -> Result<Vec<Cost>> {
    progress.stage("Counting the parts");
    let elf = Arc::new(Elf::parse(program.bytes)?);
    let expected = expected();
    let pairs = Program::new(&elf)?.watch(at_rest(), |marks| {
        progress.done(marks as f64, 2.0 * expected as f64);
    })?;
    ensure!(
        pairs.len() == expected,
        "the parts ended at measurement {} of {expected}",
        pairs.len()
    );
    Ok(costs(pairs))
}

/// Measurements of all parts.
fn expected() -> usize {
    PARTS.iter().map(|part| part.rounds).sum()
}

/// Instructions of each measurement, less those of an empty one.
fn costs(measurements: Vec<u64>) -> Vec<Cost> {
    let mut pairs = measurements.into_iter();
    let mut nothing = 0;
    let mut costs = Vec::new();
    for part in PARTS {
        let counts: Vec<u64> = pairs.by_ref().take(part.rounds).collect();
        if part == NOTHING {
            nothing = counts.into_iter().min().unwrap_or(0);
            continue;
        }
        let counts = counts.iter().map(|count| count.saturating_sub(nothing));
        costs.push(Cost::of(part.name, counts.collect(), part.limit, CORE_HZ));
    }
    costs
}

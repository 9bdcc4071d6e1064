//! Tuning to equal margins: how fast each policy may make its loops.
//!
//! Everybody's attitude and rate loops are made faster by the same factors, and each policy keeps the
//! fastest that still bear a drone which answers twice as strongly (6 dB) and commands that apply
//! 20 ms late, hovering in the wind of the environment that they are for. Loops bear a strain where
//! the drone hardly turns; what has no margin left oscillates, ten times as fast or more.

use schemars::JsonSchema;
use serde::Serialize;

use super::journal::Records;
use super::margins::{BANDWIDTHS, strained};
use super::plan::Plan;
use super::role::{Contender, Role};
use super::sortie::{CellName, Sortie};

/// Most that a drone turns which bears its strain, RMS in rad/s. Wind alone turns it by 0.1.
const MOST_TURNING: f64 = 0.3;

/// How fast a policy may make the loops of one cell.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tuning {
    /// Environment, airframe and control logic.
    #[serde(flatten)]
    pub cell: CellName,
    /// The role that is flown with it.
    pub role: String,
    /// In % of the configured bandwidth.
    pub bandwidth_percent: u32,
}

/// The fastest loops that bear every strain, in %; the slowest where none do, none unflown.
#[must_use]
pub fn fastest(records: &Records, cell: &Sortie, of: Contender) -> Option<u32> {
    let percents = BANDWIDTHS;
    let mut fastest = percents.first().copied();
    for percent in percents {
        let mut bears = true;
        for flight in strained(cell, of, percent) {
            let report = &records.flights.get(&flight)?.report;
            let turning = report.turning_rad_s.filter(|_| !report.crashed);
            bears &= turning.is_some_and(|turning| turning <= MOST_TURNING);
        }
        if bears {
            fastest = Some(percent);
        }
    }
    fastest
}

/// Runs per second of tuned reactive control, the mean of a cell's flights.
#[must_use]
pub fn reactive_rate_hz(plan: &Plan, records: &Records, cell: &Sortie) -> Option<f64> {
    let flights = (1..=plan.tuned_seeds).map(|seed| plan.tuned(cell, Contender::Reactive, seed));
    let rates: Vec<f64> = flights
        .filter_map(|flight| records.flights.get(&flight)?.report.control.rate_hz)
        .collect();
    (!rates.is_empty()).then(|| rates.iter().sum::<f64>() / rates.len() as f64)
}

/// The bandwidths of every cell that is tuned.
#[must_use]
pub fn all(plan: &Plan, records: &Records) -> Vec<Tuning> {
    if plan.tuned_seeds == 0 {
        return Vec::new();
    }
    let cells = plan.cells();
    let tunings = cells.iter().flat_map(|cell| {
        Contender::ALL.into_iter().filter_map(|of| {
            Some(Tuning {
                cell: cell.cell(),
                role: Role::Tuned(of).to_string(),
                bandwidth_percent: fastest(records, cell, of)?,
            })
        })
    });
    tunings.collect()
}

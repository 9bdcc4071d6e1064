//! Sweeps: the same flights with many settings, natively and on every core.
//!
//! ```text
//! logs x grid of settings -- threads --> scores -> report -> tables, JSON, trade curves
//! ```
//! Every log is read once and every point flown as `replay --native` flies it. Points share
//! nothing, and results are put in the order of logs and points whichever ends first: the
//! report is the same whatever the number of threads.

mod chart;
mod grid;
mod outcome;
mod report;
mod table;
#[cfg(test)]
mod tests;

use anyhow::Result;
use recorded_flights::Flight;
use reflex::settings::Settings;

use crate::progress::Progress;
use crate::replay::native;
use crate::replay::options::ReplayOptions;

pub use crate::replay::logs::Skipped;
pub use chart::trade_curves;
pub use grid::{Axis, Grid, Parameter};
pub use outcome::Outcome;
pub use report::{Median, SweepPoint, SweepReport};
pub use table::tables;

use crate::replay::logs;

/// The options of a sweep, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepOptions {
    /// What holds at every point; its log may be a folder.
    pub replay: ReplayOptions,
    /// What differs between them.
    pub grid: Grid,
    /// Threads that fly; 0 for one on each core.
    pub threads: usize,
}

/// Flies every log at every point of the grid: some ten milliseconds for a second of flight.
///
/// # Errors
/// A log that cannot be replayed, where no folder was named; a folder without any; threads that
/// cannot be started.
pub fn sweep(options: &SweepOptions, progress: &mut dyn Progress) -> Result<SweepReport> {
    let logs = logs::open(&options.replay, progress)?;
    let points = options.grid.settings(options.replay.settings);
    progress.stage(&format!(
        "Flying {} settings on {}",
        points.len(),
        logs.counted()
    ));
    let score = |flight: &Flight, settings: &Settings| {
        let replay = ReplayOptions {
            settings: *settings,
            ..options.replay.clone()
        };
        native::fly_and_score(flight, &replay)
    };
    let how = (&options.replay, options.threads);
    let (flown, skipped) = logs::fly_each(logs, how, &points, score, progress)?;
    let mut scored = Vec::new();
    for (log, scores) in flown {
        let points = points.iter().zip(scores);
        scored.extend(points.map(|(point, score)| SweepPoint::new(&log, point, score)));
    }
    SweepReport::new(options, scored, skipped)
}

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
use reflex::settings::Settings;

use crate::parallel;
use crate::progress::Progress;
use crate::replay::native;
use crate::replay::options::ReplayOptions;
use crate::scoring::Score;

pub use crate::replay::logs::Skipped;
pub use chart::trade_curves;
pub use grid::{Axis, Grid, Parameter};
pub use outcome::Outcome;
pub use report::{Median, SweepPoint, SweepReport};
pub use table::tables;

use crate::replay::logs::{self, Log, Logs};

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
    let Logs { logs, mut skipped } = logs::open(&options.replay, progress)?;
    let points = options.grid.settings(options.replay.settings);
    progress.stage(&format!(
        "Flying {} settings on {} log{}",
        points.len(),
        logs.len(),
        if logs.len() == 1 { "" } else { "s" }
    ));
    let mut scores = fly(options, &logs, &points, progress)?.into_iter();
    let mut scored = Vec::new();
    for log in &logs {
        let own: Result<Vec<Score>> = scores.by_ref().take(points.len()).collect();
        match (own, &options.replay.log) {
            (Ok(own), _) => scored.extend(
                (points.iter().zip(own)).map(|(point, score)| SweepPoint::new(log, point, score)),
            ),
            (Err(error), Some(path)) if path.is_dir() && logs::is_refusal(&error) => {
                skipped.push(Skipped::new(&log.name, &error));
            }
            (Err(error), _) => return Err(error),
        }
    }
    skipped.sort_by(|one, other| one.log.cmp(&other.log));
    match &options.replay.log {
        Some(folder) if scored.is_empty() => Err(logs::no_log(folder, &skipped).into()),
        _ => SweepReport::new(options, scored, skipped),
    }
}

/// Flies each pair of log and point in some thread; the scores are in the order of the pairs.
fn fly(
    options: &SweepOptions,
    logs: &[Log],
    points: &[Settings],
    progress: &mut dyn Progress,
) -> Result<Vec<Result<Score>>> {
    let pairs: Vec<_> = logs
        .iter()
        .flat_map(|log| points.iter().map(move |point| (log, point)))
        .collect();
    let score = |(log, point): &(&Log, &Settings)| {
        let replay = ReplayOptions {
            settings: **point,
            ..options.replay.clone()
        };
        native::fly_and_score(&log.flight, &replay)
    };
    parallel::map(&pairs, options.threads, score, progress)
}

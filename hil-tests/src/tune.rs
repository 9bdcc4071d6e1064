//! Tuning: what other settings would change on one's own flights, and which pays.
//!
//! ```text
//! logs x (as configured + a trial for each neighbouring value) -- threads --> scores
//!     -> effects, paired by log or by window -> the change of config/ that pays
//! ```
//! Every trial differs from the configuration in one value. All are flown natively, and judged by two
//! numbers: runs per second, and how far the held commands strayed as the motors feel it. A value pays
//! where one of them surely falls and the other does not rise.

mod curves;
mod effect;
mod flown;
mod page;
mod proposal;
mod report;
mod table;
#[cfg(test)]
mod tests;
mod trials;
mod tried;

use anyhow::Result;
use reflex::settings::Settings;

use crate::progress::Progress;
use crate::replay::logs;
use crate::replay::native::{Learned, fly_and_learn};
use crate::replay::options::ReplayOptions;
use crate::scoring::Score;

pub use page::page;
pub use report::TuneReport;
pub use table::summary;

use flown::Flown;

/// The options of a tuning, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct TuneOptions {
    /// What holds in every flight; its log may be a folder.
    pub replay: ReplayOptions,
    /// Threads that fly; 0 for one on each core.
    pub threads: usize,
}

/// One log flown once: with the configuration, or in a trial.
struct Flight {
    score: Score,
    /// What its inputs learned.
    learned: Vec<Learned>,
}

/// Flies every log as configured and in every trial: some ten milliseconds for a second of flight.
///
/// # Errors
/// A log that cannot be replayed, where no folder was named; a folder without any; threads that
/// cannot be started; a file of `config/` that cannot be read.
pub fn tune(options: &TuneOptions, progress: &mut dyn Progress) -> Result<TuneReport> {
    let logs = logs::open(&options.replay, progress)?;
    let trials = trials::of(&options.replay.settings);
    progress.stage(&format!(
        "Flying the configuration and {} other values on {}",
        trials.len(),
        logs.counted()
    ));
    let configured = std::iter::once(options.replay.settings);
    let settings: Vec<Settings> = configured
        .chain(trials.iter().map(|trial| trial.settings))
        .collect();
    let fly = |flight: &recorded_flights::Flight, settings: &Settings| {
        let replay = ReplayOptions {
            settings: *settings,
            ..options.replay.clone()
        };
        let (score, learned) = fly_and_learn(flight, &replay)?;
        Ok(Flight { score, learned })
    };
    let how = (&options.replay, options.threads);
    let (flown, skipped) = logs::fly_each(logs, how, &settings, fly, progress)?;
    let flown = flown.into_iter();
    let flown = flown.filter_map(|(log, flights)| Flown::new(&log.name, flights));
    TuneReport::new(options, &trials, flown.collect(), skipped)
}

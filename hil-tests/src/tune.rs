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

use crate::parallel;
use crate::progress::Progress;
use crate::replay::logs::{self, Log, Logs, Skipped};
use crate::replay::native::{Learned, fly_and_learn, fly_and_score};
use crate::replay::options::ReplayOptions;
use crate::scoring::Score;

pub use page::page;
pub use report::TuneReport;
pub use table::summary;

use flown::Flown;
use trials::Trial;

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
    /// What its inputs learned; with the configuration alone.
    learned: Vec<Learned>,
}

/// Flies every log as configured and in every trial: some ten milliseconds for a second of flight.
///
/// # Errors
/// A log that cannot be replayed, where no folder was named; a folder without any; threads that
/// cannot be started; a file of `config/` that cannot be read.
pub fn tune(options: &TuneOptions, progress: &mut dyn Progress) -> Result<TuneReport> {
    let Logs { logs, mut skipped } = logs::open(&options.replay, progress)?;
    let trials = trials::of(&options.replay.settings);
    progress.stage(&format!(
        "Flying the configuration and {} other values on {} log{}",
        trials.len(),
        logs.len(),
        if logs.len() == 1 { "" } else { "s" }
    ));
    let mut flights = fly(options, &logs, &trials, progress)?.into_iter();
    let mut flown = Vec::new();
    for log in &logs {
        let own: Result<Vec<Flight>> = flights.by_ref().take(1 + trials.len()).collect();
        match (own, &options.replay.log) {
            (Ok(own), _) => flown.extend(Flown::new(&log.name, own)),
            (Err(error), Some(path)) if path.is_dir() && logs::is_refusal(&error) => {
                skipped.push(Skipped::new(&log.name, &error));
            }
            (Err(error), _) => return Err(error),
        }
    }
    skipped.sort_by(|one, other| one.log.cmp(&other.log));
    match &options.replay.log {
        Some(folder) if flown.is_empty() => Err(logs::no_log(folder, &skipped).into()),
        _ => TuneReport::new(options, &trials, flown, skipped),
    }
}

/// Flies each log, as configured first and then in each trial, in some thread.
fn fly(
    options: &TuneOptions,
    logs: &[Log],
    trials: &[Trial],
    progress: &mut dyn Progress,
) -> Result<Vec<Result<Flight>>> {
    let settings: Vec<Option<Settings>> = std::iter::once(None)
        .chain(trials.iter().map(|trial| Some(trial.settings)))
        .collect();
    let pairs: Vec<_> = logs
        .iter()
        .flat_map(|log| settings.iter().map(move |settings| (log, *settings)))
        .collect();
    let one = |(log, settings): &(&Log, Option<Settings>)| match settings {
        None => fly_and_learn(&log.flight, &options.replay)
            .map(|(score, learned)| Flight { score, learned }),
        Some(settings) => {
            let replay = ReplayOptions {
                settings: *settings,
                ..options.replay.clone()
            };
            fly_and_score(&log.flight, &replay).map(|score| Flight {
                score,
                learned: Vec::new(),
            })
        }
    };
    parallel::map(&pairs, options.threads, one, progress)
}

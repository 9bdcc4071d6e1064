//! The logs that are flown with many settings: one, or all that a folder holds.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Error, Result};
use schemars::JsonSchema;
use serde::Serialize;

use super::options::ReplayOptions;
use super::{open_flight, refusals};
use crate::parallel;
use crate::progress::{Progress, named};
use crate::refusal::Refusal;
use recorded_flights::{Flight, FlightError};

/// A flight with the path that it was read from.
#[derive(Clone, Debug)]
pub(crate) struct Log {
    /// The path, as it was given or found.
    pub name: String,
    pub flight: Flight,
}

/// A file that was left out, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Skipped {
    /// The path.
    pub log: String,
    /// What is wrong with it, in one line.
    pub reason: String,
}

impl Skipped {
    /// A file with the refusal that it met.
    pub(crate) fn new(log: &str, error: &Error) -> Self {
        let text = format!("{error:#}");
        // The list names the file already.
        let reason = text.strip_prefix(&format!("{log}: ")).unwrap_or(&text);
        Self {
            log: log.to_owned(),
            reason: reason.to_owned(),
        }
    }
}

/// What there is to fly.
#[derive(Debug, Default)]
pub(crate) struct Logs {
    pub logs: Vec<Log>,
    pub skipped: Vec<Skipped>,
}

impl Logs {
    /// How many there are, in words.
    pub(crate) fn counted(&self) -> String {
        match self.logs.len() {
            1 => "1 log".to_owned(),
            count => format!("{count} logs"),
        }
    }
}

/// Whether the log was at fault, and not this program.
fn is_refusal(error: &Error) -> bool {
    error.is::<Refusal>() || error.is::<FlightError>()
}

/// Reads every log once, in the order of their names.
///
/// # Errors
/// A log that cannot be replayed where it is the only one named; a folder that cannot be read
/// or holds no log.
pub(crate) fn open(replay: &ReplayOptions, progress: &mut dyn Progress) -> Result<Logs> {
    let folder = match &replay.log {
        Some(path) if path.is_dir() => path,
        _ => {
            let (flight, path) = open_flight(replay)?;
            let name = path.display().to_string();
            return Ok(Logs {
                logs: vec![Log { name, flight }],
                skipped: Vec::new(),
            });
        }
    };
    progress.stage(&format!("Reading {}", named(folder)));
    let files = files_of(folder)?;
    let mut logs = Logs::default();
    for (done, path) in files.iter().enumerate() {
        match open_one(replay, path) {
            Ok(log) => logs.logs.push(log),
            Err(error) => {
                let name = path.display().to_string();
                logs.skipped.push(Skipped::new(&name, &error));
            }
        }
        progress.done((done + 1) as f64, files.len() as f64);
    }
    if logs.logs.is_empty() {
        return Err(no_log(folder, &logs.skipped).into());
    }
    Ok(logs)
}

/// What came of each log, in every way that it was flown.
pub(crate) type OfLogs<T> = Vec<(Log, Vec<T>)>;

/// Flies every log in each of some ways, each pair in some thread: what came of each log, in order.
///
/// Of a folder, logs that cannot be replayed are left out.
///
/// # Errors
/// A log that cannot be replayed, where no folder was named; a folder in which none can; threads that
/// cannot be started.
pub(crate) fn fly_each<W: Sync, T: Send>(
    Logs { logs, mut skipped }: Logs,
    (replay, threads): (&ReplayOptions, usize),
    ways: &[W],
    fly: impl Fn(&Flight, &W) -> Result<T> + Sync,
    progress: &mut dyn Progress,
) -> Result<(OfLogs<T>, Vec<Skipped>)> {
    let pairs: Vec<_> = logs
        .iter()
        .flat_map(|log| ways.iter().map(move |way| (log, way)))
        .collect();
    let one = |(log, way): &(&Log, &W)| fly(&log.flight, way);
    let mut flown = parallel::map(&pairs, threads, one, progress)?.into_iter();
    let folder = replay.log.as_ref().filter(|path| path.is_dir());
    let mut of_logs = Vec::new();
    for log in logs {
        let own: Result<Vec<T>> = flown.by_ref().take(ways.len()).collect();
        match own {
            Ok(own) => of_logs.push((log, own)),
            Err(error) if folder.is_some() && is_refusal(&error) => {
                skipped.push(Skipped::new(&log.name, &error));
            }
            Err(error) => return Err(error),
        }
    }
    skipped.sort_by(|one, other| one.log.cmp(&other.log));
    match folder {
        Some(folder) if of_logs.is_empty() => Err(no_log(folder, &skipped).into()),
        _ => Ok((of_logs, skipped)),
    }
}

/// The refusal of a folder in which nothing can be flown.
fn no_log(folder: &Path, skipped: &[Skipped]) -> Refusal {
    let folder = folder.display();
    Refusal::new(match skipped.first() {
        None => format!("{folder}: is an empty folder, name one with logs"),
        Some(first) => format!(
            "{folder}: none of its {} files is a log that can be replayed, the first: {}: {}",
            skipped.len(),
            first.log,
            first.reason
        ),
    })
}

/// What is in a folder, in the order of the names.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>> {
    let refused = |error: std::io::Error| {
        Refusal::new(format!("{}: cannot be read: {error}", folder.display()))
    };
    let mut names: Vec<OsString> = Vec::new();
    for entry in folder.read_dir().map_err(refused)? {
        names.push(entry.map_err(refused)?.file_name());
    }
    names.sort();
    Ok(names.into_iter().map(|name| folder.join(name)).collect())
}

fn open_one(replay: &ReplayOptions, path: &Path) -> Result<Log> {
    let name = path.display().to_string();
    if path.is_dir() {
        return Err(Refusal::new("is a folder, and folders in folders are not searched").into());
    }
    let flight = Flight::read(path, replay.reading.clone())?;
    refusals::check_flight(replay, &flight, &name)?;
    Ok(Log { name, flight })
}

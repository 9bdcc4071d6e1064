//! The journal: a line of JSON per finished flight, so that none is flown twice.
//!
//! A folder holds the journals of all parts of a campaign. A line is written in one piece when its
//! flight has ended; what a kill leaves of a last line is dropped. Every line carries the stamp of
//! what flew: flights of another plan or of other sources are refused rather than mixed.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shard::Shard;
use super::sortie::{Job, Sortie};
use crate::closed_loop::report::FlightReport;
use crate::refusal::Refusal;

/// Version of the lines; another one cannot be read.
const VERSION: u32 = 1;

/// What flew: lines with different stamps do not go together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Version of the journal.
    pub version: u32,
    /// Name of the plan.
    pub plan: String,
    /// Fingerprint of the sources that a flight depends on.
    pub sources: String,
}

/// Mean instructions of a control logic's run, in each way of making it reactive.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Ways {
    /// Name of the control logic.
    pub logic: String,
    /// Ours: the graph, which computes what a change reaches.
    pub ours: u64,
    /// Callbacks through function pointers, depth first.
    pub callbacks: u64,
    /// The pointer vector of the paper's RP-Embedded.
    pub pointer_vector: u64,
}

/// A finished flight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Landed {
    /// What was flown.
    pub job: Job,
    /// Its report.
    pub report: FlightReport,
}

/// One line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Line {
    stamp: Stamp,
    // Not flattened: with what other crates ask of serde_json, numbers would not survive that.
    entry: Entry,
}

/// What a line holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Entry {
    Landed(Box<Landed>),
    Ways(Vec<Ways>),
}

/// Everything that the journals of a folder hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records {
    /// Finished flights, in order.
    pub flights: BTreeMap<Sortie, Landed>,
    /// Costs of the control logics; none where they were not measured.
    pub ways: Vec<Ways>,
    /// Of all lines; none without any.
    pub stamp: Option<Stamp>,
}

/// Records with the one journal that is written to.
#[derive(Debug)]
pub struct Journal {
    /// What is known.
    pub records: Records,
    file: File,
    path: PathBuf,
}

impl Stamp {
    /// A stamp of this version.
    #[must_use]
    pub fn new(plan: &str, sources: String) -> Self {
        Self {
            version: VERSION,
            plan: plan.to_owned(),
            sources,
        }
    }

    /// Why lines of another stamp do not go with this one's.
    fn differs(&self, other: &Self) -> Option<String> {
        if self.version != other.version {
            let (here, there) = (self.version, other.version);
            Some(format!("is of version {there}, this program writes {here}"))
        } else if self.plan != other.plan {
            Some(format!("is of plan {}, not of {}", other.plan, self.plan))
        } else if self.sources != other.sources {
            let (here, there) = (&self.sources, &other.sources);
            Some(format!("was flown by sources {there}, these are {here}"))
        } else {
            None
        }
    }
}

/// The line of a finished flight.
///
/// # Errors
/// None in practice: every value can be written.
pub fn flight_line(stamp: &Stamp, landed: Landed) -> Result<String> {
    line(stamp, Entry::Landed(Box::new(landed)))
}

/// The line of the control logics' costs.
///
/// # Errors
/// None in practice: every value can be written.
pub fn ways_line(stamp: &Stamp, ways: Vec<Ways>) -> Result<String> {
    line(stamp, Entry::Ways(ways))
}

fn line(stamp: &Stamp, entry: Entry) -> Result<String> {
    let stamp = stamp.clone();
    Ok(serde_json::to_string(&Line { stamp, entry })? + "\n")
}

impl Records {
    /// Reads every journal of a folder, in the order of their names.
    ///
    /// With a stamp all lines must carry that one, without any they must carry the same.
    ///
    /// # Errors
    /// A file that cannot be read, a line of another stamp or none at all, two lines about
    /// one flight in different ways: file and line are named.
    pub fn read(folder: &Path, stamp: Option<&Stamp>) -> Result<Self, Refusal> {
        let mut records = Self {
            stamp: stamp.cloned(),
            ..Self::default()
        };
        for path in journals(folder)? {
            let text = fs::read_to_string(&path).map_err(|error| unreadable(&path, &error))?;
            // What lies behind the last end of a line was cut off in writing.
            let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
            for (number, text) in (1..).zip(whole.lines()) {
                records.add(text).map_err(|reason| {
                    let path = path.display();
                    Refusal::new(format!(
                        "{path}:{number}: {reason}; remove that file or name another folder with --out"
                    ))
                })?;
            }
        }
        Ok(records)
    }

    /// Takes a line; says why it cannot be taken.
    fn add(&mut self, text: &str) -> Result<(), String> {
        let line: Line = serde_json::from_str(text)
            .map_err(|error| format!("is no line of a campaign's journal ({error})"))?;
        let own = self.stamp.get_or_insert_with(|| Stamp {
            version: VERSION,
            ..line.stamp.clone()
        });
        if let Some(reason) = own.differs(&line.stamp) {
            return Err(reason);
        }
        match line.entry {
            Entry::Ways(ways) => self.ways = ways,
            Entry::Landed(landed) => {
                let sortie = landed.job.sortie.clone();
                if let Some(known) = self.flights.get(&sortie)
                    && *known != *landed
                {
                    return Err(format!(
                        "{sortie}: tells of another flight than a line before"
                    ));
                }
                self.flights.insert(sortie, *landed);
            }
        }
        Ok(())
    }
}

impl Journal {
    /// Opens the journal of a part, and reads those of all parts.
    ///
    /// # Errors
    /// As those of [`Records::read`]; a folder that cannot be made or written to; a journal that
    /// another campaign is writing.
    pub fn open(folder: &Path, shard: Option<Shard>, stamp: &Stamp) -> Result<Self, Refusal> {
        let refused = |error: std::io::Error| {
            let folder = folder.display();
            Refusal::new(format!("--out {folder}: cannot be written to: {error}"))
        };
        fs::create_dir_all(folder).map_err(refused)?;
        let name = match shard {
            None => "journal.jsonl".to_owned(),
            Some(Shard { index, of }) => format!("journal-{index}-of-{of}.jsonl"),
        };
        let path = folder.join(name);
        let mut options = OpenOptions::new();
        let file = options
            .read(true)
            .append(true)
            .create(true)
            .open(&path)
            .map_err(refused)?;
        file.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => Refusal::new(format!(
                "{}: another campaign is writing it, wait for its end or name another folder with --out",
                path.display()
            )),
            TryLockError::Error(error) => refused(error),
        })?;
        let text = fs::read(&path).map_err(refused)?;
        let whole = text
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |end| end + 1);
        file.set_len(whole as u64).map_err(refused)?;
        let records = Records::read(folder, Some(stamp))?;
        Ok(Self {
            records,
            file,
            path,
        })
    }

    /// Writes a line, then takes it as a later campaign will read it.
    ///
    /// # Errors
    /// The line cannot be written, or is none.
    pub fn write(&mut self, line: &str) -> Result<()> {
        self.records.add(line.trim_end()).map_err(Refusal::new)?;
        self.file.write_all(line.as_bytes()).map_err(|error| {
            Refusal::new(format!(
                "{}: cannot be written: {error}",
                self.path.display()
            ))
        })?;
        Ok(())
    }
}

/// The journals of a folder in the order of names; none where there is no folder.
fn journals(folder: &Path) -> Result<Vec<PathBuf>, Refusal> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unreadable(folder, &error)),
    };
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| unreadable(folder, &error))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("journal") && name.ends_with(".jsonl") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn unreadable(path: &Path, error: &std::io::Error) -> Refusal {
    Refusal::new(format!("{}: cannot be read: {error}", path.display()))
}

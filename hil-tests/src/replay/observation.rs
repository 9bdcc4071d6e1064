//! What was seen of the board: motor writes, interrupt edges, calls, log.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use reflex::app::{DecodeError, Stamped};

use super::bench::HANDLERS;
use crate::board::{Edge, Hit, Line, LogLine, MotorWrite, Observer};

/// Everything a replay keeps of its board.
pub(super) struct Observation {
    pub(super) motors: Vec<MotorWrite>,
    /// Rising edges of each line, in ns.
    pub(super) edges: [Vec<u64>; Line::ALL.len()],
    /// When each of the watched handlers was entered, in ns.
    pub(super) entries: [Vec<u64>; HANDLERS.len()],
    pub(super) calls: Vec<Stamped>,
    undecoded: Vec<u8>,
    broken: Option<String>,
    defmt: Option<BufWriter<File>>,
    path: PathBuf,
    write_error: Option<std::io::Error>,
    /// Lines of the firmware's log at the level `error`.
    pub(super) errors: Vec<String>,
    pub(super) log_lines: u64,
}

impl Observation {
    /// The decoded log goes to `defmt`, a file of the name `path`.
    pub(super) fn new(defmt: Option<BufWriter<File>>, path: Option<PathBuf>) -> Self {
        Self {
            motors: Vec::new(),
            edges: Default::default(),
            entries: Default::default(),
            calls: Vec::new(),
            undecoded: Vec::new(),
            broken: None,
            defmt,
            path: path.unwrap_or_default(),
            write_error: None,
            errors: Vec::new(),
            log_lines: 0,
        }
    }

    /// Writes out what is buffered of the decoded log.
    pub(super) fn flush(&mut self) -> Result<()> {
        let path = &self.path;
        let told = || format!("--defmt {}: cannot be written", path.display());
        if let Some(error) = self.write_error.take() {
            return Err(error).with_context(told);
        }
        match &mut self.defmt {
            Some(defmt) => defmt.flush().with_context(told),
            None => Ok(()),
        }
    }

    /// Fails where the call log was not what the firmware's library writes.
    pub(super) fn check(&self) -> Result<()> {
        match &self.broken {
            Some(what) => bail!("the firmware's call log cannot be read: {what}"),
            None => Ok(()),
        }
    }

    fn decode(&mut self) {
        let mut taken = 0;
        while self.broken.is_none() {
            match Stamped::decode(&self.undecoded[taken..]) {
                Ok((stamped, length)) => {
                    self.calls.push(stamped);
                    taken += length;
                }
                Err(DecodeError::Incomplete) => break,
                Err(DecodeError::Unknown(number)) => {
                    let calls = self.calls.len();
                    self.broken = Some(format!("unknown number {number} behind {calls} calls"));
                }
            }
        }
        self.undecoded.drain(..taken);
    }
}

impl Observer for Observation {
    fn motors(&mut self, write: &MotorWrite) {
        self.motors.push(*write);
    }

    fn edge(&mut self, edge: Edge) {
        if edge.rising {
            self.edges[edge.line.pin() as usize].push(edge.at_ns);
        }
    }

    fn calls(&mut self, _at_ns: u64, bytes: &[u8]) {
        self.undecoded.extend_from_slice(bytes);
        self.decode();
    }

    fn log(&mut self, line: &LogLine) {
        self.log_lines += 1;
        if line.level == Some("error") {
            self.errors.push(line.text.clone());
        }
        let Some(defmt) = &mut self.defmt else {
            return;
        };
        let stamp = line.timestamp.as_deref().unwrap_or("-");
        let level = line.level.unwrap_or("-");
        if let Err(error) = writeln!(defmt, "{stamp} {level} {}", line.text) {
            self.write_error.get_or_insert(error);
        }
    }

    fn hit(&mut self, hit: Hit) {
        self.entries[hit.watch].push(hit.at_ns);
    }
}

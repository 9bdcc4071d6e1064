//! What was seen of the board: motor writes, interrupt edges, calls, log.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use anyhow::{Context, Result};
use reflex::app::Stamped;

use super::bench::HANDLERS;
use super::call_stream::CallStream;
use emulated_board::{Edge, Hit, Line, LogLine, MotorWrite, Observer};

/// Everything a replay keeps of its board.
pub(crate) struct Observation {
    pub(crate) motors: Vec<MotorWrite>,
    /// Rising edges of each line, in ns.
    pub(crate) edges: [Vec<u64>; Line::ALL.len()],
    /// When each of the watched handlers was entered, in ns.
    pub(super) entries: [Vec<u64>; HANDLERS.len()],
    pub(crate) calls: Vec<Stamped>,
    stream: CallStream,
    defmt: Option<BufWriter<File>>,
    path: PathBuf,
    write_error: Option<std::io::Error>,
    /// Lines of the firmware's log at the level `error`.
    pub(crate) errors: Vec<String>,
    pub(super) log_lines: u64,
}

impl Observation {
    /// The decoded log goes to `defmt`, a file of the name `path`.
    pub(crate) fn new(defmt: Option<BufWriter<File>>, path: Option<PathBuf>) -> Self {
        Self {
            motors: Vec::new(),
            edges: Default::default(),
            entries: Default::default(),
            calls: Vec::new(),
            stream: CallStream::default(),
            defmt,
            path: path.unwrap_or_default(),
            write_error: None,
            errors: Vec::new(),
            log_lines: 0,
        }
    }

    /// Writes out what is buffered of the decoded log.
    pub(crate) fn flush(&mut self) -> Result<()> {
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
    pub(crate) fn check(&self) -> Result<()> {
        self.stream.check()
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
        self.stream.feed(bytes, &mut self.calls);
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

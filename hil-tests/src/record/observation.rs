//! What was observed of a board: motor writes, interrupt edges, calls, log.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use reflex::app::Stamped;

use super::call_stream::CallStream;
use crate::output_file::OutputFile;
use emulated_board::{Edge, Hit, LogLine, MotorWrite, Observer, SensorLine};

/// Handlers on the way from the gyro's interrupt to the motors, in order.
///
/// The last one is pended by software; see the table at the head of the firmware's `main.rs`.
pub(crate) const WAY: [&str; 3] = ["EXTI0", "DMA1_STREAM0", "CAN2_TX"];

/// Everything that is kept of a board's run.
pub(crate) struct Observation {
    pub(crate) motors: Vec<MotorWrite>,
    /// Rising edges of each line, in ns.
    pub(crate) edges: [Vec<u64>; SensorLine::ALL.len()],
    /// When each of the watched handlers was entered, in ns.
    pub(crate) entries: [Vec<u64>; WAY.len()],
    pub(crate) calls: Vec<Stamped>,
    stream: CallStream,
    log: Option<DecodedLog>,
    /// Lines of the firmware's log at the level `error`.
    pub(crate) errors: Vec<String>,
    pub(crate) log_lines: u64,
}

impl Observation {
    /// Nothing yet; the decoded log goes to a file where one is given.
    pub(crate) fn new(log: Option<DecodedLog>) -> Self {
        Self {
            motors: Vec::new(),
            edges: Default::default(),
            entries: Default::default(),
            calls: Vec::new(),
            stream: CallStream::default(),
            log,
            errors: Vec::new(),
            log_lines: 0,
        }
    }

    /// Writes out what is buffered of the decoded log.
    ///
    /// # Errors
    /// The file could not be written.
    pub(crate) fn flush(&mut self) -> Result<()> {
        self.log.as_mut().map_or(Ok(()), DecodedLog::flush)
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
            self.edges[edge.line as usize].push(edge.at_ns);
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
        if let Some(log) = &mut self.log {
            log.write(line);
        }
    }

    fn hit(&mut self, hit: Hit) {
        self.entries[hit.watch].push(hit.at_ns);
    }
}

/// The firmware's log, written to a file as text. An error of writing is kept until the end.
pub(crate) struct DecodedLog {
    path: PathBuf,
    file: BufWriter<File>,
    error: Option<std::io::Error>,
}

impl DecodedLog {
    /// Opens the file that `--defmt` names.
    pub(crate) fn create(path: &Path) -> Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            file: OutputFile::new("defmt", path).create()?,
            error: None,
        })
    }

    fn write(&mut self, line: &LogLine) {
        let stamp = line.timestamp.as_deref().unwrap_or("-");
        let level = line.level.unwrap_or("-");
        if let Err(error) = writeln!(self.file, "{stamp} {level} {}", line.text) {
            self.error.get_or_insert(error);
        }
    }

    fn flush(&mut self) -> Result<()> {
        let written = match self.error.take() {
            Some(error) => Err(error),
            None => self.file.flush(),
        };
        written.with_context(|| format!("--defmt {}: cannot be written", self.path.display()))
    }
}

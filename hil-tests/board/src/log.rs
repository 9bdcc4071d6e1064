//! Decodes the firmware's defmt log with the strings of its ELF.

use anyhow::{Context, Result, bail};
use defmt_decoder::{DecodeError, Encoding, Table};

/// One line of the firmware's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// When the host took it from the board, in ns.
    pub at_ns: u64,
    /// The firmware's own time stamp, when it prints one.
    pub timestamp: Option<String>,
    /// `trace`, `debug`, `info`, `warn` or `error`; none for plain prints.
    pub level: Option<&'static str>,
    /// The message.
    pub text: String,
}

impl std::fmt::Display for LogLine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(timestamp) = &self.timestamp {
            write!(f, "{timestamp} ")?;
        }
        write!(f, "{:5} {}", self.level.unwrap_or(""), self.text)
    }
}

/// Turns RTT bytes into lines; frames may be split between two calls.
pub struct LogDecoder {
    table: Table,
    pending: Vec<u8>,
    damaged: u64,
}

impl LogDecoder {
    /// A decoder with the format strings of the firmware in `elf`.
    pub fn new(elf: &[u8]) -> Result<Self> {
        let table = Table::parse(elf)
            .context("the firmware's defmt strings cannot be read")?
            .context("the firmware has no .defmt section: link it with -Tdefmt.x")?;
        if !matches!(table.encoding(), Encoding::Rzcobs) {
            bail!("the firmware logs in defmt's raw encoding, which cannot be resynchronised");
        }
        Ok(Self {
            table,
            pending: Vec::new(),
            damaged: 0,
        })
    }

    /// Frames that could not be decoded: the ring was full when they came.
    pub fn damaged(&self) -> u64 {
        self.damaged
    }

    /// Takes `bytes` read at `at_ns` and returns the lines they complete.
    pub fn feed(&mut self, at_ns: u64, bytes: &[u8]) -> Vec<LogLine> {
        self.pending.extend_from_slice(bytes);
        // Every frame ends with a zero, so a fresh decoder sees whole frames.
        let Some(end) = self.pending.iter().rposition(|&byte| byte == 0) else {
            return Vec::new();
        };
        let complete: Vec<u8> = self.pending.drain(..=end).collect();
        let mut decoder = self.table.new_stream_decoder();
        decoder.received(&complete);
        let mut lines = Vec::new();
        loop {
            match decoder.decode() {
                Ok(frame) => lines.push(LogLine {
                    at_ns,
                    timestamp: frame.display_timestamp().map(|stamp| stamp.to_string()),
                    level: frame.level().map(|level| level.as_str()),
                    text: frame.display_message().to_string(),
                }),
                Err(DecodeError::UnexpectedEof) => return lines,
                Err(DecodeError::Malformed) => self.damaged += 1,
            }
        }
    }
}

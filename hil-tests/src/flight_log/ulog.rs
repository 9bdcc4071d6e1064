//! Flight logs as ULog, which PX4's tools open, and `cargo hil replay` itself.
//!
//! Written here: the one crate that writes ULogs, `yule_log`, brings a logger with clocks and regular
//! expressions, and what is needed of the format is a length, a letter and bytes. Nothing is gone back
//! to: a file that is cut off is read up to there.

use std::fs::File;
use std::io::{BufWriter, Write};

use anyhow::{Context, Result};

use super::LogFile;
use super::topics::{Field, Kind, Topic};

/// What every file starts with: the magic, version 1, and when the log began.
const HEADER: [u8; 16] = *b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0";
/// Bytes of flags: none is needed.
const FLAGS: [u8; 40] = [0; 40];
/// The level of a line, as of the kernel: information.
const INFORMATION: u8 = b'6';

/// A flight log under way.
pub(super) struct UlogFile {
    file: BufWriter<File>,
    /// Kinds of each topic's fields.
    kinds: Vec<Vec<Kind>>,
}

impl UlogFile {
    /// Writes what stands at the beginning: formats, units, and a subscription for each topic.
    pub(super) fn begin(mut file: BufWriter<File>) -> Result<Self> {
        file.write_all(&HEADER)?;
        let mut log = Self {
            file,
            kinds: Vec::new(),
        };
        log.message(b'B', &[&FLAGS])?;
        log.information("sys_name", "Reflex")?;
        log.information("ver_sw_release_str", env!("CARGO_PKG_VERSION"))?;
        for topic in Topic::ALL {
            let fields = topic.fields();
            log.message(b'F', &[format(topic, &fields).as_bytes()])?;
            for field in &fields {
                log.describe(topic, field)?;
            }
            log.kinds.push(topic.kinds());
        }
        for topic in Topic::ALL {
            log.message(
                b'A',
                &[&[0], &number(topic).to_le_bytes(), topic.ulog().as_bytes()],
            )?;
        }
        Ok(log)
    }

    /// A field's unit and choices, which formats have no place for.
    fn describe(&mut self, topic: Topic, field: &Field) -> Result<()> {
        let of_field = |what: &str| format!("{what}_{}_{}", topic.ulog(), field.ulog());
        if !field.unit.is_empty() {
            self.information(&of_field("unit"), field.unit)?;
        }
        if let Kind::Choice(names) = &field.kind {
            self.information(&of_field("choices"), &names.join(" "))?;
        }
        Ok(())
    }

    fn information(&mut self, key: &str, text: &str) -> Result<()> {
        let key = format!("char[{}] {key}", text.len());
        let length = u8::try_from(key.len()).with_context(|| format!("{key}: too long a name"))?;
        self.message(b'I', &[&[length], key.as_bytes(), text.as_bytes()])
    }

    fn message(&mut self, kind: u8, parts: &[&[u8]]) -> Result<()> {
        let length = parts.iter().map(|part| part.len()).sum::<usize>();
        let length = u16::try_from(length).context("a message past 64 KiB")?;
        self.file.write_all(&length.to_le_bytes())?;
        self.file.write_all(&[kind])?;
        for part in parts {
            self.file.write_all(part)?;
        }
        Ok(())
    }
}

/// The number of a topic's subscription.
fn number(topic: Topic) -> u16 {
    topic as u16
}

/// A format: the name of a topic, and its fields behind their stamp.
fn format(topic: Topic, fields: &[Field]) -> String {
    let mut text = format!("{}:uint64_t timestamp;", topic.ulog());
    for field in fields {
        let of = match &field.kind {
            Kind::Flag => "bool".to_owned(),
            Kind::Choice(_) => "uint8_t".to_owned(),
            Kind::Number => "float".to_owned(),
            several => format!("float[{}]", several.width()),
        };
        text += &format!("{of} {};", field.ulog());
    }
    text
}

impl LogFile for UlogFile {
    fn row(&mut self, at_us: u64, topic: Topic, mut numbers: &[f32]) -> Result<()> {
        let mut data = at_us.to_le_bytes().to_vec();
        for kind in &self.kinds[topic as usize] {
            let (own, rest) = numbers.split_at(kind.width());
            match kind {
                Kind::Flag | Kind::Choice(_) => data.push(own[0] as u8),
                Kind::Number | Kind::Vector | Kind::Quaternion | Kind::Motors => {
                    data.extend(own.iter().flat_map(|number| number.to_le_bytes()));
                }
            }
            numbers = rest;
        }
        self.message(b'D', &[&number(topic).to_le_bytes(), &data])
    }

    fn line(&mut self, at_us: u64, text: &str) -> Result<()> {
        self.message(
            b'L',
            &[&[INFORMATION], &at_us.to_le_bytes(), text.as_bytes()],
        )
    }

    fn flush(&mut self) -> Result<()> {
        Ok(self.file.flush()?)
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        self.flush()
    }
}

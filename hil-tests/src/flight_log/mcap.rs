//! Flight logs as MCAP, which Foxglove, Rerun and PlotJuggler open.
//!
//! A chunk is written whole, once its messages are known: whatever ends the program, the file holds all
//! chunks before, and at worst a part of one, which readers that do not seek stop at.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};

use anyhow::Result;
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};

use super::LogFile;
use super::protobuf;
use super::topics::{Kind, Topic};

/// A flight log under way.
pub(super) struct McapFile {
    writer: Writer<BufWriter<File>>,
    /// Channels by topic; that of the lines behind them.
    channels: Vec<Channel>,
}

struct Channel {
    id: u16,
    kinds: Vec<Kind>,
    written: u32,
}

impl McapFile {
    /// Writes what stands at the beginning.
    pub(super) fn begin(file: BufWriter<File>) -> Result<Self> {
        let options = WriteOptions::new()
            .library(concat!("reflex ", env!("CARGO_PKG_VERSION")))
            // Chunks end where the log is flushed, and are never gone back to.
            .chunk_size(None)
            .disable_seeking(true);
        let mut writer = options.create(file)?;
        let described = protobuf::described();
        let mut channels = Vec::new();
        let mut add = |schema: &str, topic: &str, notes: &_, kinds| -> Result<()> {
            let schema = writer.add_schema(schema, "protobuf", &described)?;
            let id = writer.add_channel(schema, topic, "protobuf", notes)?;
            channels.push(Channel {
                id,
                kinds,
                written: 0,
            });
            Ok(())
        };
        for topic in Topic::ALL {
            let schema = protobuf::full_name(topic);
            add(&schema, topic.name(), &notes(topic), topic.kinds())?;
        }
        add(&protobuf::line_name(), "log", &BTreeMap::new(), Vec::new())?;
        Ok(Self { writer, channels })
    }

    fn write(&mut self, channel: usize, at_us: u64, data: &[u8]) -> Result<()> {
        let channel = &mut self.channels[channel];
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.written,
            log_time: at_us * 1_000,
            publish_time: at_us * 1_000,
        };
        channel.written += 1;
        Ok(self.writer.write_to_known_channel(&header, data)?)
    }
}

/// What a channel says of itself: its meaning, and the units of its fields.
fn notes(topic: Topic) -> BTreeMap<String, String> {
    let fields = topic.fields().into_iter();
    let with_units = fields.filter(|field| !field.unit.is_empty());
    let units = with_units.map(|field| (format!("unit.{}", field.name), field.unit.to_owned()));
    let meaning = ("meaning".to_owned(), topic.meaning().to_owned());
    units.chain([meaning]).collect()
}

impl LogFile for McapFile {
    fn row(&mut self, at_us: u64, topic: Topic, numbers: &[f32]) -> Result<()> {
        let channel = topic as usize;
        let data = protobuf::row(&self.channels[channel].kinds, numbers);
        self.write(channel, at_us, &data)
    }

    fn line(&mut self, at_us: u64, text: &str) -> Result<()> {
        self.write(Topic::ALL.len(), at_us, &protobuf::line(text))
    }

    fn flush(&mut self) -> Result<()> {
        Ok(self.writer.flush()?)
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().flush()?)
    }
}

//! Splits a ULog into messages and has them decoded one by one.
//!
//! `px4-ulog` trusts some lengths (a short subscription or parameter message
//! would panic) and follows nested formats without a bound; both are checked
//! here before a message reaches it.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;

use px4_ulog::stream_parser::{DataMessage, LogParser};

use super::super::error::{Fault, Location, quoted};
use super::table::{TOPICS, Table, Topic};

const HEADER_BYTES: usize = 16;
const PREFIX_BYTES: usize = 3;

/// Decodes the wanted topics of a whole log.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Table>, Fault> {
    let header = bytes.get(..HEADER_BYTES).ok_or_else(|| cut(0))?;
    let tables = RefCell::new(HashMap::<u16, Table>::new());
    let offset = Cell::new(0);
    let mut on_data = |message: &DataMessage| {
        if let Some(topic) = topic(message.flattened_format.message_name()) {
            tables
                .borrow_mut()
                .entry(message.msg_id)
                .or_insert_with(|| Table::new(topic, message))
                .push(offset.get(), message);
        }
    };
    let mut parser = LogParser::default();
    parser.set_data_message_callback(&mut on_data);
    feed(&mut parser, 0, header)?;
    let mut filter = Filter::default();
    let mut messages = Messages::new(bytes);
    while let Some(message) = messages.next()? {
        offset.set(message.offset);
        if filter.wants(&message)? {
            feed(&mut parser, message.offset, message.bytes)?;
        }
        if message.kind == b'B' {
            messages.end_first_section_at(parser.appended_offsets());
        }
    }
    drop(parser);
    let mut tables: Vec<(u16, Table)> = tables.into_inner().into_iter().collect();
    tables.sort_by_key(|(id, _)| *id);
    Ok(tables.into_iter().map(|(_, table)| table).collect())
}

/// A wanted topic by its name.
fn topic(name: &str) -> Option<&'static Topic> {
    TOPICS.iter().find(|topic| topic.name == name)
}

/// Hands bytes to the decoder.
fn feed(parser: &mut LogParser, offset: usize, bytes: &[u8]) -> Result<(), Fault> {
    parser.consume_bytes(bytes).map_err(|error| {
        let first_line = error.description.lines().next().unwrap_or_default();
        let reason: String = first_line.chars().take(120).collect();
        at(offset, format!("cannot be decoded: {reason}"))
    })
}

/// A fault at a byte offset.
fn at(offset: usize, reason: impl Into<String>) -> Fault {
    Fault::new(Location::Byte(offset as u64), reason)
}

/// The fault of a log that ends within a message.
fn cut(offset: usize) -> Fault {
    at(offset, "the log is cut off within a message")
}

/// One message with its prefix.
struct Message<'a> {
    offset: usize,
    kind: u8,
    bytes: &'a [u8],
}

impl<'a> Message<'a> {
    /// The bytes after the prefix.
    fn payload(&self) -> &'a [u8] {
        self.bytes.get(PREFIX_BYTES..).unwrap_or_default()
    }
}

/// Walks over the messages of a log.
struct Messages<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Where crash data was appended to a log that may end within a message.
    appended: Vec<usize>,
}

impl<'a> Messages<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            position: HEADER_BYTES,
            appended: Vec::new(),
        }
    }

    /// Takes in where appended data start; 0 means none.
    fn end_first_section_at(&mut self, offsets: &[u64; 3]) {
        self.appended = offsets
            .iter()
            .filter_map(|&offset| usize::try_from(offset).ok())
            .filter(|&offset| offset > self.position && offset < self.bytes.len())
            .collect();
        self.appended.sort_unstable();
    }

    /// The next message; `None` at the end of the log.
    fn next(&mut self) -> Result<Option<Message<'a>>, Fault> {
        loop {
            let offset = self.position;
            if offset == self.bytes.len() {
                return Ok(None);
            }
            let section_end = self.appended.first().copied();
            let end = self.end_of_message(offset);
            if let Some(section_end) = section_end
                && end.is_none_or(|end| end > section_end)
            {
                self.position = section_end;
                self.appended.remove(0);
                continue;
            }
            let end = end.ok_or_else(|| cut(offset))?;
            let bytes = self.bytes.get(offset..end).ok_or_else(|| cut(offset))?;
            self.position = end;
            let kind = bytes.get(2).copied().ok_or_else(|| cut(offset))?;
            return Ok(Some(Message {
                offset,
                kind,
                bytes,
            }));
        }
    }

    /// Where the message at an offset ends, if the log holds all of it.
    fn end_of_message(&self, offset: usize) -> Option<usize> {
        let size = self.bytes.get(offset..offset + 2)?;
        let size = usize::from(u16::from_le_bytes([size[0], size[1]]));
        let end = offset + PREFIX_BYTES + size;
        (end <= self.bytes.len()).then_some(end)
    }
}

/// Decides which messages the decoder gets to see.
#[derive(Default)]
struct Filter {
    /// Subscriptions, and whether their topic is wanted.
    subscribed: HashMap<u16, bool>,
}

impl Filter {
    /// True for messages of wanted topics and for all that are not about topics.
    fn wants(&mut self, message: &Message) -> Result<bool, Fault> {
        let payload = message.payload();
        let spoilt = |what: &str| at(message.offset, format!("{what} is too short"));
        match message.kind {
            b'F' => wants_format(message.offset, payload),
            b'A' => {
                let (Some(&[_, low, high]), Some(name)) = (payload.first_chunk(), payload.get(3..))
                else {
                    return Err(spoilt("a subscription"));
                };
                let wanted = std::str::from_utf8(name).is_ok_and(|name| topic(name).is_some());
                let id = u16::from_le_bytes([low, high]);
                self.subscribed.insert(id, wanted);
                Ok(wanted)
            }
            b'D' => {
                let &[low, high] = payload
                    .first_chunk()
                    .ok_or_else(|| spoilt("a data message"))?;
                let id = u16::from_le_bytes([low, high]);
                self.subscribed.get(&id).copied().ok_or_else(|| {
                    let reason = format!("data of the unknown subscription {id}");
                    at(message.offset, reason)
                })
            }
            b'P' => {
                let name = payload.first().map_or(1, |&length| usize::from(length));
                if payload.len() <= name {
                    return Err(spoilt("a parameter"));
                }
                Ok(true)
            }
            _ => Ok(true),
        }
    }
}

/// True for the format of a wanted topic.
fn wants_format(offset: usize, payload: &[u8]) -> Result<bool, Fault> {
    const PLAIN: [&str; 12] = [
        "int8_t", "uint8_t", "int16_t", "uint16_t", "int32_t", "uint32_t", "int64_t", "uint64_t",
        "float", "double", "bool", "char",
    ];
    let Ok(text) = std::str::from_utf8(payload) else {
        return Err(at(offset, "a format is not text"));
    };
    let Some((name, fields)) = text.split_once(':') else {
        return Err(at(
            offset,
            format!("a format has no name: {}", quoted(text)),
        ));
    };
    if topic(name).is_none() {
        return Ok(false);
    }
    for field in fields.split(';').filter(|field| !field.is_empty()) {
        let kind = field.split([' ', '[']).next().unwrap_or_default();
        if !PLAIN.contains(&kind) {
            let kind = quoted(kind);
            return Err(at(
                offset,
                format!("{name} has a field of unknown type {kind}"),
            ));
        }
    }
    Ok(true)
}

//! Splits a ULog into messages and has them decoded one by one.
//!
//! `px4-ulog` trusts some lengths (a short subscription would panic) and follows
//! nested formats without a bound; both are checked here before a message
//! reaches it. What is spoilt is skipped, and counted.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;

use px4_ulog::stream_parser::{DataMessage, LogParser};

use super::super::super::error::{Fault, Location};
use super::super::super::recording::Dropouts;
use super::super::super::skipped::Skipped;
use super::table::{TOPICS, Table, Topic};

const HEADER_BYTES: usize = 16;
const PREFIX_BYTES: usize = 3;
/// A message of flags that are all off.
const NO_FLAGS: [u8; 43] = {
    let mut message = [0; 43];
    message[0] = 40;
    message[2] = b'B';
    message
};

/// What a log holds of what a flight needs.
pub(super) struct Content {
    /// A table for each subscription with messages, in the order of their numbers.
    pub(super) tables: Vec<Table>,
    /// What the autopilot lost.
    pub(super) dropouts: Dropouts,
    /// Texts that the log has of itself, by their keys.
    pub(super) texts: HashMap<String, String>,
    pub(super) skipped: Skipped,
}

/// Decodes the wanted topics of a whole log.
///
/// # Errors
/// A log that needs a reader that does not exist yet, by its flags.
pub(super) fn read(bytes: &[u8]) -> Result<Content, Fault> {
    let header = bytes
        .get(..HEADER_BYTES)
        .ok_or_else(|| Fault::whole("is cut off within its header"))?;
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
    // A header of 16 bytes that begins as one is all that the decoder asks for, but for flags, which
    // logs before 2017 do not have.
    let _ = parser.consume_bytes(header);
    if bytes.get(HEADER_BYTES + 2) != Some(&b'B') {
        let _ = parser.consume_bytes(&NO_FLAGS);
    }
    let mut log = Reading::default();
    let mut messages = Messages::new(bytes);
    while let Some(message) = messages.next(&mut log.skipped) {
        offset.set(message.offset);
        if !log.wants(&message) {
            continue;
        }
        let decoded = parser.consume_bytes(message.bytes);
        match message.kind {
            b'B' if decoded.is_err() && is_first(&message) => {
                let reason =
                    "needs a newer reader, by its incompatible flags: convert it with pyulog";
                return Err(Fault::new(message.place(), reason));
            }
            b'B' => messages.end_first_section_at(parser.appended_offsets()),
            _ => {}
        }
        if decoded.is_err() {
            log.skipped.add(message.place(), message.spoilt());
        }
    }
    drop(parser);
    let mut tables: Vec<(u16, Table)> = tables.into_inner().into_iter().collect();
    tables.sort_by_key(|(id, _)| *id);
    Ok(Content {
        tables: tables.into_iter().map(|(_, table)| table).collect(),
        dropouts: log.dropouts,
        texts: log.texts,
        skipped: log.skipped,
    })
}

/// True for the message behind the header, where flags belong.
fn is_first(message: &Message) -> bool {
    message.offset == HEADER_BYTES
}

/// A wanted topic by its name.
fn topic(name: &str) -> Option<&'static Topic> {
    TOPICS.iter().find(|topic| topic.name == name)
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

    fn place(&self) -> Location {
        Location::Byte(self.offset as u64)
    }

    /// What it is called where it cannot be used.
    fn spoilt(&self) -> &'static str {
        match self.kind {
            b'F' => "formats that cannot be read",
            b'A' => "subscriptions that cannot be read",
            b'D' => "data messages of the wrong length",
            _ => "messages that cannot be read",
        }
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
    fn next(&mut self, skipped: &mut Skipped) -> Option<Message<'a>> {
        loop {
            let offset = self.position;
            if offset == self.bytes.len() {
                return None;
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
            let Some(end) = end else {
                self.resume(skipped);
                continue;
            };
            self.position = end;
            return Some(Message {
                offset,
                kind: *self.bytes.get(offset + 2)?,
                bytes: self.bytes.get(offset..end)?,
            });
        }
    }

    /// Where the message at an offset ends, if one is there and the log holds all of it.
    fn end_of_message(&self, offset: usize) -> Option<usize> {
        const KINDS: &[u8] = b"BFIMPQADLCSOR";
        let prefix = self.bytes.get(offset..offset + PREFIX_BYTES)?;
        let size = usize::from(u16::from_le_bytes([prefix[0], prefix[1]]));
        let end = offset + PREFIX_BYTES + size;
        (size > 0 && KINDS.contains(&prefix[2]) && end <= self.bytes.len()).then_some(end)
    }

    /// Skips what is no message, to where several follow each other, or to the end.
    fn resume(&mut self, skipped: &mut Skipped) {
        const IN_A_ROW: usize = 3;
        let from = self.position;
        let is_message = |&offset: &usize| {
            let mut at = Some(offset);
            (0..IN_A_ROW).all(|_| match at {
                Some(place) if place < self.bytes.len() => {
                    at = self.end_of_message(place);
                    at.is_some()
                }
                Some(_) => true,
                None => false,
            })
        };
        let end = self.bytes.len();
        self.position = (from + 1..end).find(is_message).unwrap_or(end);
        let garbage = self.bytes.get(from..self.position).unwrap_or_default();
        let what = match garbage {
            zeros if zeros.iter().all(|&byte| byte == 0) => "bytes of zeros",
            _ if self.position == end => "bytes behind the last whole message",
            _ => "bytes of garbage",
        };
        let count = garbage.len() as u64;
        skipped.add_many(Location::Byte(from as u64), what, count);
    }
}

/// What is known of a log while it is read.
#[derive(Default)]
struct Reading {
    /// Subscriptions, and whether their topic is wanted.
    subscribed: HashMap<u16, bool>,
    dropouts: Dropouts,
    texts: HashMap<String, String>,
    skipped: Skipped,
}

impl Reading {
    /// True for what the decoder gets to see: flags, and all of wanted topics.
    fn wants(&mut self, message: &Message) -> bool {
        let payload = message.payload();
        match message.kind {
            b'B' => true,
            b'F' => match wants_format(payload) {
                Some(wanted) => wanted,
                None => self.skip(message, message.spoilt()),
            },
            b'A' => {
                let (Some(&[_, low, high]), Some(name)) = (payload.first_chunk(), payload.get(3..))
                else {
                    return self.skip(message, message.spoilt());
                };
                let wanted = std::str::from_utf8(name).is_ok_and(|name| topic(name).is_some());
                let id = u16::from_le_bytes([low, high]);
                if self.subscribed.contains_key(&id) {
                    return self.skip(message, "subscriptions that are there already");
                }
                self.subscribed.insert(id, wanted);
                wanted
            }
            b'D' => match payload.first_chunk() {
                None => self.skip(message, message.spoilt()),
                Some(id) => match self.subscribed.get(&u16::from_le_bytes(*id)) {
                    Some(&wanted) => wanted,
                    None => self.skip(message, "data messages of an unknown subscription"),
                },
            },
            b'O' => {
                if let Some(time_ms) = payload.first_chunk() {
                    self.dropouts.count += 1;
                    self.dropouts.lost_s += f64::from(u16::from_le_bytes(*time_ms)) * 1e-3;
                }
                false
            }
            b'I' => {
                self.texts.extend(text(payload));
                false
            }
            _ => false,
        }
    }

    fn skip(&mut self, message: &Message, what: &str) -> bool {
        self.skipped.add(message.place(), what);
        false
    }
}

/// Key and value of an information message that is text.
fn text(payload: &[u8]) -> Option<(String, String)> {
    let (&length, rest) = payload.split_first()?;
    let (key, value) = rest.split_at_checked(length.into())?;
    let key = std::str::from_utf8(key).ok()?;
    let (kind, name) = key.split_once(' ')?;
    let value = String::from_utf8_lossy(value);
    let value = value.trim_end_matches('\0').trim().to_owned();
    kind.starts_with("char").then(|| (name.to_owned(), value))
}

/// Whether a format is that of a wanted topic; `None` where it cannot be read.
fn wants_format(payload: &[u8]) -> Option<bool> {
    const PLAIN: [&str; 12] = [
        "int8_t", "uint8_t", "int16_t", "uint16_t", "int32_t", "uint32_t", "int64_t", "uint64_t",
        "float", "double", "bool", "char",
    ];
    let (name, fields) = std::str::from_utf8(payload).ok()?.split_once(':')?;
    if topic(name).is_none() {
        return Some(false);
    }
    let mut fields = fields.split(';').filter(|field| !field.is_empty());
    let is_plain = |field: &str| {
        let kind = field.split([' ', '[']).next().unwrap_or_default();
        PLAIN.contains(&kind)
    };
    fields.all(is_plain).then_some(true)
}

//! Splits a DataFlash log into messages, whose layout the log itself gives.

use std::collections::HashMap;
use std::sync::Arc;

use ardupilot_binlog::{FieldValue, MessageFormat};

use super::super::super::error::Location;

/// How each message begins, before the number of its kind.
const MAGIC: [u8; 2] = [0xa3, 0x95];
/// The number of messages that give the layout of others.
const FORMAT: u8 = 0x80;
/// How long they are, and where their parts end.
const FORMAT_BYTES: usize = 89;
const PREFIX_BYTES: usize = 3;
/// Other bytes may stand before the first message, as in a dump of a chip.
const SOUGHT_BYTES: usize = 4096;

/// True where the log gives a layout near its start.
pub(super) fn begins(bytes: &[u8]) -> bool {
    let sought = &bytes[..bytes.len().min(SOUGHT_BYTES)];
    sought
        .windows(PREFIX_BYTES)
        .any(|window| window == [MAGIC[0], MAGIC[1], FORMAT])
}

/// A message as it is laid out.
pub(super) struct Message<'a> {
    pub(super) place: Location,
    format: &'a MessageFormat,
    payload: &'a [u8],
}

impl<'a> Message<'a> {
    /// Its name, without the number of an instance.
    pub(super) fn name(&self) -> &'a str {
        &self.format.name
    }

    /// Its fields; none where one is of an unknown type.
    pub(super) fn fields(&self) -> Fields<'a> {
        Fields {
            labels: &self.format.labels,
            values: self.format.decode_fields(self.payload).unwrap_or_default(),
        }
    }
}

/// The values of a message.
pub(super) struct Fields<'a> {
    labels: &'a [String],
    values: Vec<FieldValue>,
}

impl Fields<'_> {
    fn value(&self, name: &str) -> Option<&FieldValue> {
        let at = self.labels.iter().position(|label| label == name)?;
        self.values.get(at)
    }

    /// A number.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.value(name)?.as_f64()
    }

    /// A text.
    pub(super) fn text(&self, name: &str) -> Option<&str> {
        self.value(name)?.as_str()
    }

    /// Several numbers.
    pub(super) fn numbers<const N: usize>(&self, names: [&str; N]) -> Option<[f64; N]> {
        let found = names.map(|name| self.number(name));
        let complete = found.iter().all(Option::is_some);
        complete.then(|| found.map(Option::unwrap_or_default))
    }

    /// The time, us, in logs of either age.
    pub(super) fn time_us(&self) -> Option<f64> {
        let us = self.number("TimeUS");
        us.or_else(|| Some(self.number("TimeMS").or_else(|| self.number("T"))? * 1e3))
    }
}

/// Who makes something of messages.
pub(super) trait Reader {
    fn take(&mut self, message: &Message);
    /// Bytes that are no message.
    fn skip(&mut self, place: Location, what: &str, count: u64);
}

/// Hands every message that can be read to a reader, which counts the rest.
pub(super) fn read(bytes: &[u8], flight: &mut impl Reader) {
    let mut formats = HashMap::new();
    let mut position = 0;
    // The first message, and the one behind garbage, must have another behind it.
    let mut is_doubted = true;
    let mut garbage_from = None;
    while position < bytes.len() {
        match message_at(bytes, position, &formats, is_doubted) {
            Some((kind, length)) => {
                count_garbage(bytes, garbage_from.take(), position, flight);
                let payload = &bytes[position + PREFIX_BYTES..position + length];
                if kind == FORMAT {
                    learn(payload, &mut formats);
                } else if let Some(format) = formats.get(&kind) {
                    let place = Location::Byte(position as u64);
                    flight.take(&Message {
                        place,
                        format,
                        payload,
                    });
                }
                position += length;
                is_doubted = false;
            }
            None => {
                garbage_from.get_or_insert(position);
                is_doubted = true;
                position += 1;
            }
        }
    }
    count_garbage(bytes, garbage_from, bytes.len(), flight);
}

fn count_garbage(bytes: &[u8], from: Option<usize>, to: usize, flight: &mut impl Reader) {
    let Some(from) = from else { return };
    let garbage = &bytes[from..to];
    let what = match garbage {
        blank if blank.iter().all(|byte| matches!(byte, 0 | 0xff)) => "bytes of erased memory",
        _ if to == bytes.len() => "bytes behind the last whole message",
        _ => "bytes of garbage",
    };
    let place = Location::Byte(from as u64);
    flight.skip(place, what, garbage.len() as u64);
}

/// Kind and length of the message at a position, if one is there and the log holds all of it.
fn message_at(
    bytes: &[u8],
    at: usize,
    formats: &HashMap<u8, MessageFormat>,
    is_doubted: bool,
) -> Option<(u8, usize)> {
    let kind = match bytes.get(at..at + PREFIX_BYTES)? {
        [first, second, kind] if [*first, *second] == MAGIC => *kind,
        _ => return None,
    };
    let length = match kind {
        FORMAT => FORMAT_BYTES,
        _ => usize::from(formats.get(&kind)?.msg_len),
    };
    let behind = bytes.get(at + length..)?;
    let is_message = !is_doubted || behind.is_empty() || behind.starts_with(&MAGIC);
    is_message.then_some((kind, length))
}

/// Takes in how messages of a kind are laid out, unless the lengths contradict each other.
fn learn(payload: &[u8], formats: &mut HashMap<u8, MessageFormat>) {
    let text = |from: usize, to: usize| {
        let field = payload.get(from..to).unwrap_or_default();
        let end = field
            .iter()
            .position(|&byte| byte == 0)
            .unwrap_or(field.len());
        String::from_utf8_lossy(&field[..end]).trim().to_owned()
    };
    let [kind, length, ..] = *payload else { return };
    let labels: Arc<[String]> = text(22, 86).split(',').map(str::to_owned).collect();
    let format = MessageFormat {
        msg_type: kind,
        msg_len: length,
        name: text(2, 6),
        format: text(6, 22),
        labels,
    };
    if kind != FORMAT && format.payload_size() + PREFIX_BYTES == usize::from(length) {
        formats.insert(kind, format);
    }
}

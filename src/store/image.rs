//! What is stored, as bytes: head, key, parameters, CRC-32 of all before it.
//!
//! Little-endian. Head and sum stay where they are in every version, so that each knows the others'.

use heapless::Vec;
use reflex_settings::bytes::{CHECKSUM, put, take};

use super::{Content, SLOT};
use crate::link::SigningKey;
use crate::settings::Parameter;

const MAGIC: [u8; 4] = *b"RFST";
/// Grows with every change of what follows the head.
const VERSION: u16 = 1;
/// Magic, version, length, sequence number.
const HEAD: usize = 12;
/// Number and word.
const PARAMETER: usize = 8;
const SUM: usize = 4;

/// What was read.
pub(super) struct Image {
    /// Each save has the next one.
    pub sequence: u32,
    pub content: Content,
}

/// Why bytes are no image of ours.
pub(super) enum Unread {
    /// An image of another version.
    OtherVersion,
    /// Cut off, damaged, or something else.
    Spoilt,
}

/// The bytes of an image, where they fit into a slot.
pub(super) fn write(content: &Content, sequence: u32) -> Option<Vec<u8, SLOT>> {
    let key = content.key.as_ref().map(SigningKey::to_bytes);
    let key = key.as_ref().map_or(&[][..], |key| key);
    let length = HEAD + 1 + key.len() + PARAMETER * content.parameters.len() + SUM;
    let mut image = Vec::new();
    put(&mut image, &MAGIC);
    put(&mut image, &VERSION.to_le_bytes());
    put(&mut image, &(length as u16).to_le_bytes());
    put(&mut image, &sequence.to_le_bytes());
    put(&mut image, &[u8::from(!key.is_empty())]);
    put(&mut image, key);
    for Parameter { number, word } in &content.parameters {
        put(&mut image, &number.to_le_bytes());
        put(&mut image, word);
    }
    let sum = CHECKSUM.checksum(&image);
    put(&mut image, &sum.to_le_bytes());
    (image.len() == length).then_some(image)
}

/// Reads a slot.
pub(super) fn read(slot: &[u8; SLOT]) -> Result<Image, Unread> {
    parse(slot).unwrap_or(Err(Unread::Spoilt))
}

/// `None` where bytes are missing or mean nothing.
fn parse(slot: &[u8; SLOT]) -> Option<Result<Image, Unread>> {
    let mut rest = slot.as_slice();
    let magic: [u8; 4] = take(&mut rest)?;
    let version = u16::from_le_bytes(take(&mut rest)?);
    let length = u16::from_le_bytes(take(&mut rest)?);
    let sequence = u32::from_le_bytes(take(&mut rest)?);
    let image = slot.get(..usize::from(length))?;
    let (summed, sum) = image.split_last_chunk::<SUM>()?;
    if magic != MAGIC || CHECKSUM.checksum(summed).to_le_bytes() != *sum {
        return None;
    }
    if version != VERSION {
        return Some(Err(Unread::OtherVersion));
    }
    let mut fields = summed.get(HEAD..)?;
    let mut content = Content::default();
    if take(&mut fields)? != [0] {
        content.key = Some(SigningKey::from_bytes(take(&mut fields)?)?);
    }
    while let Some(number) = take(&mut fields) {
        let (number, word) = (u32::from_le_bytes(number), take(&mut fields)?);
        content.set(Parameter { number, word }).ok()?;
    }
    let image = Image { sequence, content };
    fields.is_empty().then_some(Ok(image))
}

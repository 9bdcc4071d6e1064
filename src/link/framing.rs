//! Where a frame begins and ends, and whether its checksum holds.
//!
//! A frame of the messages used whose checksum fails is searched again from its second byte,
//! so that a truncated frame does not take the next one with it. Frames of other kinds have no
//! checksum that could be verified; they are skipped by their length and never searched,
//! because their payload may quote frames that were not meant for us. The price: a frame cut
//! short within its header may take the next one with it, like noise that looks like a start.
//! Setpoints follow one another, and commands are repeated until they are answered.

use super::peers::Peer;
use super::signing::SIGNATURE;
use crate::time::Instant;
use mavlink::calculate_crc;
use mavlink::consts::v2::IFLAG_SIGNED;
use mavlink::dialects::common::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, ODOMETRY_DATA, SET_ATTITUDE_TARGET_DATA,
    SET_POSITION_TARGET_LOCAL_NED_DATA, SETUP_SIGNING_DATA,
};
use mavlink::{MAV_STX, MAV_STX_V2, MessageData};

/// Bytes that tell how long a frame is: its mark, the payload's length, flags.
const START: usize = 3;

/// Bytes of a MAVLink 1 frame beside its payload.
const OVERHEAD_1: usize = 8;

/// Bytes of a MAVLink 2 frame beside its payload and signature.
const OVERHEAD_2: usize = 12;

/// Longest frame: 255 bytes of payload, signed.
pub(super) const LONGEST_FRAME: usize = OVERHEAD_2 + 255 + SIGNATURE;

/// A frame as it was sent.
#[derive(Clone, Copy)]
pub(super) struct RawFrame<'a> {
    pub from: Peer,
    pub sequence: u8,
    pub id: u32,
    pub payload: &'a [u8],
    /// From the mark to the checksum: what a signature is of.
    pub signed: &'a [u8],
    /// Link, stamp and hash; empty where there is none.
    pub signature: &'a [u8],
}

/// What the bytes held so far begin with.
pub(super) enum Candidate<'a> {
    /// A frame that may be sound; nothing more can be said before so many bytes are held.
    Incomplete(usize),
    /// A frame of a message used, checksum verified, of so many bytes.
    Sound(RawFrame<'a>, usize),
    /// A frame of a message not used, unverified, of so many bytes.
    Unknown(RawFrame<'a>, usize),
    /// A MAVLink 1 frame of so many bytes.
    Version1(usize),
    /// No start of a frame.
    Garbage,
    /// A start of a frame with flags that change the layout in ways not known here.
    BadFlags,
    /// A frame of a message used with a wrong checksum.
    BadChecksum,
}

/// Judges the bytes held so far.
pub(super) fn examine(held: &[u8]) -> Candidate<'_> {
    match *held {
        [MAV_STX, length, _, ..] => {
            let total = OVERHEAD_1 + usize::from(length);
            if held.len() < total {
                return Candidate::Incomplete(total);
            }
            Candidate::Version1(total)
        }
        [MAV_STX_V2, _, flags, ..] if flags & !IFLAG_SIGNED != 0 => Candidate::BadFlags,
        [MAV_STX_V2, length, flags, ..] => {
            let signature = if flags == 0 { 0 } else { SIGNATURE };
            let total = OVERHEAD_2 + usize::from(length) + signature;
            examine_complete(held, length.into(), total).unwrap_or(Candidate::Incomplete(total))
        }
        [] | [MAV_STX | MAV_STX_V2, ..] => Candidate::Incomplete(START),
        _ => Candidate::Garbage,
    }
}

/// Judges a MAVLink 2 frame of `total` bytes; `None` where it is not complete.
fn examine_complete(held: &[u8], length: usize, total: usize) -> Option<Candidate<'_>> {
    let (signed, signature) = held.get(..total)?.split_at_checked(OVERHEAD_2 + length)?;
    let (header, rest) = signed.split_first_chunk::<10>()?;
    let (payload, rest) = rest.split_at_checked(length)?;
    let sent = u16::from_le_bytes(*rest.first_chunk()?);
    let [_, _, _, _, sequence, system, component, id @ ..] = *header;
    let [low, middle, high] = id;
    let frame = RawFrame {
        from: Peer { system, component },
        sequence,
        id: u32::from_le_bytes([low, middle, high, 0]),
        payload,
        signed,
        signature,
    };
    let Some(extra) = checksum_extra(frame.id) else {
        return Some(Candidate::Unknown(frame, total));
    };
    let sums = signed.get(1..header.len() + length)?;
    Some(if calculate_crc(sums, extra) == sent {
        Candidate::Sound(frame, total)
    } else {
        Candidate::BadChecksum
    })
}

/// The byte that ties a checksum to a message's layout; `None` for messages not used.
fn checksum_extra(id: u32) -> Option<u8> {
    match id {
        HEARTBEAT_DATA::ID => Some(HEARTBEAT_DATA::EXTRA_CRC),
        SET_ATTITUDE_TARGET_DATA::ID => Some(SET_ATTITUDE_TARGET_DATA::EXTRA_CRC),
        SET_POSITION_TARGET_LOCAL_NED_DATA::ID => {
            Some(SET_POSITION_TARGET_LOCAL_NED_DATA::EXTRA_CRC)
        }
        COMMAND_INT_DATA::ID => Some(COMMAND_INT_DATA::EXTRA_CRC),
        COMMAND_LONG_DATA::ID => Some(COMMAND_LONG_DATA::EXTRA_CRC),
        SETUP_SIGNING_DATA::ID => Some(SETUP_SIGNING_DATA::EXTRA_CRC),
        ODOMETRY_DATA::ID => Some(ODOMETRY_DATA::EXTRA_CRC),
        _ => None,
    }
}

/// The bytes of one unfinished frame, and when the oldest of them arrived.
pub(super) struct Held {
    bytes: [u8; LONGEST_FRAME],
    length: usize,
    since: Instant,
}

impl Held {
    pub const fn new() -> Self {
        Self {
            bytes: [0; LONGEST_FRAME],
            length: 0,
            since: Instant::from_ticks(0),
        }
    }

    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }

    /// When the oldest byte arrived; `None` where nothing is held.
    pub fn since(&self) -> Option<Instant> {
        (self.length > 0).then_some(self.since)
    }

    /// Adds bytes until `wanted` are held, or all; those that are left. There is room: none but
    /// an incomplete frame wants more.
    pub fn fill<'a>(&mut self, at: Instant, bytes: &'a [u8], wanted: usize) -> &'a [u8] {
        if self.length == 0 {
            self.since = at;
        }
        let missing = wanted.saturating_sub(self.length);
        let (taken, left) = bytes.split_at_checked(missing).unwrap_or((bytes, &[]));
        let end = self.length + taken.len();
        if let Some(free) = self.bytes.get_mut(self.length..end) {
            free.copy_from_slice(taken);
            self.length = end;
        }
        left
    }

    /// Forgets the first `count` bytes.
    pub fn take(&mut self, count: usize) {
        let end = self.length.min(LONGEST_FRAME);
        let count = count.min(end);
        self.bytes.copy_within(count..end, 0);
        self.length = end - count;
    }

    /// Forgets the first byte and all up to the next start of a frame; how many they were.
    pub fn take_to_next_start(&mut self) -> usize {
        let next = self
            .as_slice()
            .iter()
            .skip(1)
            .position(|byte| matches!(*byte, MAV_STX | MAV_STX_V2));
        let count = next.map_or(self.length, |behind| behind + 1);
        self.take(count);
        count
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.length = 0;
    }
}

//! Garbage on the link: random bytes, and the dearest frames that were found.

use core::hint::black_box;

use mavlink::calculate_crc;
use oorandom::Rand32;
use reflex::link::{Parser, SigningKey};
use reflex::time::{Instant, at_micros, micros};
use reflex_bench::marks::{measured, rounds};
use reflex_bench::{GARBAGE_BYTES, GARBAGE_CHUNK, Part};
use reflex_bench::{NESTED, NOISE, STARTS, WRONG_CHECKSUM, WRONG_SIGNATURE};

/// HEARTBEAT, SET_ATTITUDE_TARGET, COMMAND_LONG and ODOMETRY: number, checksum's extra byte and
/// payload, as short as it may be and still be for the drone.
const MESSAGES: [(u16, u8, usize); 4] = [(0, 50, 9), (82, 49, 38), (76, 152, 31), (331, 91, 232)];

/// Places in [`MESSAGES`].
const HEARTBEAT: usize = 0;
const COMMAND: usize = 2;

/// A start of an ODOMETRY as long as frames can be.
const HEADER: [u8; 10] = [0xFD, 255, 1, 0, 255, 190, 0, 0x4B, 1, 0];

pub fn measure() {
    let mut chance = Rand32::new(7);
    flood(NOISE, || chance.rand_u32() as u8);
    let mut chance = Rand32::new(8);
    flood(STARTS, || match chance.rand_range(0..4) {
        0 => 0xFD,
        1 => chance.rand_range(0..2) as u8,
        2 => 0xFE,
        _ => chance.rand_u32() as u8,
    });
    let mut stream = Stream::new(false);
    flood(WRONG_CHECKSUM, || stream.next());
    let mut stream = Stream::new(true);
    flood(WRONG_SIGNATURE, || stream.next());
    let mut bytes = HEADER.iter().cycle();
    flood(NESTED, || *bytes.next().unwrap_or(&0));
}

/// Feeds a parser with a key.
fn flood(part: Part, mut byte: impl FnMut() -> u8) {
    let mut parser = Parser::new();
    let mut at: Instant = at_micros(1_000_000);
    if let Some(key) = SigningKey::new([7; 32], 0) {
        parser.signing().set(at, key);
    }
    rounds(part, |_| {
        let mut bytes = [0; GARBAGE_BYTES];
        bytes.fill_with(&mut byte);
        at += micros(20_000);
        let (parser, bytes) = black_box((&mut parser, &bytes));
        let found = measured(|| {
            let chunks = bytes.chunks(GARBAGE_CHUNK);
            chunks.fold(0, |found, chunk| found + parser.feed(at, chunk).count())
        });
        assert!(found == 0);
    });
}

/// Frames one behind the other, signed or not, each of another message; nothing is right about
/// their last bytes.
struct Stream {
    frame: [u8; 280],
    length: usize,
    next: usize,
    number: u64,
    signed: bool,
}

impl Stream {
    fn new(signed: bool) -> Self {
        Self {
            frame: [0; 280],
            length: 0,
            next: 0,
            number: 0,
            signed,
        }
    }

    fn next(&mut self) -> u8 {
        if self.next >= self.length {
            self.begin();
        }
        let byte = self.frame[self.next];
        self.next += 1;
        byte
    }

    /// The shortest frame is the dearest by the byte: three of four are heartbeats or, signed,
    /// commands, since not every heartbeat's signature is looked at.
    fn begin(&mut self) {
        self.number += 1;
        let kind = if self.number.is_multiple_of(4) {
            (self.number / 4) as usize % MESSAGES.len()
        } else {
            if self.signed { COMMAND } else { HEARTBEAT }
        };
        let (id, extra, payload) = MESSAGES[kind];
        let end = 10 + payload;
        let [low, high] = id.to_le_bytes();
        let flags = u8::from(self.signed);
        let header = [0xFD, payload as u8, flags, 0, 0, 255, 190, low, high, 0];
        self.frame[..10].copy_from_slice(&header);
        self.frame[10..end].fill(1);
        let wrong = u16::from(!self.signed);
        let checksum = calculate_crc(&self.frame[1..end], extra) ^ wrong;
        self.frame[end..end + 2].copy_from_slice(&checksum.to_le_bytes());
        let stamp = self.number.to_le_bytes();
        // Link, stamp, hash.
        self.frame[end + 2] = 0;
        self.frame[end + 3..end + 9].copy_from_slice(&stamp[..6]);
        self.frame[end + 9..end + 15].fill(0);
        self.length = end + if self.signed { 15 } else { 2 };
        self.next = 0;
    }
}

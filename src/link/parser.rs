//! From bytes to messages: one buffer, one pass, everything refused is counted.

use super::admission::Admission;
use super::counters::{LinkCounters, count, count_many};
use super::framing::{Candidate, Held, LONGEST_FRAME, examine};
use super::signing::Signing;
use super::{Incoming, PATIENCE};
use crate::time::{Instant, span};

/// Bytes of checksums for each byte read. A sound line needs one, and pays less than it may.
const CHECKSUMS: usize = 4;

/// Checksums that may be owed at most: of some of the longest frames.
const MOST_PAID: usize = CHECKSUMS * LONGEST_FRAME;

/// Reads MAVLink 2 frames from a stream of bytes.
///
/// Holds at most one frame of 280 bytes, and looks at it only where another byte can tell
/// something new: once it is known to be one, and once it is complete. Each byte read pays for
/// checksums over `CHECKSUMS` bytes: where starts of frames lie within frames that prove wrong, over
/// and over, the next is skipped whole.
pub struct Parser {
    held: Held,
    /// Bytes that checksums may be computed of before more are read.
    paid: usize,
    admission: Admission,
    counters: LinkCounters,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// A parser that has read nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            held: Held::new(),
            paid: MOST_PAID,
            admission: Admission::new(),
            counters: LinkCounters::NONE,
        }
    }

    /// Reads bytes that arrived until `at`; yields what they bring.
    ///
    /// The bytes may begin and end anywhere in a frame. Run the iterator to its end: bytes
    /// that it has not reached when it is dropped are lost, as if the line had lost them.
    #[must_use = "nothing is read until the iterator is run to its end"]
    pub fn feed<'a>(&'a mut self, at: Instant, bytes: &'a [u8]) -> Feed<'a> {
        if self
            .held
            .since()
            .is_some_and(|since| span(since, at) > PATIENCE)
        {
            count(&mut self.counters.truncated);
            count_many(&mut self.counters.garbage_bytes, self.held.as_slice().len());
            self.held.clear();
        }
        Feed {
            parser: self,
            at,
            bytes,
        }
    }

    /// What frames are signed with.
    pub fn signing(&mut self) -> &mut Signing {
        &mut self.admission.signing
    }

    /// What has been read and refused since the start.
    #[must_use]
    pub fn counters(&self) -> LinkCounters {
        self.counters
    }

    /// Takes the next frame, or the next piece of garbage, off the bytes held.
    fn step(&mut self, at: Instant) -> Step {
        let counters = &mut self.counters;
        let (length, found) = match examine(self.held.as_slice(), self.paid) {
            Candidate::Incomplete(wanted) => return Step::Hungry(wanted),
            Candidate::Sound(frame, length) => {
                (length, self.admission.accept(at, &frame, counters))
            }
            Candidate::Unknown(frame, length) => {
                count(&mut counters.unknown_message);
                let lost = self.admission.sequences.pass(frame.from, frame.sequence);
                count_many(&mut counters.lost_sequence, lost.unwrap_or(0).into());
                (length, None)
            }
            Candidate::Version1(length) => {
                count(&mut counters.version_1);
                (length, None)
            }
            Candidate::Garbage => return self.resynchronise(),
            Candidate::BadFlags => {
                count(&mut counters.bad_flags);
                return self.resynchronise();
            }
            Candidate::BadChecksum(length) => {
                count(&mut counters.bad_checksum);
                self.paid = self.paid.saturating_sub(length);
                return self.resynchronise();
            }
            Candidate::Unpaid(length) => {
                count(&mut counters.bad_checksum);
                count_many(&mut counters.garbage_bytes, length);
                (length, None)
            }
        };
        self.held.take(length);
        found.map_or(Step::Nothing, Step::Found)
    }

    /// Takes note of bytes that were read.
    fn pay(&mut self, bytes: usize) {
        let earned = bytes.saturating_mul(CHECKSUMS);
        self.paid = self.paid.saturating_add(earned).min(MOST_PAID);
    }

    fn resynchronise(&mut self) -> Step {
        let skipped = self.held.take_to_next_start();
        count_many(&mut self.counters.garbage_bytes, skipped);
        Step::Nothing
    }
}

enum Step {
    /// The bytes held may be the beginning of a frame: so many are needed, more than there are.
    Hungry(usize),
    /// Some bytes are done with; there may be more to find in the rest.
    Nothing,
    Found(Incoming),
}

/// Reads the bytes given to [`Parser::feed`]; an iterator over what they bring.
pub struct Feed<'a> {
    parser: &'a mut Parser,
    at: Instant,
    bytes: &'a [u8],
}

impl Feed<'_> {
    /// What frames are signed with; answers are signed while more is read.
    pub fn signing(&mut self) -> &mut Signing {
        self.parser.signing()
    }
}

impl Iterator for Feed<'_> {
    type Item = Incoming;

    fn next(&mut self) -> Option<Incoming> {
        // Ends: a hungry step takes at least one byte of these, any other one off those held.
        loop {
            match self.parser.step(self.at) {
                Step::Found(incoming) => return Some(incoming),
                Step::Nothing => {}
                Step::Hungry(_) if self.bytes.is_empty() => return None,
                Step::Hungry(wanted) => {
                    let left = self.parser.held.fill(self.at, self.bytes, wanted);
                    self.parser.pay(self.bytes.len() - left.len());
                    self.bytes = left;
                }
            }
        }
    }
}

//! From bytes to messages: one buffer, one pass, everything refused is counted.

use super::counters::{LinkCounters, count, count_many};
use super::decode::{Decoded, decode};
use super::framing::{Candidate, Held, RawFrame, examine};
use super::peers::{Peer, Sequences};
use super::{Answer, COMPONENT, Message, PATIENCE, SYSTEM};
use crate::time::{Instant, span};

/// What a frame brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Incoming {
    /// A message for the autopilot.
    Message {
        /// Who sent it, and awaits the answer where the autopilot gives one.
        from: Peer,
        /// What it says.
        message: Message,
    },
    /// A command that cannot be done: to be answered, and of no concern to the autopilot.
    Refused {
        /// Who awaits the answer.
        from: Peer,
        /// The command's number (MAV_CMD).
        command: u16,
        /// What to answer.
        answer: Answer,
    },
}

/// Reads MAVLink 2 frames from a stream of bytes.
///
/// Holds at most one frame of 280 bytes, and looks at it only where another byte can tell
/// something new: once it is known to be one, and once it is complete. Should noise fill the
/// buffer with starts of frames, one byte may cost as many checksums as starts: a few ms at
/// 168 MHz, once.
pub struct Parser {
    held: Held,
    sequences: Sequences,
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
            sequences: Sequences::new(),
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

    /// What has been read and refused since the start.
    #[must_use]
    pub fn counters(&self) -> LinkCounters {
        self.counters
    }

    /// Takes the next frame, or the next piece of garbage, off the bytes held.
    fn step(&mut self) -> Step {
        let counters = &mut self.counters;
        let (length, found) = match examine(self.held.as_slice()) {
            Candidate::Incomplete(wanted) => return Step::Hungry(wanted),
            Candidate::Sound(frame, length) => {
                (length, accept(&frame, &mut self.sequences, counters))
            }
            Candidate::Unknown(frame, length) => {
                count(&mut counters.unknown_message);
                let lost = self.sequences.pass(frame.from, frame.sequence);
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
            Candidate::BadChecksum => {
                count(&mut counters.bad_checksum);
                return self.resynchronise();
            }
        };
        self.held.take(length);
        found.map_or(Step::Nothing, Step::Found)
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

/// Takes note of a frame whose checksum holds, and decodes it.
fn accept(
    frame: &RawFrame<'_>,
    sequences: &mut Sequences,
    counters: &mut LinkCounters,
) -> Option<Incoming> {
    let from = frame.from;
    count(&mut counters.frames);
    let ours = Peer {
        system: SYSTEM,
        component: COMPONENT,
    };
    if from == ours {
        count(&mut counters.not_for_us);
        return None;
    }
    let lost = sequences.follow(from, frame.sequence);
    count_many(&mut counters.lost_sequence, lost.into());
    match decode(frame) {
        Decoded::Message(message) => Some(Incoming::Message { from, message }),
        Decoded::RefusedCommand(command, answer) => {
            count(&mut counters.refused_value);
            Some(Incoming::Refused {
                from,
                command,
                answer,
            })
        }
        Decoded::Empty => {
            count(&mut counters.bad_length);
            None
        }
        Decoded::NotForUs => {
            count(&mut counters.not_for_us);
            None
        }
        Decoded::Refused => {
            count(&mut counters.refused_value);
            None
        }
    }
}

/// Reads the bytes given to [`Parser::feed`]; an iterator over what they bring.
pub struct Feed<'a> {
    parser: &'a mut Parser,
    at: Instant,
    bytes: &'a [u8],
}

impl Iterator for Feed<'_> {
    type Item = Incoming;

    fn next(&mut self) -> Option<Incoming> {
        // Ends: a hungry step takes at least one byte of these, any other one off those held.
        loop {
            match self.parser.step() {
                Step::Found(incoming) => return Some(incoming),
                Step::Nothing => {}
                Step::Hungry(_) if self.bytes.is_empty() => return None,
                Step::Hungry(wanted) => {
                    self.bytes = self.parser.held.fill(self.at, self.bytes, wanted);
                }
            }
        }
    }
}

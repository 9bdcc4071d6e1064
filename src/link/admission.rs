//! Which of the frames that are sound are obeyed: signature, address, role, values.

use super::counters::{LinkCounters, count, count_many};
use super::decode::{Decoded, decode};
use super::framing::RawFrame;
use super::peers::{Peer, Sequences};
use super::roles::Role;
use super::signing::{Doubt, Signing, SigningKey};
use super::{Answer, COMPONENT, Message, SYSTEM};
use crate::time::Instant;

/// The drone itself.
const OURS: Peer = Peer {
    system: SYSTEM,
    component: COMPONENT,
};

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
    /// A key to sign with from now on, if it may be set here and now.
    Key(SigningKey),
}

/// What is remembered of those who send.
pub(super) struct Admission {
    pub sequences: Sequences,
    pub signing: Signing,
    /// Who commands.
    pilot: Role,
    /// Who says where the drone is.
    tracker: Role,
}

impl Admission {
    pub const fn new() -> Self {
        Self {
            sequences: Sequences::new(),
            signing: Signing::new(),
            pilot: Role::FREE,
            tracker: Role::FREE,
        }
    }

    /// Judges a frame whose checksum holds; what it brings, where it is obeyed or owed an answer.
    pub fn accept(
        &mut self,
        at: Instant,
        frame: &RawFrame<'_>,
        counters: &mut LinkCounters,
    ) -> Option<Incoming> {
        let from = frame.from;
        count(&mut counters.frames);
        if from == OURS {
            count(&mut counters.not_for_us);
            return None;
        }
        if let Err(doubt) = self.signing.check(at, frame) {
            count(match doubt {
                Doubt::Unsigned => &mut counters.unsigned,
                Doubt::OldStamp | Doubt::NoRoom => &mut counters.old_stamp,
                Doubt::BadSignature => &mut counters.bad_signature,
            });
            return None;
        }
        let lost = self.sequences.follow(from, frame.sequence);
        count_many(&mut counters.lost_sequence, lost.into());
        self.pilot.hear(at, from);
        self.tracker.hear(at, from);
        match decode(frame) {
            Decoded::Message(message) if !self.is_allowed(at, from, &message) => {
                count(&mut counters.not_allowed);
                message.command().map(|command| Incoming::Refused {
                    from,
                    command,
                    answer: Answer::Denied,
                })
            }
            Decoded::Message(message) => Some(Incoming::Message { from, message }),
            Decoded::Key(_) if !self.pilot.claim(at, from) => {
                count(&mut counters.not_allowed);
                None
            }
            Decoded::Key(key) => Some(Incoming::Key(key)),
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

    /// True where the sender plays the part that a message belongs to.
    fn is_allowed(&mut self, at: Instant, from: Peer, message: &Message) -> bool {
        match message {
            Message::Heartbeat => true,
            Message::Setpoint(_) | Message::Goal(_) | Message::Arm(_) | Message::TestMotor(_) => {
                self.pilot.claim(at, from)
            }
            Message::Pose(_) => self.tracker.claim(at, from),
        }
    }
}

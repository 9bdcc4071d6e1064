//! Which of the frames that are sound are obeyed: signature, address, role, values.

use super::counters::{LinkCounters, count, count_many};
use super::decode::{Decoded, decode};
use super::framing::RawFrame;
use super::peers::{Peer, Sequences};
use super::roles::{Role, Seldom};
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
    keys: Seldom,
}

impl Admission {
    pub const fn new() -> Self {
        Self {
            sequences: Sequences::new(),
            signing: Signing::new(),
            pilot: Role::FREE,
            tracker: Role::FREE,
            keys: Seldom::NEVER,
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
        let lost = self.sequences.follow(from, frame.sequence);
        count_many(&mut counters.lost_sequence, lost.into());
        // Before the signature: the hash takes longest.
        let decoded = decode(frame);
        let refused = match decoded {
            Decoded::Empty => Some(&mut counters.bad_length),
            Decoded::NotForUs => Some(&mut counters.not_for_us),
            Decoded::Refused => Some(&mut counters.refused_value),
            _ => None,
        };
        if let Some(refused) = refused {
            count(refused);
            return None;
        }
        let heeded = !self.signing.is_on() || self.is_heeded(at, from, &decoded);
        if let Err(doubt) = self.signing.check(at, frame, heeded) {
            match doubt {
                Doubt::Unsigned => count(&mut counters.unsigned),
                Doubt::OldStamp | Doubt::NoRoom => count(&mut counters.old_stamp),
                Doubt::BadSignature => count(&mut counters.bad_signature),
                Doubt::Unheeded => {}
            }
            return None;
        }
        self.pilot.hear(at, from);
        self.tracker.hear(at, from);
        match decoded {
            Decoded::Message(message) if self.is_allowed(at, from, &message) => {
                Some(Incoming::Message { from, message })
            }
            Decoded::Key(key) if self.pilot.claim(at, from) => Some(Incoming::Key(key)),
            Decoded::RefusedCommand(command, answer) => {
                count(&mut counters.refused_value);
                Some(Incoming::Refused {
                    from,
                    command,
                    answer,
                })
            }
            other => {
                count(&mut counters.not_allowed);
                let Decoded::Message(message) = other else {
                    return None;
                };
                message.command().map(|command| Incoming::Refused {
                    from,
                    command,
                    answer: Answer::Denied,
                })
            }
        }
    }

    /// True where a frame may mean something, if its signature is right. What is short and comes
    /// seldom would else be the dearest flood.
    fn is_heeded(&mut self, at: Instant, from: Peer, decoded: &Decoded) -> bool {
        match decoded {
            Decoded::Message(Message::Heartbeat) => {
                self.pilot.listens(at, from) | self.tracker.listens(at, from)
            }
            Decoded::Key(_) => self.keys.is_due(at),
            _ => true,
        }
    }

    /// True where the sender plays the part that a message belongs to.
    fn is_allowed(&mut self, at: Instant, from: Peer, message: &Message) -> bool {
        match message {
            Message::Heartbeat => true,
            Message::Pose(_) => self.tracker.claim(at, from),
            Message::Setpoint(_)
            | Message::Goal(_)
            | Message::Arm(_)
            | Message::TestMotor(_)
            | Message::Calibrate(_)
            | Message::Store(_) => self.pilot.claim(at, from),
        }
    }
}

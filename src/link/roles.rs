//! Who may fly the drone, and who may say where it is.
//!
//! A role belongs to the first peer that plays it, until nothing was heard of that peer for
//! [`PILOT_TIMEOUT`]: two that command, or that see the drone at two places, would tear it apart.

use super::peers::Peer;
use crate::config::PILOT_TIMEOUT;
use crate::time::{Duration, Instant, micros, span};

/// Between two frames of a kind that comes seldom: of more that are forged no signature is computed.
const SELDOM: Duration = micros(200_000);

/// A part that one peer plays at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Role {
    /// Who plays it, and when something was heard of that peer last.
    holder: Option<(Peer, Instant)>,
    beats: Seldom,
}

impl Role {
    /// Nobody plays it yet.
    pub const FREE: Self = Self {
        holder: None,
        beats: Seldom::NEVER,
    };

    /// Takes note of a sign of life.
    pub fn hear(&mut self, at: Instant, from: Peer) {
        if let Some((holder, heard)) = &mut self.holder
            && *holder == from
        {
            *heard = at;
        }
    }

    /// True where it is this peer's, or free: then it becomes this peer's.
    pub fn claim(&mut self, at: Instant, from: Peer) -> bool {
        let free = self.is_open(at, from);
        if free {
            self.holder = Some((from, at));
        }
        free
    }

    /// True where a heartbeat of this peer may mean something, a few times a second at most.
    pub fn listens(&mut self, at: Instant, from: Peer) -> bool {
        self.is_open(at, from) && self.beats.is_due(at)
    }

    fn is_open(&self, at: Instant, from: Peer) -> bool {
        self.holder
            .is_none_or(|(holder, heard)| holder == from || span(heard, at) > PILOT_TIMEOUT)
    }
}

/// Lets something happen only seldom.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seldom(Option<Instant>);

impl Seldom {
    /// It has not happened yet.
    pub const NEVER: Self = Self(None);

    /// True where it may happen now: then it does.
    pub fn is_due(&mut self, at: Instant) -> bool {
        let due = self.0.is_none_or(|last| span(last, at) >= SELDOM);
        if due {
            self.0 = Some(at);
        }
        due
    }
}

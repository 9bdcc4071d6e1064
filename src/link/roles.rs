//! Who may fly the drone, and who may say where it is.
//!
//! A role belongs to the first peer that plays it, until nothing was heard of that peer for
//! [`PILOT_TIMEOUT`]: two that command, or that see the drone at two places, would tear it apart.

use super::peers::Peer;
use crate::config::PILOT_TIMEOUT;
use crate::time::{Instant, span};

/// A part that one peer plays at a time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Role {
    /// Who plays it, and when something was heard of that peer last.
    holder: Option<(Peer, Instant)>,
}

impl Role {
    /// Nobody plays it yet; `Default` for constants.
    pub const FREE: Self = Self { holder: None };

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
        let taken = self
            .holder
            .is_some_and(|(holder, heard)| holder != from && span(heard, at) <= PILOT_TIMEOUT);
        if !taken {
            self.holder = Some((from, at));
        }
        !taken
    }
}

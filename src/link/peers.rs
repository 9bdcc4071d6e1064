//! Who sends, and which of their frames never arrived.

use heapless::LinearMap;

/// How many senders are followed; frames of further ones are read all the same.
const FOLLOWED: usize = 4;

/// The sender of a frame, by its MAVLink address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Peer {
    /// System number: one per vehicle or ground station.
    pub system: u8,
    /// Component number within the system.
    pub component: u8,
}

/// The sequence number that each sender should use next.
pub(super) struct Sequences {
    expected: LinearMap<Peer, u8, FOLLOWED>,
}

impl Sequences {
    pub const fn new() -> Self {
        Self {
            expected: LinearMap::new(),
        }
    }

    /// Takes note of a frame whose checksum holds; the number of frames lost before it.
    pub fn follow(&mut self, from: Peer, sequence: u8) -> u8 {
        if let Some(lost) = self.pass(from, sequence) {
            return lost;
        }
        // A full table follows no more senders: only a statistic suffers.
        let _ = self.expected.insert(from, sequence.wrapping_add(1));
        0
    }

    /// Takes note of an unchecked frame if its sender is known; the number of frames lost.
    ///
    /// Frames of other kinds use up sequence numbers too, and noise must not make senders up.
    pub fn pass(&mut self, from: Peer, sequence: u8) -> Option<u8> {
        let expected = self.expected.get_mut(&from)?;
        let lost = sequence.wrapping_sub(*expected);
        *expected = sequence.wrapping_add(1);
        Some(lost)
    }
}

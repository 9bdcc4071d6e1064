//! The call log in memory: a ring that overwrites its oldest bytes.

use core::sync::atomic::{Ordering, compiler_fence};

use super::{Call, LONGEST_RECORD, Recorder, Stamped};
use crate::time::Instant;

/// Capacity of the ring in bytes, a power of two: over 20 ms of flight.
pub const RING_LENGTH: usize = 2048;

/// A ring of records, laid out for a reader that only has the memory.
///
/// `written` counts all bytes ever written and wraps at 2^32; a reader that is more than
/// [`RING_LENGTH`] behind has lost records.
#[derive(Debug)]
#[repr(C)]
pub struct CallRing {
    written: u32,
    /// The ring, and behind it room for the end of a record: each is encoded in one piece.
    bytes: [u8; RING_LENGTH + LONGEST_RECORD],
}

impl CallRing {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            written: 0,
            bytes: [0; RING_LENGTH + LONGEST_RECORD],
        }
    }
}

impl Default for CallRing {
    fn default() -> Self {
        Self::new()
    }
}

impl Recorder for CallRing {
    #[inline(always)]
    fn record(&mut self, at: Instant, call: &Call) {
        let start = self.written as usize % RING_LENGTH;
        let place = self.bytes.get_mut(start..).unwrap_or_default();
        let Some(place) = place.first_chunk_mut() else {
            return;
        };
        let length = Stamped { at, call: *call }.encode(place).len();
        if let Some((ring, behind)) = self.bytes.split_first_chunk_mut::<RING_LENGTH>() {
            let crossed = (start + length).saturating_sub(RING_LENGTH);
            for (place, byte) in ring.iter_mut().zip(behind.iter().take(crossed)) {
                *place = *byte;
            }
        }
        // A reader may look between any two instructions: it finds all that is counted.
        compiler_fence(Ordering::Release);
        self.written = self.written.wrapping_add(length as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::ImuReading;
    use crate::time::at_micros;

    #[test]
    fn records_that_cross_the_end_can_be_read_back() {
        let mut ring = CallRing::new();
        let reading = |at| ImuReading {
            temperature: f32::from(at),
            ..ImuReading::default()
        };
        for at in 0..1000_u16 {
            ring.record(at_micros(at.into()), &Call::Imu(reading(at)));
        }
        let length = 37;
        let last = ring.written as usize - length;
        let bytes: Vec<u8> = (last..last + length)
            .map(|place| ring.bytes[place % RING_LENGTH])
            .collect();
        let (record, consumed) = Stamped::decode(&bytes).expect("a whole record");
        assert_eq!(consumed, length);
        assert_eq!(record.at, at_micros(999));
        assert_eq!(record.call, Call::Imu(reading(999)));
    }
}

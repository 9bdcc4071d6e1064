//! The call log in memory: a ring that overwrites its oldest bytes.

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
    bytes: [u8; RING_LENGTH],
}

impl CallRing {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            written: 0,
            bytes: [0; RING_LENGTH],
        }
    }
}

impl Default for CallRing {
    fn default() -> Self {
        Self::new()
    }
}

impl Recorder for CallRing {
    fn record(&mut self, at: Instant, call: &Call) {
        let mut buffer = [0; LONGEST_RECORD];
        let record = Stamped { at, call: *call }.encode(&mut buffer);
        let start = self.written as usize % RING_LENGTH;
        let first = record.len().min(RING_LENGTH - start);
        let (front, back) = record.split_at(first);
        if let Some(place) = self.bytes.get_mut(start..start + front.len()) {
            place.copy_from_slice(front);
        }
        if let Some(place) = self.bytes.get_mut(..back.len()) {
            place.copy_from_slice(back);
        }
        self.written = self.written.wrapping_add(record.len() as u32);
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

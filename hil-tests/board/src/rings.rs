//! Readers of the two rings the firmware keeps in memory: calls and log.
//!
//! They need nothing but access to the target's memory, which an emulator and
//! a debug probe both have.

use super::fault::FaultKind;

/// Capacity of the call log, in bytes.
pub const CALLS_LENGTH: u32 = 2048;

/// RTT control block: id, two counts, then the descriptors of 24 bytes each.
const RTT_FIRST_CHANNEL: u32 = 24;
/// A ring larger than this is no ring yet: the memory is not initialised.
const RTT_LARGEST: u32 = 1 << 16;

/// The target's RAM, as a host reaches it.
pub trait TargetMemory {
    /// Fills `into` from `address`.
    fn read(&mut self, address: u32, into: &mut [u8]) -> Result<(), FaultKind>;
    /// Writes a word at `address`, a multiple of four.
    fn write_word(&mut self, address: u32, value: u32) -> Result<(), FaultKind>;

    /// The word at `address`.
    fn read_word(&mut self, address: u32) -> Result<u32, FaultKind> {
        let mut bytes = [0; 4];
        self.read(address, &mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }
}

/// Reader of the call log: an overwriting ring that counts what was written.
#[derive(Debug)]
pub struct CallLog {
    address: u32,
    seen: u32,
}

impl CallLog {
    /// A reader of the ring at `address`, which holds nothing yet.
    pub fn new(address: u32) -> Self {
        Self { address, seen: 0 }
    }

    /// The bytes written since the last call; an error when some are lost.
    pub fn read(&mut self, memory: &mut dyn TargetMemory) -> Result<Vec<u8>, FaultKind> {
        let written = memory.read_word(self.address)?;
        let new = written.wrapping_sub(self.seen);
        if new > CALLS_LENGTH {
            return Err(FaultKind::CallsLost {
                bytes: new - CALLS_LENGTH,
            });
        }
        let bytes = read_ring(
            memory,
            self.address + 4,
            CALLS_LENGTH,
            self.seen % CALLS_LENGTH,
            new,
        )?;
        self.seen = written;
        Ok(bytes)
    }
}

/// Reader of RTT up-channel 0, which carries the log.
#[derive(Debug)]
pub struct RttLog {
    channel: u32,
}

impl RttLog {
    /// A reader of the control block at `address`.
    pub fn new(address: u32) -> Self {
        Self {
            channel: address + RTT_FIRST_CHANNEL,
        }
    }

    /// Takes what the firmware has logged since the last call.
    pub fn read(&mut self, memory: &mut dyn TargetMemory) -> Result<Vec<u8>, FaultKind> {
        let [buffer, size, write, read] = [4, 8, 12, 16].map(|offset| self.channel + offset);
        let size = memory.read_word(size)?;
        let (from, to) = (memory.read_word(read)?, memory.read_word(write)?);
        if size == 0 || size > RTT_LARGEST || from >= size || to >= size || from == to {
            return Ok(Vec::new());
        }
        let new = (to + size - from) % size;
        let buffer = memory.read_word(buffer)?;
        let bytes = read_ring(memory, buffer, size, from, new)?;
        memory.write_word(read, to)?;
        Ok(bytes)
    }
}

fn read_ring(
    memory: &mut dyn TargetMemory,
    base: u32,
    length: u32,
    from: u32,
    count: u32,
) -> Result<Vec<u8>, FaultKind> {
    let mut bytes = vec![0; count as usize];
    let (front, back) = bytes.split_at_mut(count.min(length - from) as usize);
    memory.read(base + from, front)?;
    memory.read(base, back)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BASE: u32 = 0x2000_0000;

    struct Ram(Vec<u8>);

    impl TargetMemory for Ram {
        fn read(&mut self, address: u32, into: &mut [u8]) -> Result<(), FaultKind> {
            let at = (address - BASE) as usize;
            into.copy_from_slice(&self.0[at..at + into.len()]);
            Ok(())
        }
        fn write_word(&mut self, address: u32, value: u32) -> Result<(), FaultKind> {
            let at = (address - BASE) as usize;
            self.0[at..at + 4].copy_from_slice(&value.to_le_bytes());
            Ok(())
        }
    }

    #[test]
    fn the_call_log_is_read_across_its_end() {
        let mut ram = Ram(vec![0; 4 + CALLS_LENGTH as usize]);
        let mut log = CallLog::new(BASE);
        ram.write_word(BASE, 2047).unwrap();
        assert_eq!(log.read(&mut ram).unwrap().len(), 2047);
        ram.0[4 + 2047] = 7;
        ram.0[4] = 8;
        ram.write_word(BASE, 2049).unwrap();
        assert_eq!(log.read(&mut ram).unwrap(), [7, 8]);
        assert!(log.read(&mut ram).unwrap().is_empty());
    }

    #[test]
    fn an_overwritten_call_log_is_a_named_fault() {
        let mut ram = Ram(vec![0; 4 + CALLS_LENGTH as usize]);
        ram.write_word(BASE, CALLS_LENGTH + 3).unwrap();
        let lost = CallLog::new(BASE).read(&mut ram).unwrap_err();
        assert_eq!(lost, FaultKind::CallsLost { bytes: 3 });
    }

    #[test]
    fn the_log_is_taken_and_the_space_given_back() {
        let mut ram = Ram(vec![0; 256]);
        let mut log = RttLog::new(BASE);
        assert!(
            log.read(&mut ram).unwrap().is_empty(),
            "not initialised yet"
        );
        for (offset, value) in [(28, BASE + 128), (32, 16), (36, 2), (40, 14)] {
            ram.write_word(BASE + offset, value).unwrap();
        }
        ram.0[128..130].copy_from_slice(&[3, 4]);
        ram.0[142..144].copy_from_slice(&[1, 2]);
        assert_eq!(log.read(&mut ram).unwrap(), [1, 2, 3, 4]);
        assert_eq!(ram.read_word(BASE + 40).unwrap(), 2);
    }
}

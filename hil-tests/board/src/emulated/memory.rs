//! The emulated target's RAM, as the readers of its rings want it.

use std::ops::Range;

use rigless::emulator::Host;
use rigless::soc::Width;

use crate::rings::TargetMemory;
use crate::{FaultKind, StackUse};

/// What unused stack holds: no address, no small number, no text.
const PAINT: u32 = 0xC5AC_CE55;

/// A borrow of the emulator's memory between two instructions.
pub(super) struct Memory<'a>(pub(super) &'a mut dyn Host);

impl TargetMemory for Memory<'_> {
    fn read(&mut self, address: u32, into: &mut [u8]) -> Result<(), FaultKind> {
        let mut at = u64::from(address);
        for chunk in into.chunks_mut(8) {
            if chunk.len() == 8 {
                chunk.copy_from_slice(&self.load(at, Width::W64)?.to_le_bytes());
            } else {
                for (byte, at) in chunk.iter_mut().zip(at..) {
                    *byte = self.load(at, Width::W8)? as u8;
                }
            }
            at += chunk.len() as u64;
        }
        Ok(())
    }

    fn write_word(&mut self, address: u32, value: u32) -> Result<(), FaultKind> {
        self.store(u64::from(address), Width::W32, u64::from(value))
    }
}

impl Memory<'_> {
    fn load(&mut self, address: u64, width: Width) -> Result<u64, FaultKind> {
        let loaded = self.0.read(address, width);
        loaded.map_err(|error| FaultKind::Emulator(error.to_string()))
    }

    fn store(&mut self, address: u64, width: Width, value: u64) -> Result<(), FaultKind> {
        let stored = self.0.write(address, width, value);
        stored.map_err(|error| FaultKind::Emulator(error.to_string()))
    }

    /// Writes `bytes` at `address`.
    pub(super) fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), FaultKind> {
        let (doubles, rest) = bytes.as_chunks();
        let mut at = u64::from(address);
        for double in doubles {
            self.store(at, Width::W64, u64::from_le_bytes(*double))?;
            at += 8;
        }
        for (byte, at) in rest.iter().zip(at..) {
            self.store(at, Width::W8, u64::from(*byte))?;
        }
        Ok(())
    }

    /// Fills the stack's region, before its first use, with a known pattern.
    pub(super) fn paint(&mut self, stack: &Range<u32>) -> Result<(), FaultKind> {
        stack
            .clone()
            .step_by(4)
            .try_for_each(|at| self.write_word(at, PAINT))
    }

    /// Whether the stack has reached the lowest word of its region.
    pub(super) fn is_full(&mut self, stack: &Range<u32>) -> Result<bool, FaultKind> {
        Ok(self.read_word(stack.start)? != PAINT)
    }

    /// How deep the stack has ever been.
    pub(super) fn stack_use(&mut self, stack: &Range<u32>) -> Result<StackUse, FaultKind> {
        let mut lowest = stack.end;
        for at in stack.clone().step_by(4) {
            if self.read_word(at)? != PAINT {
                lowest = at;
                break;
            }
        }
        Ok(StackUse {
            used: stack.end - lowest,
            available: stack.end - stack.start,
        })
    }
}

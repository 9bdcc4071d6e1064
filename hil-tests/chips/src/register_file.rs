//! Registers as a master sees them: bytes with reset values and writable bits.

use std::marker::PhantomData;

/// What distinguishes one chip's registers from another's.
pub trait Map {
    /// The bits of an address that the chip decodes.
    const ADDRESSES: u8;

    /// Registers that are not zero after power-on: address and value.
    const AT_RESET: &'static [(u8, u8)];

    /// Bits a master can write; zero for what is read-only or reserved.
    fn writable(address: u8) -> u8;
}

/// The registers of a chip, or of one of its dies.
#[derive(Clone, Debug)]
pub struct RegisterFile<M> {
    bytes: [u8; 128],
    map: PhantomData<M>,
}

impl<M: Map> RegisterFile<M> {
    /// Values after power-on and after a reset.
    pub fn at_reset() -> Self {
        let mut file = Self {
            bytes: [0; 128],
            map: PhantomData,
        };
        for &(address, value) in M::AT_RESET {
            file.put(address, value);
        }
        file
    }

    /// The stored byte.
    pub fn get(&self, address: u8) -> u8 {
        self.bytes[usize::from(address & M::ADDRESSES)]
    }

    /// Stores a byte as the chip itself does, whatever a master may write.
    pub fn put(&mut self, address: u8, value: u8) {
        self.bytes[usize::from(address & M::ADDRESSES)] = value;
    }

    /// Stores what a master may change; the rest of the byte keeps its value.
    pub fn write(&mut self, address: u8, value: u8) {
        let mask = M::writable(address & M::ADDRESSES);
        self.put(address, (self.get(address) & !mask) | (value & mask));
    }

    /// Whether a bit is set.
    pub fn has(&self, address: u8, bit: u8) -> bool {
        self.get(address) & bit != 0
    }
}

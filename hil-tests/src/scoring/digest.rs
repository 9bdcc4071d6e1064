//! A fingerprint of all motor commands and their instants.

use sha2::{Digest, Sha256};

/// SHA-256 over all motor writes with their times, warm-up included.
///
/// Two replays of the same log agree in it exactly when they wrote the same values at the same
/// nanoseconds. Each write enters as its time (8 bytes), its number of channels (4 bytes) and
/// the value of each channel (4 bytes), little-endian, so that no two sequences of writes share
/// their bytes.
#[derive(Clone, Debug, Default)]
pub struct MotorDigest {
    hash: Sha256,
}

impl MotorDigest {
    /// An empty sequence of writes.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one write: its time in nanoseconds and every channel's value, first motor first.
    pub fn write<V: Copy + Into<u32>>(&mut self, at_ns: u64, channels: &[V]) {
        self.hash.update(at_ns.to_le_bytes());
        self.hash.update((channels.len() as u32).to_le_bytes());
        for value in channels {
            let value: u32 = (*value).into();
            self.hash.update(value.to_le_bytes());
        }
    }

    /// The digest of all writes so far, 64 lower-case hexadecimal digits.
    #[must_use]
    pub fn hex(&self) -> String {
        let bytes = self.hash.clone().finalize();
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

//! The firmware's call log, decoded as its bytes come.

use anyhow::{Result, bail};
use reflex::app::{DecodeError, Stamped};

/// Bytes of calls, of which the last one may be incomplete.
#[derive(Debug, Default)]
pub(crate) struct CallStream {
    undecoded: Vec<u8>,
    decoded: u64,
    broken: Option<u8>,
}

impl CallStream {
    /// Takes the next bytes; whole calls go to `calls`.
    pub(crate) fn feed(&mut self, bytes: &[u8], calls: &mut Vec<Stamped>) {
        self.undecoded.extend_from_slice(bytes);
        let mut taken = 0;
        while self.broken.is_none() {
            match Stamped::decode(&self.undecoded[taken..]) {
                Ok((stamped, length)) => {
                    calls.push(stamped);
                    self.decoded += 1;
                    taken += length;
                }
                Err(DecodeError::Incomplete) => break,
                Err(DecodeError::Unknown(number)) => self.broken = Some(number),
            }
        }
        self.undecoded.drain(..taken);
    }

    /// Fails where the bytes were not what the firmware's library writes.
    pub(crate) fn check(&self) -> Result<()> {
        match self.broken {
            None => Ok(()),
            Some(number) => bail!(
                "the firmware's call log cannot be read: unknown number {number} behind {} calls",
                self.decoded
            ),
        }
    }
}

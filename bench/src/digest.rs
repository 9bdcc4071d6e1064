//! A fingerprint of motor commands, the same on the host and on the core.

use reflex::airframe::MotorShares;

/// FNV-1a over the bits of every share, a word at a time.
///
/// Each word is taken in by a bijection of what came before: commands that differ once have
/// different digests at that step, and until a later difference, by a chance of 2^-64, undoes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommandDigest(u64);

impl CommandDigest {
    /// Of no command yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    /// Takes the next command in, first motor first.
    pub fn add(&mut self, command: MotorShares) {
        for share in command.iter() {
            let word = u64::from(share.to_bits());
            self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }

    /// Of all commands so far.
    #[must_use]
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Default for CommandDigest {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digest(commands: &[MotorShares]) -> u64 {
        let mut digest = CommandDigest::new();
        for command in commands {
            digest.add(*command);
        }
        digest.value()
    }

    #[test]
    fn one_bit_and_one_swap_make_another_digest() {
        let mut other = MotorShares::all(0.5, 4);
        other[0] = 0.5_f32.next_up();
        let command = MotorShares::all(0.5, 4);
        assert_ne!(digest(&[command]), digest(&[other]));
        assert_ne!(digest(&[command, other]), digest(&[other, command]));
        assert_ne!(digest(&[command]), digest(&[command, command]));
        assert_ne!(
            digest(&[MotorShares::all(0.0, 4)]),
            digest(&[MotorShares::all(-0.0, 4)])
        );
    }
}

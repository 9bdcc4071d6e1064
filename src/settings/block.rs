//! The bytes of the settings block.
//!
//! Little-endian: magic `RFLX`, version, length, the fields in the order of [`Settings`],
//! CRC-32 of all before it. A change of the fields raises the version.

use super::{Feedback, MotorProtocol, Pairs, Policy, Reference, Settings, SettingsError, WarmUp};
use crate::sensors::Inputs;
use crate::time::micros;

const MAGIC: [u8; 4] = *b"RFLX";
const VERSION: u16 = 3;
const CHECKSUM: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Length of the whole block in bytes.
pub const BLOCK_LENGTH: usize = 48;

/// Why a block is not settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum BlockError {
    /// No block is there: the magic is missing.
    Absent,
    /// The block is of another version or length.
    Version,
    /// The checksum does not match.
    Checksum,
    /// A choice has a number that means nothing.
    Choice,
    /// A field is out of its range.
    Range(SettingsError),
}

impl Settings {
    /// The block that [`Settings::from_bytes`] reads.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; BLOCK_LENGTH] {
        let (policy, period) = match self.policy {
            Policy::Reactive => (0, 0),
            Policy::Periodic(period) => (1, period.ticks() as u32),
        };
        let (warm_up, length) = match self.warm_up {
            WarmUp::Automatic => (0, 0),
            WarmUp::Fixed(length) => (1, length.ticks() as u32),
        };
        let choices = [
            policy,
            match self.reference {
                Reference::PreviousSample => 0,
                Reference::LastRun => 1,
            },
            warm_up,
            match self.motors {
                MotorProtocol::OneShot125 => 0,
                MotorProtocol::Pwm => 1,
            },
        ];
        let mut bytes = [0; BLOCK_LENGTH];
        let mut writer = Writer {
            bytes: &mut bytes,
            at: 0,
        };
        writer.put(MAGIC);
        writer.put(VERSION.to_le_bytes());
        writer.put((BLOCK_LENGTH as u16).to_le_bytes());
        writer.put(choices);
        writer.put(period.to_le_bytes());
        writer.put(self.p_run.to_le_bytes());
        writer.put(length.to_le_bytes());
        writer.put((self.warm_up_period.ticks() as u32).to_le_bytes());
        writer.put((self.failsafe.ticks() as u32).to_le_bytes());
        writer.put(self.quantum.to_le_bytes());
        writer.put(self.seed.to_le_bytes());
        writer.put([
            self.triggers.bits(),
            match self.pairs {
                Pairs::FirstCrossings => 0,
                Pairs::WeightedLags => 1,
                Pairs::Published => 2,
            },
            match self.feedback {
                Feedback::Every => 0,
                Feedback::Published => 1,
            },
            0,
        ]);
        let checksum = CHECKSUM.checksum(writer.written());
        writer.put(checksum.to_le_bytes());
        bytes
    }

    /// Reads a block.
    ///
    /// # Errors
    /// Why it is not a block of valid settings; nothing of a wrong block is used.
    pub fn from_bytes(bytes: &[u8; BLOCK_LENGTH]) -> Result<Self, BlockError> {
        let mut reader = Reader { bytes, at: 0 };
        if reader.take() != MAGIC {
            return Err(BlockError::Absent);
        }
        let version = u16::from_le_bytes(reader.take());
        let length = u16::from_le_bytes(reader.take());
        if version != VERSION || usize::from(length) != BLOCK_LENGTH {
            return Err(BlockError::Version);
        }
        let (content, checksum) = bytes.split_at(BLOCK_LENGTH - 4);
        if CHECKSUM.checksum(content).to_le_bytes() != checksum {
            return Err(BlockError::Checksum);
        }
        let settings = reader.fields().ok_or(BlockError::Choice)?;
        settings.validate().map_err(BlockError::Range)?;
        Ok(settings)
    }
}

struct Writer<'a> {
    bytes: &'a mut [u8; BLOCK_LENGTH],
    at: usize,
}

impl Writer<'_> {
    fn put<const N: usize>(&mut self, field: [u8; N]) {
        if let Some(place) = self.bytes.get_mut(self.at..self.at + N) {
            place.copy_from_slice(&field);
        }
        self.at += N;
    }

    fn written(&self) -> &[u8] {
        self.bytes.get(..self.at).unwrap_or_default()
    }
}

struct Reader<'a> {
    bytes: &'a [u8; BLOCK_LENGTH],
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut field = [0; N];
        if let Some(place) = self.bytes.get(self.at..self.at + N) {
            field.copy_from_slice(place);
        }
        self.at += N;
        field
    }

    fn fields(&mut self) -> Option<Settings> {
        let [policy, reference, warm_up, motors] = self.take();
        let period = u32::from_le_bytes(self.take());
        let p_run = f32::from_le_bytes(self.take());
        let length = u32::from_le_bytes(self.take());
        let warm_up_period = u32::from_le_bytes(self.take());
        let failsafe = u32::from_le_bytes(self.take());
        let quantum = f32::from_le_bytes(self.take());
        let seed = u32::from_le_bytes(self.take());
        let [triggers, pairs, feedback, _] = self.take();
        Some(Settings {
            policy: match policy {
                0 => Policy::Reactive,
                1 => Policy::Periodic(micros(u64::from(period))),
                _ => return None,
            },
            reference: match reference {
                0 => Reference::PreviousSample,
                1 => Reference::LastRun,
                _ => return None,
            },
            p_run,
            warm_up: match warm_up {
                0 => WarmUp::Automatic,
                1 => WarmUp::Fixed(micros(u64::from(length))),
                _ => return None,
            },
            warm_up_period: micros(u64::from(warm_up_period)),
            failsafe: micros(u64::from(failsafe)),
            quantum,
            motors: match motors {
                0 => MotorProtocol::OneShot125,
                1 => MotorProtocol::Pwm,
                _ => return None,
            },
            triggers: Inputs::from_bits(triggers),
            pairs: match pairs {
                0 => Pairs::FirstCrossings,
                1 => Pairs::WeightedLags,
                2 => Pairs::Published,
                _ => return None,
            },
            feedback: match feedback {
                0 => Feedback::Every,
                1 => Feedback::Published,
                _ => return None,
            },
            seed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::Input;
    use proptest::prelude::*;

    #[test]
    fn an_absent_block_is_told_from_a_broken_one() {
        assert_eq!(
            Settings::from_bytes(&[0; BLOCK_LENGTH]),
            Err(BlockError::Absent)
        );
        let mut bytes = Settings::default().to_bytes();
        bytes[20] ^= 1;
        assert_eq!(Settings::from_bytes(&bytes), Err(BlockError::Checksum));
    }

    #[test]
    fn a_block_with_a_field_out_of_range_is_refused() {
        let settings = Settings {
            p_run: 1.0,
            ..Settings::default()
        };
        assert_eq!(
            Settings::from_bytes(&settings.to_bytes()),
            Err(BlockError::Range(SettingsError::PRun))
        );
    }

    proptest! {
        #[test]
        fn what_was_written_is_read(
            p_run in 0.01f32..0.99, failsafe in 3_000u64..1_000_000, quantum in 0.001f32..0.5,
            seed: u32, period in prop::option::of(1_000u64..1_000_000),
            warm_up in prop::option::of(0u64..30_000_000), previous: bool, pwm: bool,
            warm_up_period in 1u64..100_000, triggers in 0u8..64, published: bool,
        ) {
            let settings = Settings {
                policy: period.map_or(Policy::Reactive, |period| Policy::Periodic(micros(period))),
                reference: if previous { Reference::PreviousSample } else { Reference::LastRun },
                p_run,
                warm_up: warm_up.map_or(WarmUp::Automatic, |length| WarmUp::Fixed(micros(length))),
                warm_up_period: micros(warm_up_period),
                failsafe: micros(failsafe),
                quantum,
                motors: if pwm { MotorProtocol::Pwm } else { MotorProtocol::OneShot125 },
                triggers: Inputs::from_bits(triggers).with(Input::Turned),
                pairs: if published { Pairs::Published } else { Pairs::WeightedLags },
                feedback: if published { Feedback::Published } else { Feedback::Every },
                seed,
            };
            prop_assert_eq!(Settings::from_bytes(&settings.to_bytes()), Ok(settings));
        }

        #[test]
        fn any_flipped_bit_is_noticed(byte in 0..BLOCK_LENGTH, bit in 0u32..8) {
            let mut bytes = Settings::default().to_bytes();
            bytes[byte] ^= 1u8 << bit;
            prop_assert!(Settings::from_bytes(&bytes).is_err());
        }
    }
}

//! The bytes of the settings block, with which a host or a bootloader sets options.
//!
//! Little-endian: magic `RFLX`, version, length, the fields in the order of their declaration,
//! four bytes each, CRC-32 of all before it. The version follows from the fields' names.

use crate::bytes::{Vec, put, take};
use crate::declare::Declared;
use crate::setting::{Limits, OutOfRange, Setting};
use crate::settings::Settings;

const MAGIC: [u8; 4] = *b"RFLX";
const CHECKSUM: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
const VERSION: u16 = version(Settings::SETTINGS);
const CHECKSUM_LENGTH: usize = 4;

/// Length of the whole block in bytes.
pub const BLOCK_LENGTH: usize = 8 + Settings::LENGTH + CHECKSUM_LENGTH;

/// A number that differs where names or order of the fields do.
const fn version(mut settings: &[Setting]) -> u16 {
    let mut digest = CHECKSUM.digest();
    while let [setting, rest @ ..] = settings {
        digest.update(setting.name.as_bytes());
        digest.update(b",");
        settings = rest;
    }
    digest.finalize() as u16
}

/// Why a block is not settings.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    Range(OutOfRange),
}

impl Settings {
    /// The block that [`Settings::from_bytes`] reads.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; BLOCK_LENGTH] {
        let mut bytes = Vec::<u8, BLOCK_LENGTH>::new();
        put(&mut bytes, &MAGIC);
        put(&mut bytes, &VERSION.to_le_bytes());
        put(&mut bytes, &(BLOCK_LENGTH as u16).to_le_bytes());
        self.write(&mut |field| put(&mut bytes, &field));
        let checksum = CHECKSUM.checksum(&bytes);
        put(&mut bytes, &checksum.to_le_bytes());
        bytes.into_array().unwrap_or([0; BLOCK_LENGTH])
    }

    /// Reads a block.
    ///
    /// # Errors
    /// Why it is not a block of valid settings; nothing of a wrong block is used.
    pub fn from_bytes(bytes: &[u8; BLOCK_LENGTH], limits: &Limits) -> Result<Self, BlockError> {
        let (mut content, checksum) = bytes.split_at(BLOCK_LENGTH - CHECKSUM_LENGTH);
        let expected = CHECKSUM.checksum(content);
        if take(&mut content) != Some(MAGIC) {
            return Err(BlockError::Absent);
        }
        let mut number = || take(&mut content).map(u16::from_le_bytes);
        if (number(), number()) != (Some(VERSION), Some(BLOCK_LENGTH as u16)) {
            return Err(BlockError::Version);
        }
        if expected.to_le_bytes() != checksum {
            return Err(BlockError::Checksum);
        }
        let settings = Self::read(&mut || take(&mut content)).ok_or(BlockError::Choice)?;
        settings.check(limits).map_err(BlockError::Range)?;
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Feedback, Input, Inputs, MotorProtocol, Pairs, Policy, Reference, WarmUp, micros};
    use proptest::prelude::*;

    const LIMITS: Limits = Limits {
        hyperperiod: micros(1000),
        longest_warm_up: micros(30_000_000),
        imu_rate_hz: 1000,
    };

    /// The settings of a configuration that is as it was shipped.
    fn shipped() -> Settings {
        Settings::collect(&mut |setting| match setting.kind {
            crate::Kind::Inputs => Some(crate::Value::Inputs(Inputs::ALL)),
            crate::Kind::Step { .. } => Some(crate::Value::Number(1.0 / 255.0)),
            _ => setting.parse(setting.default).ok(),
        })
        .expect("defaults")
    }

    fn read(bytes: &[u8; BLOCK_LENGTH]) -> Result<Settings, BlockError> {
        Settings::from_bytes(bytes, &LIMITS)
    }

    #[test]
    fn an_absent_block_is_told_from_a_broken_one() {
        assert_eq!(read(&[0; BLOCK_LENGTH]), Err(BlockError::Absent));
        let mut bytes = shipped().to_bytes();
        bytes[20] ^= 1;
        assert_eq!(read(&bytes), Err(BlockError::Checksum));
    }

    #[test]
    fn a_block_with_a_field_out_of_range_is_refused() {
        let settings = Settings {
            p_run: 1.0,
            ..shipped()
        };
        let refused = read(&settings.to_bytes());
        let Err(BlockError::Range(refused)) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(refused.setting.name, "p_run");
    }

    proptest! {
        #[test]
        fn what_was_written_is_read(
            p_run in 0.01f32..0.99, failsafe in 3_000u64..1_000_000, quantum in 0.001f32..0.5,
            seed: u32, period in prop::option::of(1_000u64..1_000_000),
            warm_up in prop::option::of(0u64..30_000_000), previous: bool, pwm: bool,
            warm_up_period in 1_000u64..100_000, triggers in 0u8..64, published: bool,
        ) {
            let settings = Settings {
                policy: if period.is_some() { Policy::Periodic } else { Policy::Reactive },
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
                ..shipped()
            };
            let settings = Settings {
                period: micros(period.unwrap_or(2_500)),
                ..settings
            };
            prop_assert_eq!(read(&settings.to_bytes()), Ok(settings));
        }

        #[test]
        fn any_flipped_bit_is_noticed(byte in 0..BLOCK_LENGTH, bit in 0u32..8) {
            let mut bytes = shipped().to_bytes();
            bytes[byte] ^= 1u8 << bit;
            prop_assert!(read(&bytes).is_err());
        }
    }
}

//! What a start is given, and the bytes by which a host or a bootloader gives it.
//!
//! Little-endian: magic `RFLX`, version, length; then four bytes for each field: settings in the
//! order of their declaration, airframe, gains in the order of their file; CRC-32 of all before
//! it. The version follows from the names of settings, control logic and gains.

use crate::airframe::{Airframe, AirframeError};
use crate::bytes::{CHECKSUM, Vec, put, take};
use crate::declare::Declared;
use crate::gains::Gains;
use crate::setting::{Limits, OutOfRange, Setting};
use crate::settings::Settings;

const MAGIC: [u8; 4] = *b"RFLX";
const HEAD_LENGTH: usize = 8;
const CHECKSUM_LENGTH: usize = 4;
/// No control logic has gains for a longer block.
pub(crate) const LONGEST: usize = 1024;

/// What a start of the firmware is given: nothing of it takes a build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<G> {
    /// When control runs, and how it learns when to.
    pub settings: Settings,
    /// Where the motors are.
    pub airframe: Airframe,
    /// The gains of the control logic that is built in.
    pub gains: G,
}

/// Why a block is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum BlockError {
    /// No block is there: the magic is missing.
    Absent,
    /// The block is of another version, length or control logic.
    Version,
    /// The checksum does not match.
    Checksum,
    /// A choice has a number that means nothing.
    Choice,
    /// A setting is out of its range.
    Range(OutOfRange),
    /// The airframe cannot fly.
    Airframe(AirframeError),
    /// The gain in this place of its file is out of its range.
    Gain(usize),
}

impl<G: Gains> Start<G> {
    /// Length of the whole block in bytes.
    pub const LENGTH: usize = HEAD_LENGTH
        + Settings::LENGTH
        + 4 * (Airframe::WORDS + G::DECLARED.words())
        + CHECKSUM_LENGTH;

    /// A number that differs where the names or the order of the fields do.
    const VERSION: u16 = {
        let logic = [Setting::of([G::DECLARED.logic, ""], crate::Kind::Flag, "")];
        let digest = CHECKSUM.digest();
        let digest = named(named(digest, Settings::SETTINGS), &logic);
        named(digest, G::DECLARED.gains).finalize() as u16
    };

    /// The block that [`Self::from_bytes`] reads.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8, LONGEST> {
        const { assert!(Self::LENGTH <= LONGEST) }
        let mut bytes = Vec::new();
        put(&mut bytes, &MAGIC);
        put(&mut bytes, &Self::VERSION.to_le_bytes());
        put(&mut bytes, &(Self::LENGTH as u16).to_le_bytes());
        self.write(&mut |word| put(&mut bytes, &word));
        let checksum = CHECKSUM.checksum(&bytes);
        put(&mut bytes, &checksum.to_le_bytes());
        bytes
    }

    /// Reads a block.
    ///
    /// # Errors
    /// Why the block is refused; nothing of a refused block is used.
    pub fn from_bytes(bytes: &[u8], limits: &Limits) -> Result<Self, BlockError> {
        let (mut content, checksum) = bytes
            .split_at_checked(Self::LENGTH - CHECKSUM_LENGTH)
            .ok_or(BlockError::Absent)?;
        let expected = CHECKSUM.checksum(content);
        if take(&mut content) != Some(MAGIC) {
            return Err(BlockError::Absent);
        }
        let mut number = || take(&mut content).map(u16::from_le_bytes);
        if (number(), number()) != (Some(Self::VERSION), Some(Self::LENGTH as u16)) {
            return Err(BlockError::Version);
        }
        if expected.to_le_bytes() != checksum {
            return Err(BlockError::Checksum);
        }
        Self::read(content, limits)
    }

    /// Hands every word on, in the order of the declarations.
    pub(crate) fn write(&self, put: &mut dyn FnMut([u8; 4])) {
        self.settings.write(put);
        self.airframe.write(put);
        self.gains.write(put);
    }

    /// Reads what [`Self::write`] wrote, and checks it.
    #[inline(never)]
    pub(crate) fn read(mut words: &[u8], limits: &Limits) -> Result<Self, BlockError> {
        let word = &mut || take(&mut words);
        let settings = Settings::read(word).ok_or(BlockError::Choice)?;
        let airframe = Airframe::read(word).ok_or(BlockError::Choice)?;
        let gains = G::read(word).ok_or(BlockError::Choice)?;
        settings.check(limits).map_err(BlockError::Range)?;
        airframe.check().map_err(BlockError::Airframe)?;
        gains.check().map_err(BlockError::Gain)?;
        Ok(Self {
            settings,
            airframe,
            gains,
        })
    }
}

/// A digest that also follows names and places of settings.
const fn named<'c>(
    mut digest: crc::Digest<'c, u32>,
    mut settings: &[Setting],
) -> crc::Digest<'c, u32> {
    while let [setting, rest @ ..] = settings {
        digest.update(setting.name.as_bytes());
        digest.update(setting.section.as_bytes());
        digest.update(b".");
        digest.update(setting.key.as_bytes());
        digest.update(b",");
        settings = rest;
    }
    digest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::cascade::Gains as Cascade;
    use crate::gains::openpilot::Gains as OpenPilot;
    use crate::{
        Feedback, Input, Inputs, Motor, MotorProtocol, Pairs, Policy, Reference, WarmUp, micros,
    };
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

    /// A quadrotor with these settings.
    fn start(settings: Settings) -> Start<Cascade> {
        let motors = [(45.0, false), (225.0, false), (315.0, true), (135.0, true)];
        let motors = motors.map(|(angle_deg, clockwise)| Motor {
            angle_deg,
            clockwise,
        });
        Start {
            settings,
            airframe: Airframe::new(0.05, &motors),
            gains: Cascade::default(),
        }
    }

    fn read(bytes: &[u8]) -> Result<Start<Cascade>, BlockError> {
        Start::from_bytes(bytes, &LIMITS)
    }

    #[test]
    fn an_absent_block_is_told_from_a_broken_one() {
        let mut bytes = start(shipped()).to_bytes();
        assert_eq!(read(&[0; 1000][..bytes.len()]), Err(BlockError::Absent));
        assert_eq!(read(&[]), Err(BlockError::Absent));
        bytes[20] ^= 1;
        assert_eq!(read(&bytes), Err(BlockError::Checksum));
    }

    #[test]
    fn a_block_with_a_field_out_of_range_is_refused() {
        let settings = Settings {
            p_run: 1.0,
            ..shipped()
        };
        let refused = read(&start(settings).to_bytes());
        let Err(BlockError::Range(refused)) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(refused.setting.name, "p_run");
    }

    #[test]
    fn a_block_of_another_logic_is_refused() {
        let Start {
            settings, airframe, ..
        } = start(shipped());
        let other = Start {
            settings,
            airframe,
            gains: OpenPilot::default(),
        };
        let mut bytes = other.to_bytes().to_vec();
        bytes.resize(1000, 0);
        assert_eq!(
            read(&bytes[..Start::<Cascade>::LENGTH]),
            Err(BlockError::Version)
        );
    }

    #[test]
    fn a_block_with_an_airframe_or_a_gain_out_of_range_is_refused() {
        let mut start = start(shipped());
        start.gains.rate.integral_limit = f32::NAN;
        assert_eq!(read(&start.to_bytes()), Err(BlockError::Gain(8)));
        start.airframe = Airframe::new(0.05, &[]);
        let refused = Err(BlockError::Airframe(AirframeError::Count(0)));
        assert_eq!(read(&start.to_bytes()), refused);
    }

    #[test]
    fn a_number_that_means_nothing_is_refused_where_it_stands_for_a_choice() {
        let sound = start(shipped());
        let airframe = Start::<Cascade>::LENGTH
            - CHECKSUM_LENGTH
            - 4 * Cascade::DECLARED.words()
            - 4 * Airframe::WORDS;
        let triggers = HEAD_LENGTH + 4 * Settings::place("triggers").expect("a setting");
        // How many motors, and the turn of the first; inputs, of which there is none with the last bit.
        let bad = [4.5, f32::NAN, -1.0, 300.0].map(|count| (airframe + 4, count.to_le_bytes()));
        let turns =
            [0.0, 0.5, f32::INFINITY, f32::NAN].map(|turn| (airframe + 12, turn.to_le_bytes()));
        let inputs = [(triggers, [0x80, 0, 0, 0]), (triggers, [0, 1, 0, 0])];
        for (place, number) in bad.iter().chain(&turns).chain(&inputs) {
            let mut bytes = sound.to_bytes();
            bytes[*place..place + 4].copy_from_slice(number);
            let content = bytes.len() - CHECKSUM_LENGTH;
            let checksum = CHECKSUM.checksum(&bytes[..content]);
            bytes[content..].copy_from_slice(&checksum.to_le_bytes());
            assert_eq!(read(&bytes), Err(BlockError::Choice), "{place} {number:?}");
        }
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
            let start = start(settings);
            prop_assert_eq!(read(&start.to_bytes()), Ok(start));
        }

        #[test]
        fn any_flipped_bit_is_noticed(byte in 0..Start::<Cascade>::LENGTH, bit in 0u32..8) {
            let mut bytes = start(shipped()).to_bytes();
            bytes[byte] ^= 1u8 << bit;
            prop_assert!(read(&bytes).is_err());
        }
    }
}

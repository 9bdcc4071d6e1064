//! One value of a start by itself, under a number that later builds know again.
//!
//! A number follows from a declaration: name, unit and kind. It stays while others come, go or move;
//! a value that means something else has another one.

use crate::airframe::Airframe;
use crate::block::{BlockError, Start};
use crate::bytes::{CHECKSUM, Vec};
use crate::declare::Declared;
use crate::gains::Gains;
use crate::setting::{Limits, Setting};
use crate::settings::Settings;

/// No control logic has more words.
const MOST_WORDS: usize = 256;

/// A word of a start, and what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Which value, and which axis of it.
    pub number: u32,
    /// Its bytes.
    pub word: [u8; 4],
}

impl<G: Gains> Start<G> {
    /// Hands every word on, as a parameter.
    pub fn parameters(&self, take: &mut impl FnMut(Parameter)) {
        let mut numbers = Self::numbers();
        self.write(&mut |word| {
            if let Some(number) = numbers.next() {
                take(Parameter { number, word });
            }
        });
    }

    /// With parameters in place of its own values; and how many of them this build does not know.
    ///
    /// # Errors
    /// Why none of them is used: together they must be a start.
    #[inline(never)]
    pub fn with(
        &self,
        parameters: &[Parameter],
        limits: &Limits,
    ) -> Result<(Self, usize), BlockError> {
        const { assert!(Self::LENGTH <= 4 * MOST_WORDS) }
        let mut unknown = parameters.len();
        let mut words = Vec::<[u8; 4], MOST_WORDS>::new();
        self.parameters(&mut |own| {
            let given = parameters.iter().find(|given| given.number == own.number);
            unknown = unknown.saturating_sub(usize::from(given.is_some()));
            // There is room, see above.
            let _ = words.push(given.unwrap_or(&own).word);
        });
        let mut words = words.into_iter();
        Ok((Self::read(&mut || words.next(), limits)?, unknown))
    }

    /// Hands on, as parameters, what differs from another start.
    #[inline(never)]
    pub fn beyond(&self, base: &Self, take: &mut impl FnMut(Parameter)) {
        let mut words = Vec::<[u8; 4], MOST_WORDS>::new();
        base.write(&mut |word| drop(words.push(word)));
        let mut words = words.into_iter();
        self.parameters(&mut |own| {
            if words.next() != Some(own.word) {
                take(own);
            }
        });
    }

    fn numbers() -> impl Iterator<Item = u32> {
        let settings = Settings::SETTINGS.iter();
        let gains = G::DECLARED.gains.iter();
        settings
            .flat_map(|setting| of_setting("", setting))
            .chain(
                (0..Airframe::WORDS as u8).map(|word| number(["airframe", "", "", ""], [0, word])),
            )
            .chain(gains.flat_map(|gain| of_setting(G::DECLARED.logic, gain)))
    }
}

fn of_setting(logic: &'static str, setting: &'static Setting) -> impl Iterator<Item = u32> {
    let names = [logic, setting.section, setting.key, setting.unit];
    let axes = 0..setting.kind.numbers() as u8;
    axes.map(move |axis| number(names, [setting.kind.number(), axis]))
}

fn number(names: [&str; 4], [kind, axis]: [u8; 2]) -> u32 {
    let mut digest = CHECKSUM.digest();
    for name in names {
        digest.update(name.as_bytes());
        digest.update(b".");
    }
    digest.update(&[kind, axis]);
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::{arducopter, cascade, cleanflight, observer, openpilot};
    use crate::{Motor, Value, micros};

    const LIMITS: Limits = Limits {
        hyperperiod: micros(1000),
        longest_warm_up: micros(30_000_000),
        imu_rate_hz: 1000,
    };

    type Cascade = Start<cascade::Gains>;

    fn shipped() -> Cascade {
        let settings = Settings::collect(&mut |setting| match setting.kind {
            crate::Kind::Inputs => Some(Value::Inputs(crate::Inputs::ALL)),
            crate::Kind::Step { .. } => Some(Value::Number(1.0 / 255.0)),
            _ => setting.parse(setting.default).ok(),
        });
        let motors = [(45.0, false), (225.0, false), (315.0, true), (135.0, true)];
        let motors = motors.map(|(angle_deg, clockwise)| Motor {
            angle_deg,
            clockwise,
        });
        Start {
            settings: settings.expect("defaults"),
            airframe: Airframe::new(0.05, &motors),
            gains: cascade::Gains::default(),
        }
    }

    /// What differs between two starts.
    fn differences(from: &Cascade, to: &Cascade) -> std::vec::Vec<Parameter> {
        let mut found = vec![];
        to.beyond(from, &mut |parameter| found.push(parameter));
        found
    }

    fn changed() -> Cascade {
        let mut start = shipped();
        start.settings.hard_iron = [0.1, 0.0, -0.2];
        start.settings.p_run = 0.7;
        start.gains.rate.integral_limit = 0.125;
        start
    }

    #[test]
    fn no_two_values_of_any_logic_share_a_number() {
        fn of<G: Gains>() -> usize {
            let numbers: std::vec::Vec<u32> = Start::<G>::numbers().collect();
            assert_eq!(4 * numbers.len() + 12, Start::<G>::LENGTH);
            let mut sorted = numbers.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), numbers.len());
            numbers.len()
        }
        let counts = [
            of::<arducopter::Gains>(),
            of::<cascade::Gains>(),
            of::<cleanflight::Gains>(),
            of::<observer::Gains>(),
            of::<openpilot::Gains>(),
        ];
        assert!(counts.iter().all(|count| *count > 40), "{counts:?}");
    }

    #[test]
    fn a_number_is_for_ever() {
        // Changing one would make every drone forget its calibration.
        let changed = differences(&shipped(), &changed());
        let numbers: std::vec::Vec<u32> = changed.iter().map(|it| it.number).collect();
        assert_eq!(
            numbers,
            [3_775_471_856, 18_515_840, 4_011_124_396, 3_290_664_679]
        );
    }

    #[test]
    fn what_differs_is_all_that_needs_to_be_kept() {
        let kept = differences(&shipped(), &changed());
        assert_eq!(kept.len(), 4);
        assert_eq!(shipped().with(&kept, &LIMITS), Ok((changed(), 0)));
        assert_eq!(shipped().with(&[], &LIMITS), Ok((shipped(), 0)));
    }

    #[test]
    fn unknown_values_are_counted_and_the_others_used() {
        let mut kept = differences(&shipped(), &changed());
        kept.push(Parameter {
            number: 1,
            word: [1; 4],
        });
        assert_eq!(shipped().with(&kept, &LIMITS), Ok((changed(), 1)));
    }

    #[test]
    fn a_value_out_of_its_range_has_all_refused() {
        let mut wrong = changed();
        wrong.settings.accel_trim[1] = 1.5;
        let refused = shipped().with(&differences(&shipped(), &wrong), &LIMITS);
        let Err(BlockError::Range(refused)) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(refused.setting.name, "accel_trim");
    }
}

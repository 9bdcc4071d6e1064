//! One value of a start by itself, under a number that later builds know again.
//!
//! A number follows from a declaration: name, unit and kind. It stays while others come, go or move;
//! a value that means something else has another one.

use crate::airframe::Airframe;
use crate::block::{BlockError, LONGEST, Start};
use crate::bytes::{CHECKSUM, Vec, put};
use crate::declare::Declared;
use crate::gains::{Gains, LogicGains};
use crate::setting::{Limits, Setting};
use crate::settings::Settings;

/// A word of a start, and what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Which value, and which axis of it.
    pub number: u32,
    /// Its bytes.
    pub word: [u8; 4],
}

/// Every word of a start, in the order of the declarations.
type Words = Vec<u8, LONGEST>;

impl<G: Gains> Start<G> {
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
        let mut words = self.words();
        let unknown = replace(&mut words, &G::DECLARED, parameters);
        Ok((Self::read(&words, limits)?, unknown))
    }

    /// Hands on, as parameters, what differs from another start.
    #[inline(never)]
    pub fn beyond(&self, base: &Self, take: &mut impl FnMut(Parameter)) {
        differences(&self.words(), &base.words(), &G::DECLARED, take);
    }

    #[inline(never)]
    fn words(&self) -> Words {
        let mut words = Words::new();
        self.write(&mut |word| put(&mut words, &word));
        words
    }
}

/// Puts parameters in the place of words; how many of them there is no place for.
#[inline(never)]
fn replace(words: &mut Words, gains: &LogicGains, parameters: &[Parameter]) -> usize {
    let mut unknown = parameters.len();
    let (words, _) = words.as_chunks_mut();
    let mut words = words.iter_mut();
    each_number(gains, &mut |number| {
        let word = words.next();
        let given = parameters.iter().find(|given| given.number == number);
        if let (Some(word), Some(given)) = (word, given) {
            *word = given.word;
            unknown = unknown.saturating_sub(1);
        }
    });
    unknown
}

#[inline(never)]
fn differences(words: &[u8], base: &[u8], gains: &LogicGains, take: &mut impl FnMut(Parameter)) {
    let (words, base) = (words.as_chunks().0, base.as_chunks().0);
    let mut pairs = words.iter().zip(base);
    each_number(gains, &mut |number| match pairs.next() {
        Some((word, base)) if word != base => take(Parameter {
            number,
            word: *word,
        }),
        _ => {}
    });
}

/// Hands on the number of every word of a start, in order.
#[inline(never)]
fn each_number(gains: &LogicGains, take: &mut impl FnMut(u32)) {
    each_of("", Settings::SETTINGS, take);
    (0..Airframe::WORDS as u8).for_each(|word| take(number(["airframe", "", "", ""], [0, word])));
    each_of(gains.logic, gains.gains, take);
}

fn each_of(logic: &str, settings: &[Setting], take: &mut impl FnMut(u32)) {
    for setting in settings {
        let names = [logic, setting.section, setting.key, setting.unit];
        for axis in 0..setting.kind.numbers() as u8 {
            take(number(names, [setting.kind.number(), axis]));
        }
    }
}

#[inline(never)]
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
            let mut numbers = vec![];
            each_number(&G::DECLARED, &mut |number| numbers.push(number));
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

//! The gains of each control logic: what its file may say, and its laws' values.
//!
//! A gain is declared once, in the order of the file. From its line come the check of
//! `config/logics/NAME.toml`, the field of the struct, and its place in a list of numbers.

use crate::{Range, Setting};

/// The gains of one control logic, as its file has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogicGains {
    /// Name of its file, without `.toml`.
    pub logic: &'static str,
    /// In the order of the file.
    pub gains: &'static [Setting],
}

/// The values of one control logic's gains.
pub trait Gains: Copy + PartialEq + 'static {
    /// What its file may say.
    const DECLARED: LogicGains;

    /// Hands every number's bytes on, in the order of the file.
    fn write(&self, put: &mut dyn FnMut([u8; 4]));

    /// Reads what [`Self::write`] wrote; `None` where numbers are missing.
    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self>;

    /// Checks every range.
    ///
    /// # Errors
    /// The place in the file of the first gain that is out of its range.
    fn check(&self) -> Result<(), usize>;
}

/// The place of the first gain that has a number out of its range.
fn outside(gains: &[&[f32]], ranges: &[Range]) -> Option<usize> {
    let inside = |range: &Range, number: &f32| range.contains(f64::from(*number));
    let mut gains = gains.iter().zip(ranges);
    gains.position(|(numbers, range)| !numbers.iter().all(|number| inside(range, number)))
}

/// A gain that leaves its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// Which.
    pub gain: &'static Setting,
    /// The number that it would be.
    pub number: f64,
    /// What it may be.
    pub range: Range,
}

impl LogicGains {
    /// How many numbers these gains are, one after the other.
    #[must_use]
    pub const fn words(&self) -> usize {
        words(self.gains)
    }

    /// Makes the loops so many times as fast; `numbers` are those of all gains in order.
    ///
    /// # Errors
    /// The first gain that would leave its range.
    pub fn quicken(&self, numbers: &mut [f64], bandwidth: f64) -> Result<(), OutOfRange> {
        let axes = self
            .gains
            .iter()
            .flat_map(|gain| core::iter::repeat_n(gain, gain.kind.numbers()));
        for (gain, number) in axes.zip(numbers).filter(|(gain, _)| gain.growth != 0) {
            *number *= (0..gain.growth).fold(1.0, |power, _| power * bandwidth);
            if let Some(range) = gain.kind.range()
                && !range.contains(*number)
            {
                let number = *number;
                return Err(OutOfRange {
                    gain,
                    number,
                    range,
                });
            }
        }
        Ok(())
    }
}

const fn words(gains: &[Setting]) -> usize {
    let (mut sum, mut left) = (0, gains);
    while let [gain, rest @ ..] = left {
        sum += gain.kind.numbers();
        left = rest;
    }
    sum
}

/// The next number of a list; zero behind its end.
const fn next<T: Copy>(numbers: &mut &[T], zero: T) -> T {
    match *numbers {
        [number, rest @ ..] => {
            *numbers = rest;
            *number
        }
        [] => zero,
    }
}

/// The type of a gain of some shape, its numbers, and how it is taken from a list.
macro_rules! shape {
    (type number) => {
        f32
    };
    (type axes) => {
        [f32; 3]
    };
    (numbers number $value:expr) => {
        core::slice::from_ref(&$value)
    };
    (numbers axes $value:expr) => {
        $value.as_slice()
    };
    (kind number $range:expr) => {
        $crate::Kind::Number($range)
    };
    (kind axes $range:expr) => {
        $crate::Kind::Axes($range)
    };
    (next number $words:ident) => {
        next(&mut $words, 0.0)
    };
    (next axes $words:ident) => {
        [
            next(&mut $words, 0.0),
            next(&mut $words, 0.0),
            next(&mut $words, 0.0),
        ]
    };
}

/// Declares the gains of a control logic, section by section.
///
/// A line is `KEY: SHAPE = DEFAULT, RANGE, UNIT, MEANING;`, where the shape is `number` or `axes`,
/// and `grows POWER` may follow: see [`Setting::growth`].
macro_rules! gains {
    ($logic:literal; $(
        $(#[$doc:meta])*
        $section:ident: $Section:ident {
            $($key:ident: $shape:tt = $default:expr, $range:expr, $unit:expr, $meaning:literal
                $(, grows $growth:literal)?;)*
        }
    )*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $Section {
                $(#[doc = concat!($meaning, ", in ", $unit, ".")]
                pub $key: shape!(type $shape),)*
            }
        )*

        #[doc = concat!("All gains of `config/logics/", $logic, ".toml`.")]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Gains {
            $($(#[$doc])* pub $section: $Section,)*
        }

        /// What the file may say.
        pub const DECLARED: LogicGains = LogicGains {
            logic: $logic,
            gains: &[$($(Setting::of(
                [stringify!($section), stringify!($key)],
                shape!(kind $shape $range),
                $unit,
            )
            .default(stringify!($default))
            .meaning($meaning)
            .grows(0 $(+ $growth)?),)*)*],
        };

        impl $crate::gains::Gains for Gains {
            const DECLARED: LogicGains = DECLARED;

            fn write(&self, put: &mut dyn FnMut([u8; 4])) {
                $($($crate::Field::write(self.$section.$key, put);)*)*
            }

            fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
                Some(Self {
                    $($section: $Section { $($key: $crate::Field::read(take)?,)* },)*
                })
            }

            fn check(&self) -> Result<(), usize> {
                const RANGES: &[$crate::Range] = &[$($($range,)*)*];
                let numbers: &[&[f32]] = &[$($(shape!(numbers $shape self.$section.$key),)*)*];
                match outside(numbers, RANGES) {
                    Some(place) => Err(place),
                    None => Ok(()),
                }
            }
        }

        impl Gains {
            /// How many numbers they are.
            pub const WORDS: usize = DECLARED.words();

            /// From their numbers, one after the other in the order of the file.
            #[must_use]
            pub const fn from_words(words: &[f32; Self::WORDS]) -> Self {
                let mut words = words.as_slice();
                Self {
                    $($section: $Section {
                        $($key: shape!(next $shape words),)*
                    },)*
                }
            }

        }

        impl Default for Gains {
            fn default() -> Self {
                Self {
                    $($section: $Section { $($key: $default,)* },)*
                }
            }
        }
    };
}

/// A module for each logic of the one list, and all of them in its order.
macro_rules! modules {
    ($($(#[$doc:meta])* $logic:ident: $name:literal, $Logic:ident;)*) => {
        $(#[doc = concat!("Gains of `", $name, "`.")]
        pub mod $logic;)*

        /// The gains of every control logic.
        pub const LOGICS: &[LogicGains] = &[$($logic::DECLARED,)*];
    };
}

crate::control_logics!(modules);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_were_written_are_read_in_the_order_of_the_file() {
        let gains = cascade::Gains::default();
        let mut words = std::vec::Vec::new();
        gains.write(&mut |bytes| words.push(f32::from_le_bytes(bytes)));
        assert_eq!(words.len(), LOGICS[0].words());
        assert_eq!(words[2..5], gains.attitude.p);
        assert_eq!(
            cascade::Gains::from_words(&words.try_into().expect("all")),
            gains
        );
    }

    #[test]
    fn a_gain_that_is_out_of_range_or_no_number_is_found_by_its_place() {
        for wrong in [-0.1, 10.1, f32::NAN] {
            let mut gains = cascade::Gains::default();
            assert_eq!(gains.check(), Ok(()));
            gains.estimate.heading_correction = wrong;
            assert_eq!(gains.check(), Err(1));
        }
    }

    #[test]
    fn every_default_is_in_its_range() {
        for gain in LOGICS.iter().flat_map(|logic| logic.gains) {
            let value = gain.parse(gain.default).expect(gain.default);
            assert_eq!(gain.check(value, None), Ok(()), "{}", gain.path());
        }
    }

    #[test]
    fn loops_of_twice_the_bandwidth_have_twice_the_gain_and_four_times_the_integral() {
        let [p, i] = ["p", "i"].map(|key| {
            let gains = cascade::DECLARED.gains;
            gains
                .iter()
                .take_while(|it| (it.section, it.key) != ("rate", key))
                .map(|it| it.kind.numbers())
                .sum::<usize>()
        });
        let mut numbers = [1e-3; cascade::Gains::WORDS];
        cascade::DECLARED
            .quicken(&mut numbers, 2.0)
            .expect("in range");
        assert_eq!([numbers[p], numbers[i], numbers[0]], [2e-3, 4e-3, 1e-3]);
    }
}

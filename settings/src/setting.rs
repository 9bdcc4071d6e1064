//! One setting: all that its users say, check or write comes from here.

use core::fmt;

use crate::choices::{Choice, Choices, Policy};
use crate::inputs::{Input, Inputs};
use crate::range::Range;
use crate::time::{Duration, seconds};

/// The declaration of one setting or constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The field or constant that holds it.
    pub name: &'static str,
    /// The table of the TOML file that it is in, a dot between nested ones.
    pub section: &'static str,
    /// Its key in there.
    pub key: &'static str,
    /// What its value is.
    pub kind: Kind,
    /// It is in a board's file.
    pub of_board: bool,
    /// Unit of its value as it is written, empty where it has none.
    pub unit: &'static str,
    /// The value of a configuration that is as it was shipped, as it is written in TOML.
    pub default: &'static str,
    /// What it does, as a sentence.
    pub meaning: &'static str,
    /// The command line's option, without dashes, and what its help calls the value.
    pub option: Option<[&'static str; 2]>,
    /// What else limits it.
    pub limit: Option<Limit>,
    /// The policy that it belongs to, where the other one has no use for it.
    pub policy: Option<Policy>,
    /// The power of the loops' bandwidth that a gain grows with; 0 for what is no gain of them.
    pub growth: u32,
}

/// What a value is, and how it is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number, stored as it is.
    Number(Range),
    /// Three numbers, each in the range, one for each axis.
    Axes(Range),
    /// A whole number.
    Count(Range),
    /// A time in s, stored in microseconds.
    Span(Range),
    /// A frequency in Hz, stored as its period in microseconds.
    Rate(Range),
    /// A share of full scale. In TOML it is written as the number of steps in full scale.
    Step {
        /// The share.
        share: Range,
        /// The number of steps.
        steps: Range,
    },
    /// One word in several spellings, or a time in s. The first spelling is the one that we write.
    WordOrSpan(&'static [&'static str], Range),
    /// One of a few words.
    Word(Choices),
    /// True or false.
    Flag,
    /// A set of inputs.
    Inputs,
}

/// A value as it is written: in the unit of its [`Setting`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// Three numbers, one for each axis.
    Axes([f64; 3]),
    /// The number of a word.
    Word(u32),
    /// True or false.
    Flag(bool),
    /// A set of inputs.
    Inputs(Inputs),
}

/// What limits a value beyond its own range: another value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Longer than two hyperperiods.
    AboveTwoHyperperiods,
    /// At most one run per hyperperiod.
    OncePerHyperperiod,
    /// At most the longest warm-up.
    LongestWarmUp,
    /// At most 0.45 times the rate of the IMU.
    BelowHalfTheImuRate,
}

/// The values that [`Limit`]s refer to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Least common multiple of the gating inputs' periods.
    pub hyperperiod: Duration,
    /// The most that any warm-up lasts.
    pub longest_warm_up: Duration,
    /// Rate of the IMU in Hz.
    pub imu_rate_hz: u32,
}

/// A value that is out of its range; displayed, it is the refusal that follows the setting's name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// The setting.
    pub setting: &'static Setting,
    /// Its value.
    pub value: Value,
    /// The limit that is passed, where the value is in the range itself.
    pub limit: Option<(Limit, Limits)>,
}

impl Setting {
    /// A setting of a TOML file.
    #[must_use]
    pub const fn of(path: [&'static str; 2], kind: Kind, unit: &'static str) -> Self {
        let [section, key] = path;
        Self {
            name: "",
            section,
            key,
            kind,
            of_board: false,
            unit,
            default: "",
            meaning: "",
            option: None,
            limit: None,
            policy: None,
            growth: 0,
        }
    }

    /// With the field or constant that holds it.
    #[must_use]
    pub const fn named(mut self, name: &'static str) -> Self {
        self.name = name;
        self
    }

    /// With what it does, as a sentence.
    #[must_use]
    pub const fn meaning(mut self, meaning: &'static str) -> Self {
        self.meaning = on_host(meaning);
        self
    }

    /// Of a board's file, not of `reactive.toml`.
    #[must_use]
    pub const fn of_board(mut self) -> Self {
        self.of_board = true;
        self
    }

    /// With its value in a configuration that is as it was shipped, as it is written in TOML.
    #[must_use]
    pub const fn default(mut self, text: &'static str) -> Self {
        self.default = on_host(text);
        self
    }

    /// With an option of the command line, whose help calls the value by a name.
    #[must_use]
    pub const fn option(mut self, name: &'static str, value: &'static str) -> Self {
        self.option = Some([on_host(name), on_host(value)]);
        self
    }

    /// With a limit beyond its range.
    #[must_use]
    pub const fn limited(mut self, limit: Limit) -> Self {
        self.limit = Some(limit);
        self
    }

    /// Of one policy alone.
    #[must_use]
    pub const fn only_of(mut self, policy: Policy) -> Self {
        self.policy = Some(policy);
        self
    }

    /// A gain of the attitude or rate loop, and the power of their bandwidth that it grows with.
    ///
    /// Loops that are to be twice as fast ask for twice the rate per error, twice the torque per
    /// rate, and four times the torque per angle.
    #[must_use]
    pub const fn grows(mut self, power: u32) -> Self {
        self.growth = power;
        self
    }

    /// Checks a value against the range, and against what else limits it where that is known.
    ///
    /// # Errors
    /// The value with the range that it is not in.
    #[inline(never)]
    pub fn check(&'static self, value: Value, limits: Option<&Limits>) -> Result<(), OutOfRange> {
        let refused = |limit| {
            Err(OutOfRange {
                setting: self,
                value,
                limit,
            })
        };
        if !self.kind.holds(&value) {
            return refused(None);
        }
        if let (Some(limit), Some(limits), Value::Number(number)) = (self.limit, limits, value)
            && !limit.allows(number, limits)
        {
            return refused(Some((limit, *limits)));
        }
        Ok(())
    }

    /// Its full key in the TOML file.
    #[must_use]
    pub const fn path(&self) -> Path {
        Path(self.section, self.key)
    }

    /// What it may be, with its unit: "0 to 30 s".
    #[must_use]
    pub const fn range(&'static self) -> impl fmt::Display {
        Words {
            setting: self,
            limit: None,
        }
    }
}

/// Words that only a host writes: the firmware's flash has no room for them.
const fn on_host(words: &'static str) -> &'static str {
    if cfg!(target_os = "none") { "" } else { words }
}

/// A full key, with a dot between its parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path(&'static str, &'static str);

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.0.is_empty() {
            write!(f, "{}.", self.0)?;
        }
        f.write_str(self.1)
    }
}

impl Kind {
    /// A set of words.
    #[must_use]
    pub const fn word<T: Choice>() -> Self {
        Self::Word(T::CHOICES)
    }

    /// Tells kinds apart in what is stored: it never changes.
    pub(crate) const fn number(&self) -> u8 {
        match self {
            Self::Number(_) => 0,
            Self::Axes(_) => 1,
            Self::Count(_) => 2,
            Self::Span(_) => 3,
            Self::Rate(_) => 4,
            Self::Step { .. } => 5,
            Self::WordOrSpan(..) => 6,
            Self::Word(_) => 7,
            Self::Flag => 8,
            Self::Inputs => 9,
        }
    }

    /// How many numbers a value is.
    #[must_use]
    pub const fn numbers(&self) -> usize {
        match self {
            Self::Axes(_) => 3,
            _ => 1,
        }
    }

    /// The range of its numbers.
    #[must_use]
    pub const fn range(&self) -> Option<Range> {
        match *self {
            Self::Number(range)
            | Self::Axes(range)
            | Self::Count(range)
            | Self::Span(range)
            | Self::Rate(range)
            | Self::WordOrSpan(_, range)
            | Self::Step { share: range, .. } => Some(range),
            Self::Word(_) | Self::Flag | Self::Inputs => None,
        }
    }

    fn holds(&self, value: &Value) -> bool {
        match (*self, *value) {
            (
                Self::Number(range)
                | Self::Span(range)
                | Self::Rate(range)
                | Self::Step { share: range, .. }
                | Self::WordOrSpan(_, range),
                Value::Number(number),
            ) => range.contains(number),
            (Self::Count(range), Value::Number(number)) => range.contains_count(number),
            (Self::Axes(range), Value::Axes(numbers)) => {
                numbers.iter().all(|&number| range.contains(number))
            }
            (Self::WordOrSpan(..), Value::Word(number)) => number == 0,
            (Self::Word(choices), Value::Word(number)) => {
                (number as usize) < choices.variants.len()
            }
            (Self::Inputs, Value::Inputs(inputs)) => inputs.meets(SEEN_AT_EVERY_SAMPLE),
            (Self::Flag, Value::Flag(_)) => true,
            _ => false,
        }
    }
}

/// At least one of these must trigger: the others' samples are too rare to fly by.
const SEEN_AT_EVERY_SAMPLE: Inputs = Inputs::NONE
    .with(Input::Gyro)
    .with(Input::Turned)
    .with(Input::Command)
    .with(Input::Owed);

impl Limit {
    /// True for a number that keeps to it; single precision, as in [`Range::contains`].
    fn allows(self, number: f64, limits: &Limits) -> bool {
        let (number, end) = (number as f32, self.end(limits) as f32);
        match self {
            Self::AboveTwoHyperperiods => number > end,
            _ => number <= end,
        }
    }

    fn end(self, limits: &Limits) -> f64 {
        match self {
            Self::AboveTwoHyperperiods => seconds(limits.hyperperiod * 2),
            Self::OncePerHyperperiod => 1.0 / seconds(limits.hyperperiod),
            Self::LongestWarmUp => seconds(limits.longest_warm_up),
            Self::BelowHalfTheImuRate => 0.45 * f64::from(limits.imu_rate_hz),
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::AboveTwoHyperperiods => "2 hyperperiods",
            Self::OncePerHyperperiod => "one run per hyperperiod",
            Self::LongestWarmUp => "longest_s",
            Self::BelowHalfTheImuRate => "0.45 times imu_rate_hz",
        }
    }
}

/// The words for what a setting may be.
struct Words {
    setting: &'static Setting,
    limit: Option<(Limit, Limits)>,
}

impl fmt::Display for Words {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.setting.unit;
        match self.setting.kind {
            Kind::Word(choices) => {
                listed(f, "one of ", choices.variants.iter().map(|[_, word]| *word))
            }
            Kind::Flag => f.write_str("true or false"),
            Kind::Inputs => {
                let inputs = Input::ALL.iter();
                let needed = inputs.filter(|input| SEEN_AT_EVERY_SAMPLE.contains(**input));
                listed(
                    f,
                    "a set with at least one of ",
                    needed.map(|input| input.key()),
                )
            }
            Kind::WordOrSpan(words, _) => {
                write!(f, "{} or ", words.first().unwrap_or(&""))?;
                self.numbers(f, unit)
            }
            Kind::Axes(_) => {
                f.write_str("each ")?;
                self.numbers(f, unit)
            }
            _ => self.numbers(f, unit),
        }
    }
}

impl Words {
    fn numbers(&self, f: &mut fmt::Formatter<'_>, unit: &str) -> fmt::Result {
        let Some(range) = self.setting.kind.range() else {
            return Ok(());
        };
        let space = if unit.is_empty() { "" } else { " " };
        match (self.limit, self.setting.limit) {
            (Some((limit, limits)), _) => {
                let end = limit.end(&limits);
                let (low, high) = range.ends();
                match limit {
                    Limit::AboveTwoHyperperiods => {
                        let words = limit.words();
                        write!(
                            f,
                            "above {words}, {end} {unit}, and at most {high}{space}{unit}"
                        )
                    }
                    _ => write!(f, "{low} to {}, {end}{space}{unit}", limit.words()),
                }
            }
            (None, Some(limit @ Limit::AboveTwoHyperperiods)) => {
                let (_, high) = range.ends();
                write!(f, "above {} and at most {high}{space}{unit}", limit.words())
            }
            (None, _) => write!(f, "{range}{space}{unit}"),
        }
    }
}

fn listed<'w>(
    f: &mut fmt::Formatter<'_>,
    start: &str,
    words: impl Iterator<Item = &'w str>,
) -> fmt::Result {
    f.write_str(start)?;
    for (place, word) in words.enumerate() {
        let comma = if place == 0 { "" } else { ", " };
        write!(f, "{comma}{word}")?;
    }
    Ok(())
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = Words {
            setting: self.setting,
            limit: self.limit,
        };
        let value = Written(self.setting, self.value);
        write!(f, "{value} is out of range, must be {words}")
    }
}

impl core::error::Error for OutOfRange {}

#[cfg(target_os = "none")]
impl defmt::Format for OutOfRange {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{=str}", self.setting.name);
    }
}

/// A number without the digits that its storage in single precision adds.
fn shortest(number: f64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let single = number as f32;
    if f64::from(single) == number {
        write!(f, "{single}")
    } else {
        write!(f, "{number}")
    }
}

/// A value of a setting, as it is written.
pub struct Written(pub &'static Setting, pub Value);

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0.kind, self.1) {
            (Kind::WordOrSpan(words, _), Value::Word(_)) => {
                f.write_str(words.first().unwrap_or(&""))
            }
            (Kind::Word(choices), Value::Word(number)) => {
                let variant = choices.variants.get(number as usize);
                f.write_str(variant.map_or("", |[_, word]| word))
            }
            (_, Value::Number(number)) => shortest(number, f),
            (_, Value::Axes(numbers)) => {
                for (place, number) in numbers.into_iter().enumerate() {
                    f.write_str(if place == 0 { "[" } else { ", " })?;
                    shortest(number, f)?;
                }
                f.write_str("]")
            }
            (_, Value::Word(number)) => write!(f, "{number}"),
            (_, Value::Flag(flag)) => write!(f, "{flag}"),
            (_, Value::Inputs(inputs)) => listed(f, "", inputs.iter().map(Input::key)),
        }
    }
}

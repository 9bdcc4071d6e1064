//! Values as a person writes them, on a command line or in a message.

use core::fmt;

use crate::inputs::{Input, Inputs};
use crate::setting::{Kind, Setting, Value};

/// Why a text is no value of a setting; its range is not looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreadable(&'static Setting);

impl Setting {
    /// Reads a value. Its range is for [`Self::check`].
    ///
    /// # Errors
    /// A text that is of another kind.
    pub fn parse(&'static self, text: &str) -> Result<Value, Unreadable> {
        let text = text.trim();
        let value = match self.kind {
            Kind::Number(_) | Kind::Span(_) | Kind::Rate(_) => number(text),
            Kind::Count(_) => text
                .parse::<u32>()
                .ok()
                .map(|count| Value::Number(count.into())),
            Kind::Step { .. } => share(text),
            Kind::Axes(_) => axes(text),
            Kind::WordOrSpan(words, _) if words.contains(&text) => Some(Value::Word(0)),
            Kind::WordOrSpan(..) => number(text),
            Kind::Word(choices) => {
                let mut words = choices.variants.iter().map(|[_, word]| *word);
                let place = words.position(|word| word == text);
                place.map(|place| Value::Word(place as u32))
            }
            Kind::Flag => text.parse().ok().map(Value::Flag),
            Kind::Inputs => inputs(text),
        };
        value.ok_or(Unreadable(self))
    }
}

fn finite(text: &str) -> Option<f64> {
    text.trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
}

fn number(text: &str) -> Option<Value> {
    finite(text).map(Value::Number)
}

/// A share, `0.004` or `1/255`.
fn share(text: &str) -> Option<Value> {
    let share = match text.split_once('/') {
        Some((part, whole)) => finite(part)? / finite(whole)?,
        None => finite(text)?,
    };
    share.is_finite().then_some(Value::Number(share))
}

/// Three numbers with commas between them, in brackets or not.
fn axes(text: &str) -> Option<Value> {
    let text = text.trim_start_matches('[').trim_end_matches(']');
    let mut numbers = text.split(',').map(finite);
    let axes = [numbers.next()??, numbers.next()??, numbers.next()??];
    numbers.next().is_none().then_some(Value::Axes(axes))
}

/// `all`, or names of inputs with commas between them.
fn inputs(text: &str) -> Option<Value> {
    if text == "all" {
        return Some(Value::Inputs(Inputs::ALL));
    }
    let inputs = text.split(',').try_fold(Inputs::NONE, |all, name| {
        let input = Input::ALL.into_iter().find(|input| input.key() == name);
        input.map(|input| all.with(input))
    });
    inputs.map(Value::Inputs)
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(setting) = self;
        match setting.kind {
            Kind::Number(_) | Kind::Span(_) | Kind::Rate(_) | Kind::Step { .. } => {
                f.write_str("must be a finite number")?;
            }
            Kind::Count(_) => f.write_str("must be a whole number")?,
            Kind::Axes(_) => f.write_str("must be three numbers, one for each axis")?,
            Kind::WordOrSpan(..) => f.write_str("must be a word or a finite number")?,
            Kind::Word(_) => return write!(f, "must be {}", setting.range()),
            Kind::Flag => return f.write_str("must be true or false"),
            Kind::Inputs => {
                f.write_str("must be `all`, or of ")?;
                for (place, input) in Input::ALL.iter().enumerate() {
                    let comma = if place == 0 { "" } else { ", " };
                    write!(f, "{comma}{}", input.key())?;
                }
                return Ok(());
            }
        }
        write!(f, ", {}", setting.range())
    }
}

impl core::error::Error for Unreadable {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Declared, Settings};

    fn parse(name: &str, text: &str) -> Result<Value, String> {
        let place = Settings::place(name).expect(name);
        let value = Settings::SETTINGS[place].parse(text);
        value.map_err(|refusal| refusal.to_string())
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(parse("p_run", "0.5"), Ok(Value::Number(0.5)));
        for text in ["nan", "inf", "-inf", "1e999", "", "0,5", "1 s"] {
            assert!(parse("p_run", text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_share_may_be_a_fraction() {
        assert_eq!(parse("quantum", "1/4"), Ok(Value::Number(0.25)));
        assert_eq!(parse("quantum", "0.25"), Ok(Value::Number(0.25)));
        for text in ["1/0", "0/0", "1/", "/2", "1/2/3", "one"] {
            assert!(parse("quantum", text).is_err(), "{text}");
        }
    }

    #[test]
    fn inputs_are_named_as_in_the_configuration() {
        let two = Inputs::NONE.with(Input::Gyro).with(Input::ChipMag);
        assert_eq!(parse("triggers", "gyro,chip-mag"), Ok(Value::Inputs(two)));
        assert_eq!(parse("triggers", "all"), Ok(Value::Inputs(Inputs::ALL)));
        let line = parse("triggers", "gyro,baro").unwrap_err();
        assert!(
            line.starts_with("must be `all`, or of gyro, accel"),
            "{line}"
        );
    }

    #[test]
    fn a_warm_up_is_automatic_or_a_time() {
        for word in ["auto", "automatic"] {
            assert_eq!(parse("warm_up", word), Ok(Value::Word(0)));
        }
        assert_eq!(parse("warm_up", "2.5"), Ok(Value::Number(2.5)));
        for text in ["nan", "soon"] {
            let line = parse("warm_up", text).unwrap_err();
            assert!(line.ends_with("automatic or 0 to 30 s"), "{line}");
        }
    }

    #[test]
    fn every_default_is_in_its_range() {
        for setting in Settings::SETTINGS
            .iter()
            .chain(crate::REACTIVE)
            .chain(crate::SAFETY)
            .chain(crate::rates())
            .chain(crate::BOARD)
        {
            // Inputs have tables of their own, steps are written as shares on a command line.
            if !matches!(setting.kind, Kind::Inputs | Kind::Step { .. }) {
                let value = setting.parse(setting.default).expect(setting.name);
                assert_eq!(setting.check(value, None), Ok(()), "{}", setting.name);
            }
        }
    }

    #[test]
    fn names_options_and_keys_are_of_one_setting_each() {
        let all = || {
            Settings::SETTINGS
                .iter()
                .chain(crate::REACTIVE)
                .chain(crate::SAFETY)
                .chain(crate::rates())
                .chain(crate::BOARD)
        };
        for setting in all() {
            let same = |other: &&Setting| other.name == setting.name;
            assert_eq!(all().filter(same).count(), 1, "{}", setting.name);
            let same = |other: &&Setting| {
                other.path() == setting.path() && other.of_board == setting.of_board
            };
            assert_eq!(all().filter(same).count(), 1, "{}", setting.path());
            assert!(setting.meaning.ends_with('.'), "{}", setting.name);
        }
    }
}

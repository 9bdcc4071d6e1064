//! Options of the command line that declarations make, as clap reads them.
//!
//! Each option, its help and its refusals are written from its [`Setting`].

use std::marker::PhantomData;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use reflex_settings::{Kind, Setting, Value};

use crate::refusal::Refusal;

/// A list of declarations; those with an option can be given.
pub(super) trait Declarations: Clone + 'static {
    /// The list.
    const ALL: &'static [Setting];

    /// What the help adds to the meaning and the range.
    fn remark(_: &Setting) -> String {
        String::new()
    }
}

/// The values that are given, by the place of their declaration.
#[derive(Clone, Debug)]
pub(super) struct Given<D>(Vec<(usize, Value)>, PhantomData<D>);

impl<D: Declarations> Given<D> {
    /// Every given value, with its declaration and the place of that.
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, &'static Setting, Value)> {
        let declared =
            |(place, value): &(usize, Value)| Some((*place, D::ALL.get(*place)?, *value));
        self.0.iter().filter_map(declared)
    }

    /// What is given for an option, if anything.
    pub(super) fn of(&self, option: &str) -> Option<Value> {
        self.iter()
            .find(|(_, setting, _)| named(setting) == Some(option))
            .map(|(_, _, value)| value)
    }
}

impl<D: Declarations> Args for Given<D> {
    fn augment_args(command: Command) -> Command {
        D::ALL
            .iter()
            .filter_map(|setting| argument(setting, &D::remark(setting)))
            .fold(command, Command::arg)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<D: Declarations> FromArgMatches for Given<D> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = D::ALL.iter().enumerate().filter_map(|(place, setting)| {
            Some((place, *matches.get_one::<Value>(named(setting)?)?))
        });
        Ok(Self(given.collect(), PhantomData))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

fn named(setting: &Setting) -> Option<&'static str> {
    setting.option.map(|[option, _]| option)
}

/// The option of a declaration; `None` where it has none.
fn argument(setting: &'static Setting, remark: &str) -> Option<Arg> {
    let [option, value] = setting.option?;
    let argument = Arg::new(option).long(option).help(help(setting) + remark);
    Some(match setting.kind {
        Kind::Word(choices) => {
            let words = choices.variants.iter().map(|[_, word]| *word);
            let words = PossibleValuesParser::new(words);
            argument.value_parser(words.try_map(|word| setting.parse(&word)))
        }
        _ => argument
            .value_name(value)
            .allow_negative_numbers(true)
            // The first of several may be negative.
            .allow_hyphen_values(matches!(setting.kind, Kind::Axes(_)))
            .value_parser(|text: &str| setting.parse(text)),
    })
}

/// What the help says: the meaning, and what the value may be where clap does not list it.
fn help(setting: &'static Setting) -> String {
    let meaning = setting.meaning.trim_end_matches('.');
    match setting.kind {
        Kind::Word(_) => meaning.to_owned(),
        Kind::Inputs => format!("{meaning}: `all`, or {}", setting.range()),
        _ => format!("{meaning}: {}", setting.range()),
    }
}

/// A refusal in the name of a setting's option.
pub(super) fn refused(setting: &Setting, line: impl std::fmt::Display) -> Refusal {
    let option = named(setting).unwrap_or(setting.name);
    Refusal::new(format!("--{option}: {line}"))
}

//! Arguments that become the autopilot's settings, the same wherever it flies.
//!
//! Each option, its help and its refusals are written from the setting's declaration.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use reflex::config::{HYPERPERIOD, LIMITS, SETTINGS};
use reflex::settings::{Declared, Policy, Settings};
use reflex::time::Duration;
use reflex_settings::{Kind, Setting, Value};

use crate::refusal::Refusal;

/// The settings that are given, by the place of their declaration. Others are those of `config/`.
#[derive(Clone, Debug, Default)]
pub(super) struct SettingsArguments(Vec<(usize, Value)>);

impl Args for SettingsArguments {
    fn augment_args(command: Command) -> Command {
        Settings::SETTINGS
            .iter()
            .filter_map(argument)
            .fold(command, Command::arg)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SettingsArguments {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let settings = Settings::SETTINGS.iter().enumerate();
        let given = settings.filter_map(|(place, setting)| {
            let [option, _] = setting.option?;
            Some((place, *matches.get_one::<Value>(option)?))
        });
        Ok(Self(given.collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The option of a declaration; `None` where it has none.
pub(super) fn argument(setting: &'static Setting) -> Option<Arg> {
    let [option, value] = setting.option?;
    let argument = Arg::new(option).long(option).help(help(setting));
    Some(match setting.kind {
        Kind::Word(choices) => {
            let words = choices.variants.iter().map(|[_, word]| *word);
            let words = PossibleValuesParser::new(words);
            argument.value_parser(words.try_map(|word| setting.parse(&word)))
        }
        _ => argument
            .value_name(value)
            .allow_negative_numbers(true)
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

impl SettingsArguments {
    /// The settings, once every mix of arguments is checked.
    ///
    /// # Errors
    /// The first mix or value that does not, with the option's name and its range.
    pub(super) fn settings(&self) -> Result<Settings, Refusal> {
        let policy = self.chosen_policy();
        self.check_policy(policy)?;
        let settings = self
            .0
            .iter()
            .try_fold(SETTINGS, |settings, (place, value)| {
                settings.checked(*place, *value, &LIMITS)
            });
        let settings = settings.map_err(|refusal| refused(refusal.setting, refusal))?;
        check_period(&settings)?;
        Ok(settings)
    }

    /// Whether an option is given.
    pub(super) fn gives(&self, option: &str) -> bool {
        self.0
            .iter()
            .any(|(place, _)| named(*place) == Some(option))
    }

    /// Control runs by the clock.
    pub(super) fn is_by_clock(&self) -> bool {
        self.gives("rate") || self.chosen_policy() == Policy::Periodic
    }

    /// The policy, the configured one where none is given.
    pub(super) fn chosen_policy(&self) -> Policy {
        let settings = self.0.iter().fold(SETTINGS, |settings, (place, value)| {
            settings.with(*place, *value).unwrap_or(settings)
        });
        settings.policy
    }

    /// Refuses options of the policy that is not chosen.
    fn check_policy(&self, chosen: Policy) -> Result<(), Refusal> {
        let given = self
            .0
            .iter()
            .filter_map(|(place, _)| Settings::SETTINGS.get(*place));
        for setting in given {
            if let Some(policy) = setting.policy
                && policy != chosen
            {
                let line = format!(
                    "{} control has none, leave it out or use --policy {}",
                    chosen.word(),
                    policy.word()
                );
                return Err(refused(setting, line));
            }
        }
        Ok(())
    }
}

fn named(place: usize) -> Option<&'static str> {
    let [option, _] = Settings::SETTINGS.get(place)?.option?;
    Some(option)
}

/// A refusal in the name of a setting's option.
pub(super) fn refused(setting: &Setting, line: impl std::fmt::Display) -> Refusal {
    let [option, _] = setting.option.unwrap_or([setting.name; 2]);
    Refusal::new(format!("--{option}: {line}"))
}

fn milliseconds(span: Duration) -> f64 {
    span.ticks() as f64 / 1e3
}

/// Periodic control slower than the failsafe would be the failsafe's.
fn check_period(settings: &Settings) -> Result<(), Refusal> {
    if settings.policy == Policy::Periodic && settings.period + HYPERPERIOD > settings.failsafe {
        return Err(Refusal::new(format!(
            "--rate: a run every {} ms leaves the failsafe, every {} ms, no room; raise one of them",
            milliseconds(settings.period),
            milliseconds(settings.failsafe)
        )));
    }
    Ok(())
}

//! Which values are tried: the neighbours of those that are configured.
//!
//! The settings are those that reactive control has and a start may choose, as they are declared: a new one
//! is tried without a word here. Seeds, and what decides how long a flight is scored, are not.

use reflex::config::LIMITS;
use reflex::sensors::Input;
use reflex::settings::{Declared, Policy, Settings};
use reflex_settings::{Kind, Range, Setting, Value, Written};

/// A value that is tried in place of the configured one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trial {
    /// The table in `config/reactive.toml`, a dot between nested ones.
    pub section: String,
    /// The key in it.
    pub key: &'static str,
    /// As it is configured, in TOML.
    pub from: String,
    /// As it is tried, in TOML.
    pub to: String,
    /// Everything else as configured.
    pub settings: Settings,
}

/// Factors to the neighbours of an amount, and, squared, to those of the odds of a probability.
const FACTORS: [f64; 4] = [
    0.5,
    std::f64::consts::FRAC_1_SQRT_2,
    std::f64::consts::SQRT_2,
    2.0,
];

/// All trials of a configuration, in the order of the declarations.
pub(super) fn of(configured: &Settings) -> Vec<Trial> {
    let settings = Settings::SETTINGS.iter().enumerate();
    settings
        .filter(|(_, setting)| is_tuned(setting))
        .flat_map(|(place, setting)| of_setting(configured, place, setting))
        .collect()
}

/// A value of reactive control, or of both policies, that acts for the whole flight.
fn is_tuned(setting: &Setting) -> bool {
    let is_amount = matches!(
        setting.kind,
        Kind::Number(_) | Kind::Span(_) | Kind::Step { .. }
    );
    let is_choice = matches!(setting.kind, Kind::Word(_) | Kind::Inputs | Kind::Rate(_));
    let is_reactive = setting.policy == Some(Policy::Reactive);
    !setting.of_board && (is_amount || (is_choice && is_reactive))
}

fn of_setting(configured: &Settings, place: usize, setting: &'static Setting) -> Vec<Trial> {
    let Some(value) = configured.value(place) else {
        return Vec::new();
    };
    let trial = |tried: Value| {
        let settings = configured.checked(place, tried, &LIMITS).ok()?;
        (settings != *configured).then(|| Trial {
            section: setting.section.to_owned(),
            key: setting.key,
            from: in_toml(setting, value),
            to: in_toml(setting, tried),
            settings,
        })
    };
    match (setting.kind, value) {
        (Kind::Inputs, Value::Inputs(inputs)) => {
            let toggled = |input: Input| {
                let others = inputs.without(input);
                let was = inputs.contains(input);
                let tried = if was { others } else { inputs.with(input) };
                Some(Trial {
                    section: format!("{}.{}", setting.section, table_of(input)),
                    from: was.to_string(),
                    to: (!was).to_string(),
                    ..trial(Value::Inputs(tried))?
                })
            };
            Input::ALL.into_iter().filter_map(toggled).collect()
        }
        (Kind::Word(choices), Value::Word(_)) => (0..choices.variants.len() as u32)
            .filter_map(|word| trial(Value::Word(word)))
            .collect(),
        (kind, Value::Number(number)) => neighbours(kind, number)
            .into_iter()
            .filter_map(|number| trial(Value::Number(number)))
            .collect(),
        _ => Vec::new(),
    }
}

/// An input's table in the file.
fn table_of(input: Input) -> String {
    input.key().replace('-', "_")
}

/// The neighbours of a number, with as few digits as tell them apart.
fn neighbours(kind: Kind, number: f64) -> Vec<f64> {
    let is_probability = |range: Range| {
        let Range::Interval { low, high, .. } = range else {
            return false;
        };
        low >= 0.0 && high <= 1.0
    };
    FACTORS
        .into_iter()
        .map(|factor| match kind {
            Kind::Number(range) if is_probability(range) => {
                let odds = number / (1.0 - number) * factor * factor;
                near_certain(odds / (1.0 + odds))
            }
            Kind::Step { .. } => 1.0 / (factor / number).round(),
            _ => rounded(number * factor),
        })
        .collect()
}

/// A probability to two digits of what it lacks.
fn near_certain(probability: f64) -> f64 {
    let decimals = (1.0 - (1.0 - probability).log10().floor()).max(1.0) as usize;
    format!("{probability:.decimals$}")
        .parse()
        .unwrap_or(probability)
}

/// To two digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(number)
}

/// A value as it stands in the file.
fn in_toml(setting: &'static Setting, value: Value) -> String {
    match (setting.kind, value) {
        (Kind::Step { .. }, Value::Number(share)) => (1.0 / share).round().to_string(),
        (Kind::Word(_), value) => format!("{:?}", Written(setting, value).to_string()),
        (_, value) => Written(setting, value).to_string(),
    }
}

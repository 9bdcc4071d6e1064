//! Which settings a sweep varies, and through which values.

use std::fmt;

use reflex::config::{LIMITS, SETTINGS};
use reflex::settings::{Declared, Settings};
use reflex_settings::{Setting, Value};

use crate::scoring::{number, report_name};

/// A setting that a sweep can vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Probability of a changed command that calls for a run.
    PRun,
    /// Longest time between two runs, s.
    Failsafe,
    /// Change of a motor command that counts, as a share of full scale.
    Quantum,
}

impl Parameter {
    /// All of them, in the order of the command line's help.
    pub const ALL: [Self; 3] = [Self::PRun, Self::Failsafe, Self::Quantum];

    /// The declaration and its place.
    #[must_use]
    pub fn setting(self) -> (usize, &'static Setting) {
        let name = match self {
            Self::PRun => "p_run",
            Self::Failsafe => "failsafe",
            Self::Quantum => "quantum",
        };
        let mut settings = Settings::SETTINGS.iter().enumerate();
        settings
            .find(|(_, setting)| setting.name == name)
            .expect("a setting of this name")
    }

    /// The name, which is that of the option without its dashes.
    #[must_use]
    pub fn name(self) -> &'static str {
        let (_, setting) = self.setting();
        setting.option.map_or("", |[option, _]| option)
    }

    /// The name in a report, with the unit where there is one.
    #[must_use]
    pub fn key(self) -> String {
        report_name(self.setting().1)
    }

    /// What the settings hold of it: a share, for the failsafe seconds.
    #[must_use]
    pub fn value(self, settings: &Settings) -> f64 {
        let (place, setting) = self.setting();
        settings
            .value(place)
            .map_or(f64::NAN, |value| number(setting, value))
    }

    /// The settings with another value of it, as near as they can hold it.
    fn set(self, value: f64, settings: Settings) -> Settings {
        let (place, _) = self.setting();
        settings
            .with(place, Value::Number(value))
            .unwrap_or(settings)
    }

    /// What the firmware makes of a value.
    ///
    /// # Errors
    /// As the single option refuses it.
    fn checked(self, value: f64) -> Result<f64, String> {
        let (place, _) = self.setting();
        let settings = SETTINGS
            .checked(place, Value::Number(value), &LIMITS)
            .map_err(|refusal| refusal.to_string())?;
        Ok(self.value(&settings))
    }

    /// Equal ratios for what acts by its order of magnitude, equal steps for a probability.
    fn between(self, from: f64, to: f64, share: f64) -> f64 {
        match self {
            Self::PRun => from + (to - from) * share,
            Self::Failsafe | Self::Quantum => from * (to / from).powf(share),
        }
    }
}

/// One parameter with the values that it takes, ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    parameter: Parameter,
    values: Vec<f64>,
}

impl Axis {
    /// One value alone.
    ///
    /// # Errors
    /// A value that the single option would refuse, in its words.
    pub fn one(parameter: Parameter, value: f64) -> Result<Self, String> {
        let values = vec![parameter.checked(value)?];
        Ok(Self { parameter, values })
    }

    /// `count` values from `from` to `to`, both included.
    ///
    /// # Errors
    /// An end that the single option would refuse, ends that do not ascend, and values that the
    /// firmware could not tell apart.
    pub fn range(parameter: Parameter, from: f64, to: f64, count: usize) -> Result<Self, String> {
        let name = parameter.name();
        let ends = (parameter.checked(from)?, parameter.checked(to)?);
        if from >= to {
            return Err(if from > to {
                format!("must ascend, as in {name}={to}..{from}")
            } else {
                format!("is a single value, which is {name}={from}")
            });
        }
        let last = count.saturating_sub(1).max(1);
        let values: Result<Vec<f64>, String> = (0..=last)
            .map(|place| match place {
                0 => Ok(ends.0),
                _ if place == last => Ok(ends.1),
                _ => parameter.checked(parameter.between(from, to, place as f64 / last as f64)),
            })
            .collect();
        let values = values?;
        if values.is_sorted_by(|one, next| one < next) {
            Ok(Self { parameter, values })
        } else {
            Err(format!(
                "holds {count} values too close to tell apart, name fewer or a wider range"
            ))
        }
    }

    /// The parameter.
    #[must_use]
    pub const fn parameter(&self) -> Parameter {
        self.parameter
    }

    /// Its values, ascending.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.parameter.name();
        match self.values.as_slice() {
            [from, .., to] => write!(f, "{name}={from}..{to}/{}", self.values.len()),
            [value] => write!(f, "{name}={value}"),
            [] => f.write_str(name),
        }
    }
}

/// Every combination of the values of some parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
}

/// Points that a grid has at most: more is a slip of the finger.
const MOST_POINTS: usize = 10_000;

impl Grid {
    /// The grid over some parameters.
    ///
    /// # Errors
    /// No parameter, the same one twice, or more than 10 000 points.
    pub fn new(axes: Vec<Axis>) -> Result<Self, String> {
        if axes.is_empty() {
            return Err("names no parameter".to_owned());
        }
        for (place, axis) in axes.iter().enumerate() {
            let before = axes.iter().take(place);
            if before
                .into_iter()
                .any(|other| other.parameter == axis.parameter)
            {
                return Err(format!(
                    "{} is named twice, name it once",
                    axis.parameter.name()
                ));
            }
        }
        let points: usize = axes.iter().map(|axis| axis.values.len()).product();
        if points > MOST_POINTS {
            return Err(format!(
                "{points} points are more than {MOST_POINTS}, name fewer values with NAME=A..B/N"
            ));
        }
        Ok(Self { axes })
    }

    /// The parameters, in the order in which they were named.
    #[must_use]
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Whether a parameter is varied, or at least named.
    #[must_use]
    pub fn names(&self, parameter: Parameter) -> bool {
        self.axes.iter().any(|axis| axis.parameter == parameter)
    }

    /// The settings of every point; the parameter named last varies fastest.
    #[must_use]
    pub fn settings(&self, base: Settings) -> Vec<Settings> {
        self.axes.iter().fold(vec![base], |points, axis| {
            let with_each = |point: Settings| {
                let values = axis.values.iter();
                values.map(move |value| axis.parameter.set(*value, point))
            };
            points.into_iter().flat_map(with_each).collect()
        })
    }
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, axis) in self.axes.iter().enumerate() {
            let comma = if place > 0 { "," } else { "" };
            write!(f, "{comma}{axis}")?;
        }
        Ok(())
    }
}

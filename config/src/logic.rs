//! `logics/*.toml`: the gains of every control logic; lists are roll, pitch, yaw.
//!
//! What a file must hold is a table of [`Gain`] in `logics.rs`: the checks and the constants of
//! the firmware both come from it.

use std::path::Path;

use reflex_settings::Range;
use toml::Value;

use crate::document::Document;
use crate::logics::LOGICS;
use crate::{ConfigError, names_in};

/// One gain: where it stands, what it may be and what it means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gain {
    pub section: &'static str,
    pub key: &'static str,
    /// The constant's name, where it is not `SECTION_KEY`.
    pub name: Option<&'static str>,
    pub shape: Shape,
    /// Holds for each axis.
    pub range: Range,
    pub unit: &'static str,
    pub meaning: &'static str,
    /// The power of the loops' bandwidth that it grows with; 0 for what is no gain of them.
    pub growth: i32,
}

/// How many numbers a gain has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    Number,
    /// Three: roll, pitch, yaw.
    Axes,
}

impl Gain {
    /// The name of its constant.
    pub(crate) fn constant(&self) -> String {
        self.name.map_or_else(
            || format!("{}_{}", self.section, self.key).to_uppercase(),
            str::to_owned,
        )
    }

    /// Its documentation: meaning, unit, range.
    pub(crate) fn doc(&self) -> String {
        let Self { meaning, unit, .. } = self;
        let order = match self.shape {
            Shape::Number => "",
            Shape::Axes => "; roll, pitch, yaw",
        };
        format!("{meaning}, in {unit}, {}{order}.", self.range)
    }

    /// The numbers of a value of the file, or what is wrong with it.
    fn numbers(&self, value: &Value) -> Result<Vec<f64>, String> {
        let numbers = match (self.shape, value) {
            (Shape::Axes, Value::Array(list)) if list.len() == 3 => {
                list.iter().map(number).collect::<Option<_>>()
            }
            (Shape::Axes, Value::Array(list)) => {
                return Err(format!(
                    "invalid length {}, must be a list of three numbers: roll, pitch, yaw",
                    list.len()
                ));
            }
            (Shape::Axes, _) => None,
            (Shape::Number, value) => number(value).map(|number| vec![number]),
        };
        let Some(numbers) = numbers else {
            let wanted = match self.shape {
                Shape::Number => "a number",
                Shape::Axes => "a list of three numbers: roll, pitch, yaw",
            };
            return Err(format!("invalid type, must be {wanted}"));
        };
        if numbers.iter().all(|&number| self.range.contains(number)) {
            return Ok(numbers);
        }
        let each = match self.shape {
            Shape::Number => "",
            Shape::Axes => "each ",
        };
        Err(format!(
            "{} is out of range, must be {each}{} {}",
            one_line(value),
            self.range,
            self.unit
        ))
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

fn one_line(value: &Value) -> String {
    value.to_string().replace('\n', " ")
}

/// The checked gains of one control logic.
#[derive(Clone, Debug, PartialEq)]
pub struct Logic {
    /// Name of its file, without `.toml`.
    pub name: &'static str,
    /// Each gain and its one number or three.
    pub(crate) values: Vec<(Gain, Vec<f64>)>,
}

/// Reads and checks every control logic, whether it is selected or not.
pub(crate) fn load_all(dir: &Path) -> Result<Vec<Logic>, ConfigError> {
    let known = |name: &String| LOGICS.iter().any(|(logic, _)| logic == name);
    let names = names_in(dir, "logics").unwrap_or_default();
    if let Some(stranger) = names.iter().find(|name| !known(name)) {
        let file = dir.join("logics").join(format!("{stranger}.toml"));
        let message =
            "no control logic of this name: config/src/logics.rs has no table of its gains";
        return Err(ConfigError::of_file(&file, message));
    }
    LOGICS
        .iter()
        .map(|(name, gains)| {
            let file = dir.join("logics").join(format!("{name}.toml"));
            Logic::read(name, gains, &Document::open(&file)?)
        })
        .collect()
}

impl Logic {
    /// The same loops, so many times as fast.
    ///
    /// # Errors
    /// A gain that leaves its range, with the number it would come to.
    pub(crate) fn quicken(&mut self, bandwidth: f64) -> Result<(), String> {
        for (gain, numbers) in self.values.iter_mut().filter(|value| value.0.growth != 0) {
            let factor = bandwidth.powi(gain.growth);
            for number in numbers {
                *number *= factor;
                if !gain.range.contains(*number) {
                    let Gain { section, key, .. } = gain;
                    return Err(format!(
                        "{bandwidth} brings {}'s {section}.{key} to {number}, must be {}",
                        self.name, gain.range
                    ));
                }
            }
        }
        Ok(())
    }

    fn read(name: &'static str, gains: &[Gain], document: &Document) -> Result<Self, ConfigError> {
        let content: toml::Table = document.parse()?;
        no_strangers(gains, &content, document)?;
        let value = |gain: &Gain| {
            let path = [gain.section, gain.key];
            let section = content
                .get(gain.section)
                .ok_or_else(|| document.error_at(&[gain.section], "section is missing"))?;
            let value = section.get(gain.key).ok_or_else(|| {
                document.error_at(&[gain.section], format!("missing key `{}`", gain.key))
            })?;
            let numbers = gain
                .numbers(value)
                .map_err(|message| document.error_at(&path, message))?;
            Ok((*gain, numbers))
        };
        let values = gains.iter().map(value).collect::<Result<_, _>>()?;
        Ok(Self { name, values })
    }
}

/// No section and no key that the table does not have.
fn no_strangers(
    gains: &[Gain],
    content: &toml::Table,
    document: &Document,
) -> Result<(), ConfigError> {
    for (section, keys) in content {
        let known: Vec<&Gain> = gains
            .iter()
            .filter(|gain| gain.section == section)
            .collect();
        if known.is_empty() {
            let expected = listed(gains.iter().map(|gain| gain.section));
            return Err(document.error_at(&[section], format!("unknown section, {expected}")));
        }
        let Some(keys) = keys.as_table() else {
            return Err(document.error_at(&[section], "invalid type, must be a section"));
        };
        for key in keys.keys() {
            if !known.iter().any(|gain| gain.key == key) {
                let expected = listed(known.iter().map(|gain| gain.key));
                return Err(document.error_at(&[section, key], format!("unknown key, {expected}")));
            }
        }
    }
    Ok(())
}

fn listed(names: impl Iterator<Item = &'static str>) -> String {
    let mut names: Vec<&str> = names.collect();
    names.dedup();
    format!("must be one of: {}", names.join(", "))
}

//! `logics/*.toml`: the gains of every control logic; lists are roll, pitch, yaw.
//!
//! What a file must hold is declared in `settings/src/gains/`.

use std::path::Path;

use reflex_settings::gains::{Gain, LOGICS, LogicGains, OutOfRange};
use toml::Value;

use crate::document::Document;
use crate::{ConfigError, names_in};

/// The checked gains of one control logic.
#[derive(Clone, Debug, PartialEq)]
pub struct Logic {
    /// What its file may say.
    pub declared: &'static LogicGains,
    /// The numbers of all its gains, one after the other.
    pub numbers: Vec<f64>,
}

/// Reads and checks every control logic, whether it is selected or not.
pub(crate) fn load_all(dir: &Path) -> Result<Vec<Logic>, ConfigError> {
    let known = |name: &String| LOGICS.iter().any(|logic| logic.logic == name);
    let names = names_in(dir, "logics").unwrap_or_default();
    if let Some(stranger) = names.iter().find(|name| !known(name)) {
        let file = dir.join("logics").join(format!("{stranger}.toml"));
        let message = "no control logic of this name: settings/src/logics.rs does not list it";
        return Err(ConfigError::of_file(&file, message));
    }
    let read = |declared: &'static LogicGains| {
        let file = dir.join("logics").join(format!("{}.toml", declared.logic));
        Logic::read(declared, &Document::open(&file)?)
    };
    LOGICS.iter().map(read).collect()
}

impl Logic {
    /// Each gain and its one number or three.
    pub(crate) fn gains(&self) -> impl Iterator<Item = (&'static Gain, &[f64])> {
        let mut left = self.numbers.as_slice();
        self.declared.gains.iter().map(move |gain| {
            let (numbers, rest) = left.split_at(gain.default.len());
            left = rest;
            (gain, numbers)
        })
    }

    /// The same loops, so many times as fast.
    ///
    /// # Errors
    /// A gain that leaves its range, with the number that it would be.
    pub(crate) fn quicken(&mut self, bandwidth: f64) -> Result<(), String> {
        let quickened = self.declared.quicken(&mut self.numbers, bandwidth);
        quickened.map_err(|OutOfRange { gain, number }| {
            let (
                logic,
                Gain {
                    section,
                    key,
                    range,
                    ..
                },
            ) = (self.declared.logic, gain);
            format!("{bandwidth} brings {logic}'s {section}.{key} to {number}, must be {range}")
        })
    }

    fn read(declared: &'static LogicGains, document: &Document) -> Result<Self, ConfigError> {
        let content: toml::Table = document.parse()?;
        no_strangers(declared.gains, &content, document)?;
        let mut all = Vec::new();
        for gain in declared.gains {
            let path = [gain.section, gain.key];
            let section = content
                .get(gain.section)
                .ok_or_else(|| document.error_at(&[gain.section], "section is missing"))?;
            let value = section.get(gain.key).ok_or_else(|| {
                document.error_at(&[gain.section], format!("missing key `{}`", gain.key))
            })?;
            let numbers =
                numbers(gain, value).map_err(|message| document.error_at(&path, message))?;
            all.extend(numbers);
        }
        Ok(Self {
            declared,
            numbers: all,
        })
    }
}

/// The numbers of a value of the file, or what is wrong with it.
fn numbers(gain: &Gain, value: &Value) -> Result<Vec<f64>, String> {
    let axes = gain.default.len();
    let numbers = match value {
        Value::Array(list) if axes > 1 && list.len() == axes => {
            list.iter().map(number).collect::<Option<_>>()
        }
        Value::Array(list) if axes > 1 => {
            return Err(format!(
                "invalid length {}, must be a list of three numbers: roll, pitch, yaw",
                list.len()
            ));
        }
        value if axes == 1 => number(value).map(|number| vec![number]),
        _ => None,
    };
    let (wanted, each) = if axes == 1 {
        ("a number", "")
    } else {
        ("a list of three numbers: roll, pitch, yaw", "each ")
    };
    let Some(numbers) = numbers else {
        return Err(format!("invalid type, must be {wanted}"));
    };
    if numbers.iter().all(|&number| gain.range.contains(number)) {
        return Ok(numbers);
    }
    Err(format!(
        "{} is out of range, must be {each}{} {}",
        one_line(value),
        gain.range,
        gain.unit
    ))
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

/// No section and no key that is not declared.
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

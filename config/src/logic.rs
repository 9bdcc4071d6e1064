//! `logics/*.toml`: the gains of every control logic; lists are roll, pitch, yaw.
//!
//! What a file must hold is declared in `settings/src/gains/`. A file of `logics/NAME/` is a
//! variation of `logics/NAME.toml`: it says only what differs from that.

use std::path::{Path, PathBuf};

use reflex_settings::Value;
use reflex_settings::gains::{LOGICS, LogicGains, OutOfRange};

use crate::document::Document;
use crate::values::{Values, schema};
use crate::{ConfigError, names_in, selected_file};

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
    let load = |declared| Logic::load(dir, declared);
    LOGICS.iter().map(load).collect()
}

impl Logic {
    /// Reads and checks the gains of one control logic, from the folder of the configuration.
    ///
    /// # Errors
    /// The first thing that is wrong with its file.
    pub fn load(dir: &Path, declared: &'static LogicGains) -> Result<Self, ConfigError> {
        let file = dir.join("logics").join(format!("{}.toml", declared.logic));
        let values = Document::open(&file)?.values(&schema(declared.gains))?;
        let numbers = values.0.iter().flat_map(|(_, _, value)| numbers_of(value));
        Ok(Self {
            declared,
            numbers: numbers.collect(),
        })
    }

    /// Takes over what a variation says otherwise.
    ///
    /// # Errors
    /// The first thing that is wrong with its file.
    pub fn vary(&mut self, file: &Path) -> Result<(), ConfigError> {
        let varied = Document::open(file)?.some_values(&schema(self.declared.gains))?;
        let mut numbers = self.numbers.as_mut_slice();
        for gain in self.declared.gains {
            let (own, behind) = numbers.split_at_mut(gain.kind.numbers());
            if let Some(value) = varied.at(&gain.path().to_string()) {
                own.copy_from_slice(&numbers_of(&value));
            }
            numbers = behind;
        }
        Ok(())
    }

    /// The file of a variation of some name.
    ///
    /// # Errors
    /// An unknown name, with those that are known.
    pub fn variation(
        dir: &Path,
        declared: &'static LogicGains,
        name: &str,
    ) -> Result<PathBuf, String> {
        let logic = declared.logic;
        match Self::variations(dir, declared).as_slice() {
            [] => Err(format!("logics/{logic}/ holds no gains, name a file")),
            _ => selected_file(dir, &format!("logics/{logic}"), name),
        }
    }

    /// The names of a control logic's variations, in order.
    #[must_use]
    pub fn variations(dir: &Path, declared: &'static LogicGains) -> Vec<String> {
        names_in(dir, &format!("logics/{}", declared.logic)).unwrap_or_default()
    }

    /// Each gain and its value.
    pub(crate) fn gains(&self) -> Values {
        let mut numbers = self.numbers.iter().copied();
        let gains = self.declared.gains.iter().map(|gain| {
            let mut next = || numbers.next().unwrap_or_default();
            let value = match gain.kind.numbers() {
                3 => Value::Axes([next(), next(), next()]),
                _ => Value::Number(next()),
            };
            (gain.path().to_string(), gain, value)
        });
        Values(gains.collect())
    }

    /// The same loops, so many times as fast.
    ///
    /// # Errors
    /// A gain that leaves its range, with the number that it would be.
    pub fn quicken(&mut self, bandwidth: f64) -> Result<(), String> {
        let quickened = self.declared.quicken(&mut self.numbers, bandwidth);
        quickened.map_err(
            |OutOfRange {
                 gain,
                 number,
                 range,
             }| {
                let (logic, path) = (self.declared.logic, gain.path());
                format!("{bandwidth}: brings {logic}'s {path} to {number}, must be {range}")
            },
        )
    }
}

/// The numbers of a gain.
fn numbers_of(value: &Value) -> Vec<f64> {
    match value {
        Value::Axes(axes) => axes.to_vec(),
        Value::Number(number) => vec![*number],
        _ => Vec::new(),
    }
}

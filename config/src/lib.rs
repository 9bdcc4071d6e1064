//! Typed, checked reading of the TOML that users edit.
//!
//! `selection.toml` names a board, an airframe and a control logic, `reactive.toml` says when
//! control runs, `safety.toml` what ends a flight. The build of `reflex` turns them into constants ([`Configuration::to_rust`]),
//! so that the target parses nothing. Every value has one range, checked as it is read; an
//! unknown key, a wrong type or a value out of its range is one line with file, line and key.

mod airframe;
mod board;
mod document;
mod environment;
mod error;
mod logic;
mod range;
mod reactive;
mod rust;
mod safety;
mod values;
mod vehicle;

use std::path::{Path, PathBuf};

use reflex_settings::Settings;
use serde::Deserialize;

pub use airframe::{Airframe, Motor, Spin};
pub use document::Document;
pub use error::ConfigError;
pub use logic::Logic;
pub use values::Values;

pub mod plant {
    //! What is simulated: drones as bodies, and where they fly.

    pub use crate::environment::{Environment, Gusts, Shelter, Tracking, Wind};
    pub use crate::vehicle::{
        Battery, Drag, Esc, Gyroscope, Magnetometer, Rotors, Skids, Vehicle, Vibration,
    };
}

use reactive::Files;

/// Which product is built: the content of `selection.toml`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    /// Name of a file in `boards/`, without `.toml`.
    pub board: String,
    /// Name of a file in `airframes/`, without `.toml`.
    pub airframe: String,
    /// Name of a file in `logics/`, without `.toml`.
    pub logic: String,
}

/// Everything a user configured, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Which product is built.
    pub selection: Selection,
    /// What may be chosen at each start.
    pub settings: Settings,
    /// When control runs, and how it learns when to.
    pub reactive: Values,
    /// When motors may turn, and what ends a flight.
    pub safety: Values,
    /// What may vary on the board's wiring.
    pub board: Values,
    /// Where the motors are.
    pub airframe: Airframe,
    /// The gains of every control logic, selected or not.
    pub logics: Vec<Logic>,
}

impl Configuration {
    /// Least common multiple of the gating inputs' periods, in us.
    #[must_use]
    pub fn hyperperiod_us(&self) -> u64 {
        self.files().hyperperiod_us()
    }

    fn files(&self) -> Files<'_> {
        Files {
            reactive: &self.reactive,
            board: &self.board,
        }
    }
}

/// Reads and checks the configuration in a folder.
///
/// # Errors
/// The first thing that is wrong: a file that cannot be read, an unknown or missing key, a wrong
/// type, a value out of its range.
pub fn load(dir: &Path) -> Result<Configuration, ConfigError> {
    load_chosen(dir, |_| None)
}

/// As [`load`]; `REFLEX_BOARD`, `REFLEX_AIRFRAME` and `REFLEX_LOGIC` come before the selection.
/// `variable` is asked for the value of each; none, or an empty one, leaves the file's choice.
///
/// # Errors
/// As [`load`]; what a variable says wrong is said of that variable.
pub fn load_chosen(
    dir: &Path,
    variable: impl Fn(&str) -> Option<String>,
) -> Result<Configuration, ConfigError> {
    let selecting = Document::open(&dir.join("selection.toml"))?;
    let mut selection: Selection = selecting.parse()?;
    let selected = |key: &str, folder: &str, name: &mut String| {
        let variable_name = format!("REFLEX_{}", key.to_uppercase());
        let chosen = variable(&variable_name).filter(|chosen| !chosen.is_empty());
        let overrides = chosen.is_some();
        *name = chosen.unwrap_or_else(|| name.clone());
        let file = selected_file(dir, folder, name).map_err(|message| {
            if overrides {
                ConfigError::of_file(Path::new(&variable_name), message)
            } else {
                selecting.error_at(key, message)
            }
        })?;
        Document::open(&file)
    };

    let board_file = selected("board", "boards", &mut selection.board)?;
    let board = board_file.values(&board::file())?;
    board::check(&board_file, &board)?;

    let document = selected("airframe", "airframes", &mut selection.airframe)?;
    let airframe: Airframe = document.parse()?;
    airframe.check(&document)?;

    selected("logic", "logics", &mut selection.logic)?;
    let logics = logic::load_all(dir)?;

    let document = Document::open(&dir.join("reactive.toml"))?;
    let reactive = document.values(&reactive::file())?;
    let files = Files {
        reactive: &reactive,
        board: &board,
    };
    files.check(&document, &board_file)?;
    let safety = Document::open(&dir.join("safety.toml"))?.values(&safety::file())?;
    let settings = files
        .settings()
        .ok_or_else(|| ConfigError::of_file(dir, "a setting has a value of another kind"))?;

    Ok(Configuration {
        selection,
        settings,
        reactive,
        safety,
        board,
        airframe,
        logics,
    })
}

/// The file that a name selects, or what could be selected instead.
fn selected_file(dir: &Path, folder: &str, name: &str) -> Result<PathBuf, String> {
    let names = names_in(dir, folder)?;
    if names.iter().any(|known| known == name) {
        Ok(dir.join(folder).join(format!("{name}.toml")))
    } else {
        let names = names.join(", ");
        Err(format!(
            "{folder}/{name}.toml does not exist, must be one of: {names}"
        ))
    }
}

/// The files of a folder in order, without `.toml`.
fn names_in(dir: &Path, folder: &str) -> Result<Vec<String>, String> {
    let mut names: Vec<String> = std::fs::read_dir(dir.join(folder))
        .map_err(|error| format!("{} cannot be read: {error}", dir.join(folder).display()))?
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            name.strip_suffix(".toml").map(str::to_owned)
        })
        .collect();
    names.sort();
    Ok(names)
}

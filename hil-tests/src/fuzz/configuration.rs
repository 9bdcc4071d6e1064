//! What users write: files of `config/`, gains, values on a command line.

use std::collections::BTreeMap;
use std::path::Path;
use std::{fs, io};

use clap::ValueEnum;
use recorded_flights::Rotation;
use reflex::config::LIMITS;
use reflex::settings::Settings;
use reflex_config::ConfigError;
use reflex_config::plant::{Environment, Tracking, Vehicle};
use reflex_settings::{Declared, Kind};
use tempfile::TempDir;

use super::samples::{self, Sample};
use super::{Loaded, Source, Target, is_one_line};
use crate::logics::{GainSet, LogicName};
use crate::toolchain;

pub(super) const CONFIGURATION: Target = Target {
    name: "configuration",
    reads: "the files of config/",
    inputs: 4_000,
    load: || {
        let config = toolchain::root().join("config");
        let files = samples::files(&config)?.into_iter();
        let files: Vec<_> = files.filter(|(name, _)| is_checked(name)).collect();
        let copy = Copy::of(&files)?;
        let sound = files
            .iter()
            .map(|(name, content)| Sample::named(name, content));
        let source = Source::Spoilt(sound.collect());
        Ok(Loaded::new(source, move |input| {
            check_configuration(&copy, input)
        }))
    },
};

pub(super) const GAINS: Target = Target {
    name: "gains",
    reads: "variations of gains",
    inputs: 8_000,
    load: || {
        let logics = LogicName::value_variants().iter().map(|logic| logic.word());
        let folder = toolchain::root().join("config/logics");
        let own = logics.map(|logic| {
            let content = std::fs::read(folder.join(format!("{logic}.toml")))?;
            Ok(Sample::named(logic, &content))
        });
        let source = Source::Spoilt(own.collect::<std::io::Result<_>>()?);
        let file = tempfile::Builder::new().suffix(".toml").tempfile()?;
        Ok(Loaded::new(source, move |input| {
            check_gains(file.path(), input)
        }))
    },
};

pub(super) const OPTIONS: Target = Target {
    name: "options",
    reads: "values of settings on a command line",
    inputs: 100_000,
    load: || {
        let settings = Settings::SETTINGS.iter();
        let sound = settings.map(|setting| {
            let text = match setting.kind {
                Kind::Inputs => "all",
                Kind::Step { .. } => "1/255",
                _ => setting.default,
            };
            Sample::named(setting.name, text.as_bytes())
        });
        let rotation = Sample::named(ROTATION, b"roll180yaw90");
        let source = Source::Spoilt(sound.chain([rotation]).collect());
        Ok(Loaded::new(source, check_option))
    },
};

const ROTATION: &str = "rotation";

/// The files that a build or a simulation reads as a whole.
fn is_checked(name: &str) -> bool {
    let is_variation = name.starts_with("logics/") && name.matches('/').count() > 1;
    let is_source = ["src/", "tests/", "Cargo"]
        .iter()
        .any(|start| name.starts_with(start));
    name.ends_with(".toml") && !is_variation && !is_source
}

/// A copy of the configuration, of which one file at a time is another.
struct Copy {
    folder: TempDir,
    files: BTreeMap<String, Vec<u8>>,
}

impl Copy {
    fn of(files: &[(String, Vec<u8>)]) -> io::Result<Self> {
        let folder = tempfile::tempdir()?;
        for (name, content) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap_or(folder.path()))?;
            fs::write(path, content)?;
        }
        let files = files.iter().cloned().collect();
        Ok(Self { folder, files })
    }
}

/// Reads the configuration with one file replaced.
fn check_configuration(copy: &Copy, input: &[u8]) -> bool {
    let named = samples::name_of(input);
    let Some((name, content)) = named.filter(|(name, _)| copy.files.contains_key(*name)) else {
        return false;
    };
    let file = copy.folder.path().join(name);
    fs::write(&file, content).expect("a temporary file");
    let read = read(copy.folder.path(), name);
    fs::write(&file, &copy.files[name]).expect("a temporary file");
    read.inspect_err(|error| is_one_line(&error.to_string()))
        .is_ok()
}

/// Reads what a file is part of.
fn read(folder: &Path, name: &str) -> Result<(), ConfigError> {
    let stem = Path::new(name)
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let kind = name.split('/').next().unwrap_or_default();
    match kind {
        "environments" => Environment::load(folder, &stem).map(drop),
        "positions" => Tracking::load(folder, &stem).map(drop),
        "vehicles" => Vehicle::load(folder, &stem).map(drop),
        _ => {
            let chosen = |variable: &str| match (kind, variable) {
                ("boards", "REFLEX_BOARD") | ("airframes", "REFLEX_AIRFRAME") => {
                    Some(stem.to_string())
                }
                _ => None,
            };
            let source = reflex_config::load_chosen(folder, chosen)?.to_rust();
            assert!(
                syn::parse_file(&source).is_ok(),
                "what is built from it is no Rust:\n{source}"
            );
            Ok(())
        }
    }
}

fn check_gains(file: &Path, input: &[u8]) -> bool {
    let logic = samples::name_of(input);
    let logic =
        logic.and_then(|(name, content)| Some((LogicName::from_str(name, false).ok()?, content)));
    let Some((logic, content)) = logic else {
        return false;
    };
    fs::write(file, content).expect("a temporary file");
    let name = file.to_string_lossy();
    let read = GainSet::load(logic, Some(&name), 1.0);
    read.inspect_err(|refusal| is_one_line(&refusal.to_string()))
        .is_ok()
}

fn check_option(input: &[u8]) -> bool {
    let text = samples::name_of(input);
    let text = text.and_then(|(name, value)| Some((name, std::str::from_utf8(value).ok()?)));
    let Some((name, text)) = text else {
        return false;
    };
    if name == ROTATION {
        return text
            .parse::<Rotation>()
            .inspect_err(|error| is_one_line(&error.to_string()))
            .is_ok();
    }
    let Some(place) = Settings::place(name) else {
        return false;
    };
    let setting = &Settings::SETTINGS[place];
    match setting.parse(text) {
        Ok(value) => setting
            .check(value, Some(&LIMITS))
            .inspect_err(|error| is_one_line(&error.to_string()))
            .is_ok(),
        Err(unreadable) => {
            is_one_line(&unreadable.to_string());
            false
        }
    }
}

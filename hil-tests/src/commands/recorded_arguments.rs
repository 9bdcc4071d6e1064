//! The arguments that say which recorded flight is replayed, and how.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use reflex::config;
use reflex::settings::{Policy, Settings, WarmUp};

use super::logic_arguments::LogicArguments;
use super::quantities::number;
use super::settings_arguments::SettingsArguments;
use crate::refusal::Refusal;
use crate::replay::options::ReplayOptions;
use recorded_flights::Rotate;

/// What is replayed. Defaults are those of `config/`; no option needs a rebuild.
#[derive(Clone, Debug, Args)]
pub(super) struct RecordedArguments {
    /// Recorded flight, ULog or CSV [default: the one that comes with the crate ulog-rs]
    #[arg(value_name = "LOG")]
    logs: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) settings: SettingsArguments,
    #[command(flatten)]
    logic: LogicArguments,
    /// Most of the flight to replay, in s
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// How the log's axes lie in the body's: auto, none, or such as roll180yaw90
    #[arg(long, value_name = "ROTATION", default_value = "auto")]
    rotate: Rotate,
    /// Noise that the emulated sensors add
    #[arg(long, value_enum, default_value = "datasheet")]
    noise: NoiseName,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum NoiseName {
    None,
    Datasheet,
}

impl RecordedArguments {
    /// The log, where one is named.
    ///
    /// # Errors
    /// Several are.
    pub(super) fn log(&self) -> Result<Option<&Path>, Refusal> {
        match self.logs.as_slice() {
            [] => Ok(None),
            [log] => Ok(Some(log)),
            [first, second, ..] => Err(Refusal::new(format!(
                "{} and {}: one log at a time",
                first.display(),
                second.display()
            ))),
        }
    }

    /// The options, once every mix of arguments is checked.
    ///
    /// # Errors
    /// The first mix or value that does not, with the option's name and its range.
    pub(super) fn options(&self) -> Result<ReplayOptions, Refusal> {
        let log = self.log()?;
        let settings = self.settings.settings()?;
        self.check_duration(&settings)?;
        Ok(ReplayOptions {
            log: log.map(Path::to_owned),
            settings,
            gains: self.logic.gains(1.0)?,
            duration_s: self.duration,
            rotate: self.rotate,
            noise: self.noise == NoiseName::Datasheet,
            ..ReplayOptions::default()
        })
    }

    /// A replay has a length, and something is left of it after the warm-up.
    fn check_duration(&self, settings: &Settings) -> Result<(), Refusal> {
        let Some(length) = self.duration else {
            return Ok(());
        };
        if length <= 0.0 {
            return Err(Refusal::new(format!(
                "--duration {length}: must be above 0 s"
            )));
        }
        let (warm_up, name) = match (settings.policy, settings.warm_up) {
            (Policy::Periodic, _) => return Ok(()),
            (_, WarmUp::Automatic) => {
                (config::SHORTEST_WARM_UP, "automatic warm-up lasts at least")
            }
            (_, WarmUp::Fixed(warm_up)) => (warm_up, "warm-up lasts"),
        };
        let warm_up_s = warm_up.ticks() as f64 / 1e6;
        if length <= warm_up_s {
            return Err(Refusal::new(format!(
                "--duration {length}: nothing would be left to measure, the {name} {warm_up_s} s"
            )));
        }
        Ok(())
    }
}

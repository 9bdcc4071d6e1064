//! The arguments of `cargo hil replay`, and which of them go together.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use reflex::config;
use reflex::settings::{Policy, Settings, WarmUp};

use super::logic_arguments::LogicArguments;
use super::quantities::number;
use super::settings_arguments::SettingsArguments;
use super::sweep_arguments::SweepArguments;
use crate::output_file::OutputFile;
use crate::refusal::Refusal;
use crate::replay::options::ReplayOptions;
use crate::sweep::{Parameter, SweepOptions};
use recorded_flights::Rotate;

/// The options of a replay. Defaults are those of `config/`; no option needs a rebuild.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct ReplayArguments {
    /// Recorded flight, ULog or CSV, or a folder of them with --sweep [default: the one that comes with the crate ulog-rs]
    #[arg(value_name = "LOG")]
    logs: Vec<PathBuf>,
    #[command(flatten)]
    settings: SettingsArguments,
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
    /// Fly the same control logic on this computer, without firmware and emulator: 100 times as fast
    #[arg(long)]
    pub(super) native: bool,
    #[command(flatten)]
    pub(super) sweep: SweepArguments,
    /// Write the firmware's decoded log to this file
    #[arg(long, value_name = "FILE")]
    defmt: Option<PathBuf>,
    /// Print the report as one JSON object instead of a summary
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum NoiseName {
    None,
    #[default]
    Datasheet,
}

impl ReplayArguments {
    /// The options, once every mix of arguments is checked.
    ///
    /// # Errors
    /// The first mix or value that does not, with the option's name and its range.
    pub(super) fn options(&self) -> Result<ReplayOptions, Refusal> {
        let log = match self.logs.as_slice() {
            [] => None,
            [log] => Some(log.clone()),
            [first, second, ..] => {
                return Err(Refusal::new(format!(
                    "{} and {}: one log at a time",
                    first.display(),
                    second.display()
                )));
            }
        };
        self.check_sweep(log.as_deref())?;
        let settings = self.settings.settings()?;
        self.check_duration(&settings)?;
        if let Some(file) = &self.defmt {
            let native = match (&self.sweep.sweep, self.native) {
                (Some(_), _) => "--sweep, which is native",
                (None, true) => "--native",
                (None, false) => "",
            };
            if !native.is_empty() {
                return Err(Refusal::new(format!(
                    "--defmt {}: only the firmware writes a log, leave out {native}",
                    file.display()
                )));
            }
            let file = OutputFile::new("defmt", file);
            file.check()?;
            if let Some(log) = &log {
                file.check_is_not(log)?;
            }
        }
        Ok(ReplayOptions {
            log,
            settings,
            gains: self.logic.gains(1.0)?,
            duration_s: self.duration,
            rotate: self.rotate,
            noise: self.noise == NoiseName::Datasheet,
            defmt: self.defmt.clone(),
        })
    }

    /// The options of a sweep, where one is asked for.
    ///
    /// # Errors
    /// As [`ReplayArguments::options`].
    pub(super) fn sweep_options(&self) -> Result<Option<SweepOptions>, Refusal> {
        let Some(grid) = self.sweep.sweep.clone() else {
            return Ok(None);
        };
        Ok(Some(SweepOptions {
            replay: self.options()?,
            grid,
            threads: 0,
        }))
    }

    fn check_sweep(&self, log: Option<&Path>) -> Result<(), Refusal> {
        let single = [
            (Parameter::PRun, self.settings.gives("p-run")),
            (Parameter::Failsafe, self.settings.gives("failsafe")),
            (Parameter::Quantum, self.settings.gives("quantum")),
        ];
        let by_clock = self.settings.is_by_clock();
        self.sweep.check(log, &single, by_clock)
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

#[cfg(test)]
mod tests;

//! The arguments of `cargo hil replay`, and which of them make sense together.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use reflex::config;
use reflex::sensors::Inputs;
use reflex::settings::{
    Feedback, MotorProtocol, Pairs, Policy, Reference, Settings, SettingsError, WarmUp,
};
use reflex::time::Duration;

use super::quantities::{duration, inputs, number, share, warm_up};
use super::sweep_arguments::SweepArguments;
use crate::flights::Rotate;
use crate::logics::LogicName;
use crate::refusal::Refusal;
use crate::replay_options::ReplayOptions;
use crate::sweep::{Parameter, SweepOptions};

/// What a replay is told. Defaults are those of `config/`; no option needs a rebuild.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct ReplayArguments {
    /// Recorded flight, ULog or CSV, or a folder of them with --sweep [default: the one that comes with the crate ulog-rs]
    #[arg(value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// When control runs: when a sensor's change calls for it, or time-triggered
    #[arg(long, value_enum)]
    policy: Option<PolicyName>,
    /// Control logic that flies: the firmware is built with it [default: that of config/selection.toml]
    #[arg(long, value_enum)]
    logic: Option<LogicName>,
    /// Runs per second of the periodic policy, 1 to 1000
    #[arg(long, value_name = "HZ", value_parser = number, allow_negative_numbers = true)]
    rate: Option<f64>,
    /// What a change is measured against
    #[arg(long, value_enum)]
    reference: Option<ReferenceName>,
    /// Inputs that may ask for a run: `all`, or of gyro, accel, chip-accel, chip-mag, turned, command
    #[arg(long, value_name = "INPUT,...", value_parser = inputs)]
    triggers: Option<Inputs>,
    /// Pairs of samples that the warm-up learns from
    #[arg(long, value_enum)]
    pairs: Option<PairsName>,
    /// Runs that reactive control learns from
    #[arg(long, value_enum)]
    feedback: Option<FeedbackName>,
    /// Probability of a changed command that calls for a run, above 0 and below 1
    #[arg(long, value_name = "P", value_parser = number, allow_negative_numbers = true)]
    p_run: Option<f64>,
    /// How long control runs at every sample to learn: `auto`, or 0 to 30 s
    #[arg(long, value_name = "auto|SECONDS", value_parser = warm_up, allow_negative_numbers = true)]
    warm_up: Option<WarmUp>,
    /// Runs per second while learning, 10 to 1000
    #[arg(long, value_name = "HZ", value_parser = number, allow_negative_numbers = true)]
    warm_up_rate: Option<f64>,
    /// Longest time between two runs in s, above 0.002 and at most 1
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    failsafe: Option<f64>,
    /// Change of a motor command that counts, as a share of full scale: 0.004 or 1/255
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true)]
    quantum: Option<f64>,
    /// Motor pulses: 125 to 250 us at 2 kHz, or 1000 to 2000 us at 400 Hz
    #[arg(long, value_enum)]
    motors: Option<MotorsName>,
    /// Most of the flight to replay, in s
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// How the log's axes lie in the body's: auto, none, or such as roll180yaw90
    #[arg(long, value_name = "ROTATION", default_value = "auto")]
    rotate: Rotate,
    /// Noise that the emulated sensors add
    #[arg(long, value_enum, default_value = "datasheet")]
    noise: NoiseName,
    /// Seed of noise, oscillators and exploration, 0 to 4294967295
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    seed: Option<u32>,
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PolicyName {
    Reactive,
    Periodic,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ReferenceName {
    PreviousSample,
    LastRun,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PairsName {
    FirstCrossings,
    WeightedLags,
    Published,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FeedbackName {
    Every,
    Published,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MotorsName {
    #[value(name = "oneshot125")]
    OneShot125,
    Pwm,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum NoiseName {
    None,
    #[default]
    Datasheet,
}

impl ReplayArguments {
    /// The options, once every mix of arguments is known to make sense.
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
        let settings = self.settings()?;
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
            check_defmt(file, log.as_deref())?;
        }
        Ok(ReplayOptions {
            log,
            settings,
            logic: self.logic.unwrap_or_else(LogicName::configured),
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
            (Parameter::PRun, self.p_run.is_some()),
            (Parameter::Failsafe, self.failsafe.is_some()),
            (Parameter::Quantum, self.quantum.is_some()),
        ];
        let by_clock = self.rate.is_some() || self.chosen_policy() == PolicyName::Periodic;
        self.sweep.check(log, &single, by_clock)
    }

    fn settings(&self) -> Result<Settings, Refusal> {
        let defaults = Settings::default();
        let settings = Settings {
            policy: self.policy()?,
            reference: self
                .reference
                .map_or(defaults.reference, |name| match name {
                    ReferenceName::PreviousSample => Reference::PreviousSample,
                    ReferenceName::LastRun => Reference::LastRun,
                }),
            p_run: self.p_run.map_or(defaults.p_run, |p_run| p_run as f32),
            warm_up: self.warm_up.unwrap_or(defaults.warm_up),
            warm_up_period: self.warm_up_rate.map_or(defaults.warm_up_period, |rate| {
                duration(1.0 / rate.max(1e-3))
            }),
            failsafe: self.failsafe.map_or(defaults.failsafe, duration),
            quantum: self.quantum.map_or(defaults.quantum, |share| share as f32),
            motors: self.motors.map_or(defaults.motors, |name| match name {
                MotorsName::OneShot125 => MotorProtocol::OneShot125,
                MotorsName::Pwm => MotorProtocol::Pwm,
            }),
            triggers: self.triggers.unwrap_or(defaults.triggers),
            pairs: self.pairs.map_or(defaults.pairs, |name| match name {
                PairsName::FirstCrossings => Pairs::FirstCrossings,
                PairsName::WeightedLags => Pairs::WeightedLags,
                PairsName::Published => Pairs::Published,
            }),
            feedback: self.feedback.map_or(defaults.feedback, |name| match name {
                FeedbackName::Every => Feedback::Every,
                FeedbackName::Published => Feedback::Published,
            }),
            seed: self.seed.unwrap_or(defaults.seed),
        };
        settings
            .validate()
            .map_err(|error| Refusal::new(format!("{}: {error}", option_of(error))))?;
        check_period(&settings)?;
        Ok(settings)
    }

    /// The policy by name, the configured one where none is given.
    fn chosen_policy(&self) -> PolicyName {
        self.policy.unwrap_or(match Settings::default().policy {
            Policy::Reactive => PolicyName::Reactive,
            Policy::Periodic(_) => PolicyName::Periodic,
        })
    }

    /// The policy, once no option of the other one is named.
    fn policy(&self) -> Result<Policy, Refusal> {
        if self.chosen_policy() == PolicyName::Reactive {
            return match self.rate {
                None => Ok(Policy::Reactive),
                Some(rate) => Err(Refusal::new(format!(
                    "--rate {rate}: only periodic control has a rate, add --policy periodic"
                ))),
            };
        }
        for (option, given) in [
            ("--reference", self.reference.is_some()),
            ("--triggers", self.triggers.is_some()),
            ("--pairs", self.pairs.is_some()),
            ("--feedback", self.feedback.is_some()),
            ("--p-run", self.p_run.is_some()),
            ("--warm-up", self.warm_up.is_some()),
            ("--warm-up-rate", self.warm_up_rate.is_some()),
        ] {
            if given {
                return Err(Refusal::new(format!(
                    "{option}: periodic control has none, leave it out or use --policy reactive"
                )));
            }
        }
        match self.rate {
            None => Ok(Policy::Periodic(config::PERIODIC_PERIOD)),
            Some(rate) if (1.0..=fastest_rate()).contains(&rate) => {
                Ok(Policy::Periodic(duration(1.0 / rate)))
            }
            Some(rate) => Err(Refusal::new(format!(
                "--rate {rate}: must be 1 to {} Hz",
                fastest_rate()
            ))),
        }
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
            (Policy::Periodic(_), _) => return Ok(()),
            (_, WarmUp::Automatic) => {
                (config::SHORTEST_WARM_UP, "automatic warm-up lasts at least")
            }
            (_, WarmUp::Fixed(warm_up)) => (warm_up, "warm-up lasts"),
        };
        if length <= seconds(warm_up) {
            return Err(Refusal::new(format!(
                "--duration {length}: nothing would be left to measure, the {name} {} s",
                seconds(warm_up)
            )));
        }
        Ok(())
    }
}

/// One run per hyperperiod, in Hz.
fn fastest_rate() -> f64 {
    1.0 / seconds(config::HYPERPERIOD)
}

fn milliseconds(span: Duration) -> f64 {
    span.ticks() as f64 / 1e3
}

fn seconds(span: Duration) -> f64 {
    span.ticks() as f64 * 1e-6
}

/// The option that a refused setting came from.
fn option_of(error: SettingsError) -> &'static str {
    match error {
        SettingsError::PRun => "--p-run",
        SettingsError::Failsafe => "--failsafe",
        SettingsError::Quantum => "--quantum",
        SettingsError::Period => "--rate",
        SettingsError::WarmUp => "--warm-up",
        SettingsError::WarmUpPeriod => "--warm-up-rate",
        SettingsError::Triggers => "--triggers",
    }
}

/// Periodic control slower than the failsafe would be the failsafe's.
fn check_period(settings: &Settings) -> Result<(), Refusal> {
    match settings.policy {
        Policy::Periodic(period) if period + config::HYPERPERIOD > settings.failsafe => {
            Err(Refusal::new(format!(
                "--rate: a run every {} ms leaves the failsafe, every {} ms, no room; raise one of them",
                milliseconds(period),
                milliseconds(settings.failsafe)
            )))
        }
        _ => Ok(()),
    }
}

/// The firmware's log goes to a file of its own.
fn check_defmt(file: &Path, log: Option<&Path>) -> Result<(), Refusal> {
    let refuse = |reason: &str| {
        let file = file.display();
        Err(Refusal::new(format!("--defmt {file}: {reason}")))
    };
    if file.as_os_str().is_empty() || file == Path::new("-") {
        return refuse("must be the name of a file, stdout is for the result");
    }
    if file.is_dir() {
        return refuse("is a folder, must be the name of a file");
    }
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return refuse("its folder does not exist");
    }
    // Compared as the file system knows them, so that no other spelling overwrites the log.
    let same = log.is_some_and(|log| {
        matches!((log.canonicalize(), file.canonicalize()), (Ok(log), Ok(file)) if log == file)
    });
    if same {
        return refuse("is the recorded flight itself, and would overwrite it");
    }
    Ok(())
}

#[cfg(test)]
mod tests;

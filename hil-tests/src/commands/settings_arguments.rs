//! Arguments that become the autopilot's settings, the same wherever it flies.

use clap::{Args, ValueEnum};
use reflex::config;
use reflex::sensors::Inputs;
use reflex::settings::{
    Feedback, MotorProtocol, Pairs, Policy, Reference, Settings, SettingsError, WarmUp,
};
use reflex::time::Duration;

use super::quantities::{duration, inputs, number, seconds, share, warm_up};
use crate::refusal::Refusal;

/// What the autopilot is told. Defaults are those of `config/`.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct SettingsArguments {
    /// When control runs: when a sensor's change calls for it, or time-triggered
    #[arg(long, value_enum)]
    policy: Option<PolicyName>,
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
    pub(super) p_run: Option<f64>,
    /// How long control runs at every sample to learn: `auto`, or 0 to 30 s
    #[arg(long, value_name = "auto|SECONDS", value_parser = warm_up, allow_negative_numbers = true)]
    warm_up: Option<WarmUp>,
    /// Runs per second while learning, 10 to 1000
    #[arg(long, value_name = "HZ", value_parser = number, allow_negative_numbers = true)]
    warm_up_rate: Option<f64>,
    /// Longest time between two runs in s, above 0.002 and at most 1
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    pub(super) failsafe: Option<f64>,
    /// Change of a motor command that counts, as a share of full scale: 0.004 or 1/255
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true)]
    pub(super) quantum: Option<f64>,
    /// Motor pulses: 125 to 250 us at 2 kHz, or 1000 to 2000 us at 400 Hz
    #[arg(long, value_enum)]
    motors: Option<MotorsName>,
    /// Seed of noise, oscillators and exploration, 0 to 4294967295
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    seed: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PolicyName {
    Reactive,
    Periodic,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ReferenceName {
    PreviousSample,
    LastRun,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PairsName {
    FirstCrossings,
    WeightedLags,
    Published,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FeedbackName {
    Every,
    Published,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MotorsName {
    #[value(name = "oneshot125")]
    OneShot125,
    Pwm,
}

impl SettingsArguments {
    /// The settings, once every mix of arguments is known to make sense.
    ///
    /// # Errors
    /// The first mix or value that does not, with the option's name and its range.
    pub(super) fn settings(&self) -> Result<Settings, Refusal> {
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

    /// Control runs by the clock.
    pub(super) fn is_by_clock(&self) -> bool {
        self.rate.is_some() || self.chosen_policy() == PolicyName::Periodic
    }

    /// The policy by name, the configured one where none is given.
    pub(super) fn chosen_policy(&self) -> PolicyName {
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
}

/// One run per hyperperiod, in Hz.
fn fastest_rate() -> f64 {
    1.0 / seconds(config::HYPERPERIOD)
}

fn milliseconds(span: Duration) -> f64 {
    span.ticks() as f64 / 1e3
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

//! One flight of a campaign: who flies what, where, and when control runs.

use std::fmt;
use std::str::FromStr;

use anyhow::{Context, Result};
use clap::ValueEnum;
use reflex::sensors::{Input, Inputs};
use reflex::settings::{Policy, Settings};
use reflex::time::micros;
use serde::{Deserialize, Serialize};

use crate::closed_loop::{FlyOptions, Mission, Stress};
use crate::logics::LogicName;

/// The scored part begins here, s from take-off, whoever flies.
pub const SCORED_FROM_S: u32 = 15;
/// The same in the hovering flights that margins are seen in.
pub const HOVERS_FROM_S: u32 = 10;
/// Shortest and longest period of time-triggered control, us.
///
/// Below 11 Hz the failsafe would run control in its place.
pub const PERIODS_US: [u64; 2] = [1_000, 90_909];

/// What flies: the firmware on the emulated board, or the same code natively.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    /// The firmware, which is checked bit by bit against the host.
    Emulated,
    /// The library, without a processor.
    Native,
}

/// A way to run control whose loops are made as fast as equal margins allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tunable {
    /// Reactive control.
    Reactive,
    /// Time-triggered control at the usual rate.
    Usual,
    /// Time-triggered control as often as reactive control with its own tuning runs.
    EqualRuns,
}

/// What loops must bear: a gain or a delay that they are not made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Strain {
    /// The drone answers its motors twice as strongly: a gain margin of 6 dB.
    Gain,
    /// Motor commands apply 20 ms later: a delay margin.
    Delay,
}

/// When control runs in a flight, and what it is there to be compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Role {
    /// Reactive control with the settings of `config/`.
    Reactive,
    /// Reactive control without the foreseen command: cheaper to decide.
    Unforeseen,
    /// Time-triggered control at a rate in Hz.
    Periodic(u32),
    /// Time-triggered control as often as this trial's reactive control ran.
    EqualRuns,
    /// Time-triggered control that takes as much processor time as reactive control.
    EqualTime,
    /// Reactive control with another `P_run`, in thousandths.
    PRun(u32),
    /// Reactive control with another `T_failsafe`, in ms.
    Failsafe(u32),
    /// Whether loops so fast, in % of the configured bandwidth, bear a strain in hovering flight.
    Margin(Tunable, u32, Strain),
    /// Control whose loops are as fast as their margins allow.
    Tuned(Tunable),
}

impl Tunable {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Reactive, Self::Usual, Self::EqualRuns];

    fn name(self) -> &'static str {
        match self {
            Self::Reactive => "reactive",
            Self::Usual => "usual",
            Self::EqualRuns => "equal-runs",
        }
    }
}

impl Strain {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Gain, Self::Delay];

    fn name(self) -> &'static str {
        match self {
            Self::Gain => "gain",
            Self::Delay => "delay",
        }
    }

    fn stress(self) -> Stress {
        let none = Stress::default();
        match self {
            Self::Gain => Stress { gain: 2.0, ..none },
            Self::Delay => Stress {
                delay_s: 0.02,
                ..none
            },
        }
    }
}

impl Role {
    /// What must have been flown before: flights of a lower wave.
    #[must_use]
    pub fn wave(self) -> u32 {
        match self {
            Self::EqualRuns | Self::Tuned(Tunable::Reactive | Tunable::Usual) => 1,
            Self::Margin(Tunable::EqualRuns, ..) => 2,
            Self::Tuned(Tunable::EqualRuns) => 3,
            _ => 0,
        }
    }
}

/// A flight of a plan: what comes of it follows from this and [`Job::period_us`].
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Sortie {
    /// What flies.
    pub tier: Tier,
    /// Name of the airframe.
    pub airframe: String,
    /// Name of the control logic.
    pub logic: String,
    /// Name of the environment.
    pub environment: String,
    /// From take-off to the end, s.
    pub duration_s: u32,
    /// When control runs.
    pub role: Role,
    /// Seed of wind, noise, waypoints: flights of one seed meet the same wind.
    pub seed: u32,
}

/// A sortie that can be flown: its period and its loops are known.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Job {
    /// What is flown.
    pub sortie: Sortie,
    /// Time between two runs of time-triggered control, us; none for reactive control.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_us: Option<u64>,
    /// How fast attitude and rate loops are, in % of the configured bandwidth.
    #[serde(default = "as_configured", skip_serializing_if = "is_as_configured")]
    pub bandwidth: u32,
}

/// Loops as `config/` has them, in %.
pub const AS_CONFIGURED: u32 = 100;

fn as_configured() -> u32 {
    AS_CONFIGURED
}

fn is_as_configured(bandwidth: &u32) -> bool {
    *bandwidth == AS_CONFIGURED
}

impl Sortie {
    /// The same flight in another role.
    #[must_use]
    pub fn with(&self, role: Role) -> Self {
        Self {
            role,
            ..self.clone()
        }
    }

    /// The cell of every table that it belongs to: environment, airframe, logic.
    #[must_use]
    pub fn cell(&self) -> [&str; 3] {
        [&self.environment, &self.airframe, &self.logic]
    }
}

impl fmt::Display for Sortie {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [environment, airframe, logic] = self.cell();
        let (role, seed) = (self.role, self.seed);
        write!(
            f,
            "{airframe} in {environment} with {logic}, {role}, seed {seed}"
        )
    }
}

impl Job {
    /// What the flight is told.
    ///
    /// # Errors
    /// A logic of an unknown name, settings out of their ranges.
    pub fn options(&self) -> Result<FlyOptions> {
        let sortie = &self.sortie;
        let mut settings = Settings {
            policy: self.policy(),
            seed: sortie.seed,
            ..Settings::default()
        };
        match sortie.role {
            Role::Unforeseen => {
                let inputs = [Input::Gyro, Input::Accel, Input::Turned];
                settings.triggers = inputs.into_iter().fold(Inputs::NONE, Inputs::with);
            }
            Role::PRun(thousandths) => settings.p_run = thousandths as f32 / 1000.0,
            Role::Failsafe(ms) => settings.failsafe = micros(u64::from(ms) * 1000),
            _ => {}
        }
        let logic = LogicName::from_str(&sortie.logic, false).ok();
        settings
            .validate()
            .map_err(|error| anyhow::anyhow!("{sortie}: {error}"))?;
        let (mission, scored_from_s, stress) = match sortie.role {
            Role::Margin(_, _, strain) => (Mission::Hover, HOVERS_FROM_S, strain.stress()),
            _ => (Mission::Waypoints, SCORED_FROM_S, Stress::default()),
        };
        Ok(FlyOptions {
            logic: logic.with_context(|| format!("{}: is no control logic", sortie.logic))?,
            settings,
            mission,
            duration_s: f64::from(sortie.duration_s),
            scored_from_s: Some(f64::from(scored_from_s)),
            stress,
        })
    }

    fn policy(&self) -> Policy {
        self.period_us
            .map_or(Policy::Reactive, |period| Policy::Periodic(micros(period)))
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reactive => f.write_str("reactive"),
            Self::Unforeseen => f.write_str("unforeseen"),
            Self::Periodic(hz) => write!(f, "periodic-{hz}"),
            Self::EqualRuns => f.write_str("equal-runs"),
            Self::EqualTime => f.write_str("equal-time"),
            Self::PRun(thousandths) => write!(f, "p-run-{}", f64::from(*thousandths) / 1000.0),
            Self::Failsafe(ms) => write!(f, "failsafe-{}", f64::from(*ms) / 1000.0),
            Self::Tuned(of) => write!(f, "tuned-{}", of.name()),
            Self::Margin(of, percent, strain) => {
                write!(f, "margin-{}-{percent}-{}", of.name(), strain.name())
            }
        }
    }
}

impl FromStr for Role {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let unknown = || format!("`{text}` is no role of a flight");
        let thousandths = |number: &str| match number.parse::<f64>() {
            Ok(number) if (0.0..=1000.0).contains(&number) => Ok((number * 1000.0).round() as u32),
            _ => Err(unknown()),
        };
        match text {
            "reactive" => Ok(Self::Reactive),
            "unforeseen" => Ok(Self::Unforeseen),
            "equal-runs" => Ok(Self::EqualRuns),
            "equal-time" => Ok(Self::EqualTime),
            _ => match text.rsplit_once('-') {
                Some(("periodic", hz)) => Ok(Self::Periodic(hz.parse().map_err(|_| unknown())?)),
                Some(("p-run", number)) => Ok(Self::PRun(thousandths(number)?)),
                Some(("failsafe", number)) => Ok(Self::Failsafe(thousandths(number)?)),
                _ => tuned(text).ok_or_else(unknown),
            },
        }
    }
}

/// The roles that have to do with tuning.
fn tuned(text: &str) -> Option<Role> {
    let tunable = |name: &str| Tunable::ALL.into_iter().find(|it| it.name() == name);
    if let Some(name) = text.strip_prefix("tuned-") {
        return Some(Role::Tuned(tunable(name)?));
    }
    let (rest, strain) = text.strip_prefix("margin-")?.rsplit_once('-')?;
    let (name, percent) = rest.rsplit_once('-')?;
    let strain = Strain::ALL.into_iter().find(|it| it.name() == strain)?;
    Some(Role::Margin(tunable(name)?, percent.parse().ok()?, strain))
}

impl TryFrom<String> for Role {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Role> for String {
    fn from(role: Role) -> Self {
        role.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn roles() -> impl Strategy<Value = Role> {
        prop_oneof![
            Just(Role::Reactive),
            Just(Role::Unforeseen),
            Just(Role::EqualRuns),
            Just(Role::EqualTime),
            (1..2000u32).prop_map(Role::Periodic),
            (1..1000u32).prop_map(Role::PRun),
            (1..1000u32).prop_map(Role::Failsafe),
            prop::sample::select(&Tunable::ALL[..]).prop_map(Role::Tuned),
            (
                prop::sample::select(&Tunable::ALL[..]),
                1..1000u32,
                prop::sample::select(&Strain::ALL[..])
            )
                .prop_map(|(of, percent, strain)| Role::Margin(of, percent, strain)),
        ]
    }

    proptest! {
        #[test]
        fn a_role_reads_back_from_its_name(role in roles()) {
            prop_assert_eq!(role.to_string().parse(), Ok(role));
        }
    }

    #[test]
    fn what_is_no_role_is_named() {
        for text in [
            "",
            "reactive-",
            "periodic-x",
            "p-run-nan",
            "failsafe--1",
            "-",
        ] {
            let error = text.parse::<Role>().unwrap_err();
            assert_eq!(error, format!("`{text}` is no role of a flight"));
        }
    }

    #[test]
    fn a_role_becomes_settings() {
        let job = |role, period_us| Job {
            sortie: Sortie {
                tier: Tier::Native,
                airframe: "y6".into(),
                logic: "arducopter".into(),
                environment: "lab".into(),
                duration_s: 100,
                role,
                seed: 7,
            },
            period_us,
            bandwidth: AS_CONFIGURED,
        };
        let settings = |role, period_us| job(role, period_us).options().unwrap().settings;
        assert_eq!(settings(Role::PRun(300), None).p_run, 0.3);
        assert_eq!(settings(Role::Failsafe(50), None).failsafe, micros(50_000));
        assert_eq!(settings(Role::Reactive, None).seed, 7);
        let clock = settings(Role::Periodic(400), Some(2500)).policy;
        assert_eq!(clock, Policy::Periodic(micros(2500)));
        let cheaper = settings(Role::Unforeseen, None).triggers;
        assert!(cheaper.contains(Input::Turned) && !cheaper.contains(Input::Command));
        let error = job(Role::Failsafe(1), None).options().unwrap_err();
        assert!(
            error.to_string().contains("failsafe must be longer"),
            "{error}"
        );
    }
}

//! When control runs in a flight, and what that is there to be compared with.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::rule::{Contender, Rule, Strain, Tempo};

/// When control runs in a flight, and what it is there to be compared with.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
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
    Margin(Tempo, u32, Strain),
    /// Loops of a bandwidth in % whose control runs at another pace: error is traded for runs.
    Traded(u32, Pace),
    /// Control whose loops are as fast as a rule allows.
    Tuned(Rule, Contender),
    /// Hovering instead of going round waypoints.
    Hovering(Contender),
    /// Hovering with a disturbance observer in the cascade.
    Observing(Contender),
}

/// How often control runs where error is traded for runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Pace {
    /// Reactively, with a budget in us.
    Budget(u32),
    /// By the clock, at a rate in Hz.
    Rate(u32),
}

impl Role {
    /// The role whose rate this one keeps: time-triggered control at equal runs.
    #[must_use]
    pub fn decided_by(self) -> Option<Self> {
        match self {
            Self::EqualRuns => Some(Self::Reactive),
            Self::Tuned(rule, Contender::EqualRuns) => Some(Self::Tuned(rule, Contender::Reactive)),
            Self::Hovering(Contender::EqualRuns) => Some(Self::Hovering(Contender::Reactive)),
            _ => None,
        }
    }

    /// What must have been flown before: flights of a lower wave.
    #[must_use]
    pub fn wave(self) -> u32 {
        match self {
            Self::EqualRuns
            | Self::Hovering(Contender::EqualRuns)
            | Self::Tuned(_, Contender::Reactive | Contender::Usual) => 1,
            Self::Margin(Tempo::EqualRuns(_), ..) => 2,
            Self::Tuned(_, Contender::EqualRuns) => 3,
            _ => 0,
        }
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
            Self::Traded(percent, Pace::Budget(us)) => write!(f, "traded-{percent}-budget-{us}us"),
            Self::Traded(percent, Pace::Rate(hz)) => write!(f, "traded-{percent}-rate-{hz}hz"),
            Self::Tuned(rule, of) => write!(f, "tuned-{}-{rule}", of.name()),
            Self::Hovering(of) => write!(f, "hovering-{}", of.name()),
            Self::Observing(of) => write!(f, "observing-{}", of.name()),
            Self::Margin(tempo, percent, strain) => write!(f, "margin-{tempo}-{percent}-{strain}"),
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
                _ => of_contender(text).ok_or_else(unknown),
            },
        }
    }
}

/// The roles of a contender.
fn of_contender(text: &str) -> Option<Role> {
    let contender = |name: &str| Contender::ALL.into_iter().find(|it| it.name() == name);
    let (kind, rest) = text.split_once('-')?;
    match kind {
        "tuned" => Contender::ALL.into_iter().find_map(|of| {
            let rule = rest.strip_prefix(of.name())?.strip_prefix('-')?;
            Some(Role::Tuned(Rule::named(rule)?, of))
        }),
        "traded" => {
            let (percent, pace) = rest.split_once('-')?;
            let pace = match pace.split_once('-')? {
                ("budget", us) => Pace::Budget(us.strip_suffix("us")?.parse().ok()?),
                ("rate", hz) => Pace::Rate(hz.strip_suffix("hz")?.parse().ok()?),
                _ => return None,
            };
            Some(Role::Traded(percent.parse().ok()?, pace))
        }
        "hovering" => Some(Role::Hovering(contender(rest)?)),
        "observing" => Some(Role::Observing(contender(rest)?)),
        "margin" => {
            let (rest, strain) = rest.rsplit_once('-')?;
            let (tempo, percent) = rest.rsplit_once('-')?;
            let (tempo, strain) = (Tempo::named(tempo)?, Strain::named(strain)?);
            Some(Role::Margin(tempo, percent.parse().ok()?, strain))
        }
        _ => None,
    }
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
            (
                prop::sample::select(&Rule::ALL[..]),
                prop::sample::select(&Contender::ALL[..])
            )
                .prop_map(|(rule, of)| Role::Tuned(rule, of)),
            (1..1000u32, 1..100_000u32)
                .prop_map(|(percent, us)| Role::Traded(percent, Pace::Budget(us))),
            (1..1000u32, 1..2000u32)
                .prop_map(|(percent, hz)| Role::Traded(percent, Pace::Rate(hz))),
            prop::sample::select(&Contender::ALL[..]).prop_map(Role::Hovering),
            prop::sample::select(&Contender::ALL[..]).prop_map(Role::Observing),
            (
                prop::sample::select(&Contender::ALL[..]),
                prop::sample::select(&Rule::ALL[..]),
                1..1000u32,
                prop::sample::select(Strain::all())
            )
                .prop_map(|(of, rule, percent, strain)| {
                    Role::Margin(rule.tempo(of), percent, strain)
                }),
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
            "hovering-usually",
            "margin-reactive-100-wear",
            "margin-runs-of-7ms-0.1rad_s-100-gain",
            "tuned-reactive-10ms",
            "traded-100-rate-9us",
            "-",
        ] {
            let error = text.parse::<Role>().unwrap_err();
            assert_eq!(error, format!("`{text}` is no role of a flight"));
        }
    }
}

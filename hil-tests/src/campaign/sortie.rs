//! One flight of a campaign: who flies what, where, and when control runs.

use std::fmt;

use anyhow::{Context, Result, anyhow};
use clap::ValueEnum;
use reflex::config::{LIMITS, SETTINGS};
use reflex::sensors::{Input, Inputs};
use reflex::settings::{Policy, Settings};
use reflex::time::micros;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::role::{Pace, Role};
use crate::closed_loop::contention::Contention;
use crate::closed_loop::{FlyOptions, Mission, Stress};
use crate::faults::Script;
use crate::logics::{GainSet, LogicName};
pub use crate::scoring::Tier;

/// The scored part begins here in every role, s from take-off.
pub const SCORED_FROM_S: u32 = 15;
/// The same in hovering flights.
pub const HOVERS_FROM_S: u32 = 10;
/// The control logic that is the cascade with a disturbance observer.
const OBSERVER: &str = "observer";
/// Shortest and longest period of time-triggered control, us.
///
/// Below 11 Hz the failsafe would run control in its place.
pub const PERIODS_US: [u64; 2] = [1_000, 90_909];

/// A cell of the tables: one airframe with one control logic in one environment.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
pub struct CellName {
    /// Name of the environment.
    pub environment: String,
    /// Name of the airframe.
    pub airframe: String,
    /// Name of the control logic.
    pub logic: String,
}

impl CellName {
    /// Whether it is the one of an environment, an airframe and a control logic.
    #[must_use]
    pub fn is(&self, names: [&str; 3]) -> bool {
        [&*self.environment, &*self.airframe, &*self.logic] == names
    }
}

impl fmt::Display for CellName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}, {}", self.environment, self.airframe, self.logic)
    }
}

/// A flight of a plan: its report follows from this and [`Job::period_us`].
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Sortie {
    /// What flies.
    pub tier: Tier,
    /// Name of the airframe.
    pub airframe: String,
    /// Name of the control logic, and behind a slash of its gains where they are not its own.
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

    /// The control logic that flies, and the name of its gains.
    ///
    /// # Errors
    /// A logic of an unknown name.
    pub fn flies_with(&self) -> Result<(LogicName, Option<&str>)> {
        let name = match self.role {
            Role::Observing(_) => OBSERVER,
            _ => &self.logic,
        };
        let (logic, gains) = match name.split_once('/') {
            Some((logic, gains)) => (logic, Some(gains)),
            None => (name, None),
        };
        let logic = LogicName::from_str(logic, false);
        let logic = logic.map_err(|_| anyhow!("{name}: is no control logic"))?;
        Ok((logic, gains))
    }

    /// The cell that it belongs to.
    #[must_use]
    pub fn cell(&self) -> CellName {
        CellName {
            environment: self.environment.clone(),
            airframe: self.airframe.clone(),
            logic: self.logic.clone(),
        }
    }
}

impl fmt::Display for Sortie {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} in {} with {}, {}, seed {}",
            self.airframe, self.environment, self.logic, self.role, self.seed
        )
    }
}

impl Job {
    /// The options of the flight.
    ///
    /// # Errors
    /// A logic of an unknown name, settings out of their ranges.
    pub fn options(&self) -> Result<FlyOptions> {
        let sortie = &self.sortie;
        let mut settings = Settings {
            seed: sortie.seed,
            ..SETTINGS
        };
        if let Some(period) = self.period_us {
            settings.policy = Policy::Periodic;
            settings.period = micros(period);
        }
        match sortie.role {
            Role::Unforeseen => {
                settings.triggers = Inputs::OF_IMU.without(Input::Command).without(Input::Owed);
            }
            Role::PRun(thousandths) => settings.p_run = thousandths as f32 / 1000.0,
            Role::Traded(_, Pace::Budget(us)) => settings.budget = micros(u64::from(us)),
            Role::Failsafe(ms) => settings.failsafe = micros(u64::from(ms) * 1000),
            _ => {}
        }
        let (logic, gains) = sortie.flies_with()?;
        let gains = GainSet::load(logic, gains, f64::from(self.bandwidth) / 100.0);
        settings
            .check(&LIMITS)
            .map_err(|error| anyhow!("{sortie}: {error}"))?;
        let (mission, scored_from_s, stress) = match sortie.role {
            Role::Margin(_, _, strain) => (Mission::Hover, HOVERS_FROM_S, strain.stress()),
            Role::Hovering(_) | Role::Observing(_) => {
                (Mission::Hover, HOVERS_FROM_S, Stress::default())
            }
            _ => (Mission::Waypoints, SCORED_FROM_S, Stress::default()),
        };
        Ok(FlyOptions {
            gains: gains.with_context(|| sortie.to_string())?,
            settings,
            mission,
            duration_s: f64::from(sortie.duration_s),
            scored_from_s: Some(f64::from(scored_from_s)),
            stress,
            faults: Script::default(),
            record: None,
            contention: Contention::default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let traded = Role::Traded(AS_CONFIGURED, Pace::Budget(2500));
        assert_eq!(settings(traded, None).budget, micros(2500));
        assert_eq!(settings(Role::Reactive, None).seed, 7);
        let clock = settings(Role::Periodic(400), Some(2500));
        assert_eq!(
            (clock.policy, clock.period),
            (Policy::Periodic, micros(2500))
        );
        let cheaper = settings(Role::Unforeseen, None).triggers;
        assert!(cheaper.contains(Input::Turned) && !cheaper.contains(Input::Command));
        let error = job(Role::Failsafe(1), None).options().unwrap_err();
        assert!(
            error
                .to_string()
                .contains("0.001 is out of range, must be above 2 hyperperiods"),
            "{error}"
        );
    }
}

//! Arguments that become the autopilot's settings, the same wherever it flies.

use reflex::config::{HYPERPERIOD, LIMITS, SETTINGS};
use reflex::settings::{Declared, Policy, Settings};
use reflex::time::Duration;
use reflex_settings::Setting;

pub(super) use super::declared_options::refused;
use super::declared_options::{Declarations, Given};
use crate::refusal::Refusal;

/// The settings that are given. Others are those of `config/`.
pub(super) type SettingsArguments = Given<Settings>;

impl Declarations for Settings {
    const ALL: &'static [Setting] = Self::SETTINGS;
}

impl Given<Settings> {
    /// The settings, once every mix of arguments is checked.
    ///
    /// # Errors
    /// The first mix or value that does not, with the option's name and its range.
    pub(super) fn settings(&self) -> Result<Settings, Refusal> {
        self.check_policy()?;
        let settings = self
            .iter()
            .try_fold(SETTINGS, |settings, (place, _, value)| {
                settings.checked(place, value, &LIMITS)
            });
        let settings = settings.map_err(|refusal| refused(refusal.setting, refusal))?;
        check_period(&settings)?;
        Ok(settings)
    }

    /// Whether an option is given.
    pub(super) fn gives(&self, option: &str) -> bool {
        self.of(option).is_some()
    }

    /// Control runs by the clock.
    pub(super) fn is_by_clock(&self) -> bool {
        self.gives("rate") || self.chosen_policy() == Policy::Periodic
    }

    /// The policy, the configured one where none is given.
    fn chosen_policy(&self) -> Policy {
        let settings = self.iter().fold(SETTINGS, |settings, (place, _, value)| {
            settings.with(place, value).unwrap_or(settings)
        });
        settings.policy
    }

    /// Refuses options of the policy that is not chosen.
    fn check_policy(&self) -> Result<(), Refusal> {
        let chosen = self.chosen_policy();
        for (_, setting, _) in self.iter() {
            if let Some(policy) = setting.policy
                && policy != chosen
            {
                let line = format!(
                    "{} control has none, leave it out or use --policy {}",
                    chosen.word(),
                    policy.word()
                );
                return Err(refused(setting, line));
            }
        }
        Ok(())
    }
}

fn milliseconds(span: Duration) -> f64 {
    span.ticks() as f64 / 1e3
}

/// Periodic control slower than the failsafe would be the failsafe's.
fn check_period(settings: &Settings) -> Result<(), Refusal> {
    if settings.policy == Policy::Periodic && settings.period + HYPERPERIOD > settings.failsafe {
        return Err(Refusal::new(format!(
            "--rate: a run every {} ms leaves the failsafe, every {} ms, no room; raise one of them",
            milliseconds(settings.period),
            milliseconds(settings.failsafe)
        )));
    }
    Ok(())
}

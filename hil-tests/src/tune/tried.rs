//! A value that was tried, what it changed, and whether it pays.

use reflex::settings::Settings;
use schemars::JsonSchema;
use serde::Serialize;

use super::effect::{Effect, Measure};
use super::flown::Flown;
use super::trials::Trial;

/// By how much, in %, a value that pays may raise what it does not lower.
const TOLERATED: f64 = 2.0;

/// A value that was tried, and what it changed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tried {
    /// The table in `config/reactive.toml`.
    pub section: String,
    /// The key in it.
    pub key: String,
    /// The configured value, in TOML.
    pub from: String,
    /// The tried one.
    pub to: String,
    /// Change of the runs per second.
    pub runs: Option<Effect>,
    /// Change of the RMS deviation as the motors feel it.
    pub strayed: Option<Effect>,
    /// Change of the processor's load; null where effects are paired by window.
    pub load: Option<Effect>,
    /// Logs that are scored as configured, and no more with this value.
    pub lost_logs: usize,
    /// It surely lowers runs or deviation, and raises neither by more than 2 %.
    pub pays: bool,
}

impl Tried {
    /// From the flights of a trial, by its place.
    pub(super) fn of(
        flown: &[Flown],
        place: usize,
        trial: &Trial,
        configured: &Settings,
        confidence: f64,
    ) -> Self {
        let quanta = [configured, &trial.settings].map(|settings| f64::from(settings.quantum));
        let effect = |measure: Measure, units| measure.effect(flown, place, units, confidence);
        let runs = effect(Measure::Runs, [1.0; 2]);
        let strayed = effect(Measure::Strayed, quanta);
        let is_lost = |log: &&Flown| {
            let tried = log.trials.get(place);
            log.is_scored() && !tried.is_some_and(|score| score.scored)
        };
        let lost_logs = flown.iter().filter(is_lost).count();
        let pays = |lower: Option<Effect>, other: Option<Effect>| {
            let at_most = |effect: Option<Effect>| effect.and_then(|effect| effect.at_most());
            at_most(lower).is_some_and(|most| most < 0.0)
                && at_most(other).is_some_and(|most| most <= TOLERATED)
        };
        Self {
            section: trial.section.clone(),
            key: trial.key.to_owned(),
            from: trial.from.clone(),
            to: trial.to.clone(),
            runs,
            strayed,
            load: effect(Measure::Load, [1.0; 2]),
            lost_logs,
            pays: lost_logs == 0 && (pays(runs, strayed) || pays(strayed, runs)),
        }
    }

    /// True where it surely changes runs or straying.
    pub(super) fn is_sure(&self) -> bool {
        let effects = [self.runs, self.strayed].into_iter().flatten();
        effects
            .filter_map(|effect| effect.from_percent.zip(effect.to_percent))
            .any(|(from, to)| from > 0.0 || to < 0.0)
    }

    /// Its place in the configuration.
    #[must_use]
    pub fn path(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }
}

//! The few numbers of a score that a sweep compares.

use schemars::JsonSchema;
use serde::Serialize;

use crate::scoring::Score;

/// How often control ran, how good that was, and what else as many runs could have done.
///
/// Rates count every run, exploration too: so do those of the baselines. What has no value is
/// `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Outcome {
    /// Runs per second.
    pub runs_per_s: Option<f64>,
    /// Share of hyperperiods that ended stale.
    pub stale_fraction: Option<f64>,
    /// RMS deviation, quanta.
    pub rms_deviation_quanta: Option<f64>,
    /// Runs per second of periodic control at equal runs.
    pub periodic_runs_per_s: Option<f64>,
    /// Its RMS deviation, quanta.
    pub periodic_rms_quanta: Option<f64>,
    /// Runs per second of the oracle at equal runs.
    pub oracle_runs_per_s: Option<f64>,
    /// Its RMS deviation, quanta.
    pub oracle_rms_quanta: Option<f64>,
    /// RMS deviation as a multiple of periodic control's.
    pub ratio_to_periodic: Option<f64>,
    /// RMS deviation as a multiple of the oracle's.
    pub ratio_to_oracle: Option<f64>,
    /// Share of the runs that triggers asked for which changed nothing.
    pub false_positive_share: Option<f64>,
    /// Share of the failsafe's runs that changed the command though every model had said no.
    pub failsafe_changed_share: Option<f64>,
}

impl Outcome {
    /// The numbers of a score; deviations in the quantum it was scored with.
    #[must_use]
    pub fn of(score: &Score) -> Self {
        let length_s = score.duration_s - score.warm_up_s;
        let rate = |runs: u64| ratio(Some(runs as f64), Some(length_s));
        let share = |part: u64, whole: u64| ratio(Some(part as f64), Some(whole as f64));
        let section = &score.section;
        let decisions = &section.decisions;
        let own = section.actuators.deviation.rms_deviation_quanta;
        let (periodic, oracle) = (&score.periodic_equal, &score.oracle_equal);
        Self {
            runs_per_s: rate(section.control.runs),
            stale_fraction: section.actuators.deviation.stale_fraction,
            rms_deviation_quanta: own,
            periodic_runs_per_s: rate(periodic.runs),
            periodic_rms_quanta: periodic.deviation.rms_deviation_quanta,
            oracle_runs_per_s: rate(oracle.runs),
            oracle_rms_quanta: oracle.deviation.rms_deviation_quanta,
            ratio_to_periodic: ratio(own, periodic.deviation.rms_deviation_quanta),
            ratio_to_oracle: ratio(own, oracle.deviation.rms_deviation_quanta),
            false_positive_share: share(
                decisions.false_positive,
                decisions.true_positive + decisions.false_positive,
            ),
            failsafe_changed_share: share(
                decisions.failsafe_changed,
                section.control.by_reason.failsafe,
            ),
        }
    }

    /// Each number's median on its own; of an even count the mean of the middle two.
    #[must_use]
    pub fn median(outcomes: &[Self]) -> Self {
        let of = |number: fn(&Self) -> Option<f64>| median(outcomes.iter().filter_map(number));
        Self {
            runs_per_s: of(|one| one.runs_per_s),
            stale_fraction: of(|one| one.stale_fraction),
            rms_deviation_quanta: of(|one| one.rms_deviation_quanta),
            periodic_runs_per_s: of(|one| one.periodic_runs_per_s),
            periodic_rms_quanta: of(|one| one.periodic_rms_quanta),
            oracle_runs_per_s: of(|one| one.oracle_runs_per_s),
            oracle_rms_quanta: of(|one| one.oracle_rms_quanta),
            ratio_to_periodic: of(|one| one.ratio_to_periodic),
            ratio_to_oracle: of(|one| one.ratio_to_oracle),
            false_positive_share: of(|one| one.false_positive_share),
            failsafe_changed_share: of(|one| one.failsafe_changed_share),
        }
    }

    /// The same with deviations in another quantum, `factor` times smaller.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let scaled = |rms: Option<f64>| rms.map(|rms| rms * factor);
        Self {
            rms_deviation_quanta: scaled(self.rms_deviation_quanta),
            periodic_rms_quanta: scaled(self.periodic_rms_quanta),
            oracle_rms_quanta: scaled(self.oracle_rms_quanta),
            ..self
        }
    }
}

fn ratio(part: Option<f64>, whole: Option<f64>) -> Option<f64> {
    let ratio = part? / whole?;
    ratio.is_finite().then_some(ratio)
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let upper = *values.get(values.len() / 2)?;
    if values.len() % 2 == 1 {
        return Some(upper);
    }
    let lower = *values.get(values.len() / 2 - 1)?;
    Some(f64::midpoint(lower, upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_or_between_the_middle_two() {
        let of = |values: &[f64]| median(values.iter().copied());
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[3.0]), Some(3.0));
        assert_eq!(of(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(of(&[9.0, 1.0, 2.0, 4.0]), Some(3.0));
    }

    #[test]
    fn a_share_of_nothing_is_none() {
        assert_eq!(ratio(Some(0.0), Some(0.0)), None);
        assert_eq!(ratio(Some(1.0), None), None);
        assert_eq!(ratio(Some(1.0), Some(2.0)), Some(0.5));
    }
}

//! What control takes of the processor, and which periodic rate takes as much.
//!
//! A policy keeps the processor busy for so many instructions a sample and so many a run, those
//! of everything around it included. `hil-tests/load.toml` has both for every control logic,
//! measured on the emulated board; a native replay, which has no processor, takes its load from
//! there, and so does periodic control in either tier. On the emulated board the policy's own
//! load is what was measured.
//!
//! Commands that are foreseen exactly, as where motors saturate, are counted and cost extra.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Instructions of a policy with a control logic.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Of a hyperperiod without a run.
    pub sample: f64,
    /// Of a run, beside them.
    pub run: f64,
}

/// Both policies with one control logic.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogicCosts {
    /// Reactive control after its warm-up.
    pub reactive: Cost,
    /// Periodic control.
    pub periodic: Cost,
    /// Instructions of a command that reactive control foresees exactly, beside those of its sample.
    pub foresight: f64,
}

/// The content of `load.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadTable {
    /// Instructions in a second.
    pub core_hz: f64,
    /// By the logic's name.
    pub logics: BTreeMap<String, LogicCosts>,
}

/// The table that is built in.
pub static LOADS: LazyLock<LoadTable> = LazyLock::new(|| {
    let text = include_str!("../../load.toml");
    toml::from_str(text).expect("hil-tests/load.toml is as its test wrote it")
});

/// How often things happen in a second, and what share of time they take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Busy {
    /// Hyperperiods.
    pub samples_hz: f64,
    /// Runs.
    pub runs_hz: f64,
    /// Share of time.
    pub share: f64,
}

impl Cost {
    /// Share of time that it keeps a core of so many instructions a second busy.
    #[must_use]
    pub fn load(&self, core_hz: f64, samples_hz: f64, runs_hz: f64) -> f64 {
        (self.sample * samples_hz + self.run * runs_hz) / core_hz
    }

    /// The runs a second that make up this load.
    #[must_use]
    pub fn runs_hz(&self, core_hz: f64, samples_hz: f64, load: f64) -> f64 {
        (load * core_hz - self.sample * samples_hz) / self.run
    }

    /// What two flights with different rates took; none where more runs are not more work.
    #[must_use]
    pub fn between(core_hz: f64, one: Busy, other: Busy) -> Option<Self> {
        let a_sample = |busy: Busy, number: f64| number / busy.samples_hz;
        let work = |busy: Busy| a_sample(busy, busy.share * core_hz);
        let runs = |busy: Busy| a_sample(busy, busy.runs_hz);
        let run = (work(other) - work(one)) / (runs(other) - runs(one));
        (run.is_finite() && run > 0.0).then(|| Self {
            sample: work(one) - run * runs(one),
            run,
        })
    }
}

/// Whether some rate of periodic control takes the policy's load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// Yes.
    Within,
    /// The policy takes more than periodic control at its highest rate, that of the samples.
    AboveHighest,
    /// The policy takes less than periodic control at its lowest rate.
    BelowLowest,
}

impl Reach {
    /// The nearest rate that periodic control accepts, and whether that is the wanted one.
    pub(super) fn of(wanted_hz: f64, accepted: &RangeInclusive<f64>) -> (f64, Self) {
        let (low, high) = (*accepted.start(), *accepted.end());
        if wanted_hz > high {
            (high, Self::AboveHighest)
        } else if wanted_hz >= low {
            (wanted_hz, Self::Within)
        } else {
            (low, Self::BelowLowest)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_table_has_costs_of_every_control_logic_that_are_above_zero() {
        use crate::logics::LogicName;
        use clap::ValueEnum;
        assert_eq!(LOADS.logics.len(), LogicName::value_variants().len());
        for logic in LogicName::value_variants() {
            let costs = LOADS.logics[logic.word()];
            for cost in [costs.reactive, costs.periodic] {
                assert!(cost.sample > 0.0 && cost.run > 0.0, "{}", logic.word());
            }
        }
    }

    #[test]
    fn a_rate_out_of_range_becomes_the_nearest_and_says_so() {
        let accepted = 1.0..=1000.0;
        for (wanted, rate, reach) in [
            (250.0, 250.0, Reach::Within),
            (1000.5, 1000.0, Reach::AboveHighest),
            (0.9, 1.0, Reach::BelowLowest),
            (-3.0, 1.0, Reach::BelowLowest),
        ] {
            assert_eq!(Reach::of(wanted, &accepted), (rate, reach));
        }
    }

    proptest! {
        #[test]
        fn a_cost_is_found_again_from_two_flights_and_a_rate_from_its_load(
            sample in 100.0..10_000.0, run in 100.0..10_000.0,
            samples_hz in 500.0..1000.0, runs_hz in 1.0..500.0,
        ) {
            let cost = Cost { sample, run };
            let busy = |runs_hz| Busy {
                samples_hz,
                runs_hz,
                share: cost.load(168e6, samples_hz, runs_hz),
            };
            let found = Cost::between(168e6, busy(runs_hz), busy(2.0 * runs_hz)).expect("a cost");
            prop_assert!((found.sample / sample - 1.0).abs() < 1e-6);
            prop_assert!((found.run / run - 1.0).abs() < 1e-6);
            let rate = cost.runs_hz(168e6, samples_hz, busy(runs_hz).share);
            prop_assert!((rate / runs_hz - 1.0).abs() < 1e-6);
            prop_assert_eq!(Cost::between(168e6, busy(runs_hz), busy(runs_hz)), None);
        }
    }
}

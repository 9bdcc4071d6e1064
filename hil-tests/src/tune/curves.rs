//! What an input learned: its labels by bin, the model through them, the threshold.

use reflex::reactive::{Fit, Logistic};
use reflex::settings::Settings;
use schemars::JsonSchema;
use serde::Serialize;

use crate::replay::native;
use crate::replay::unit_of;

/// What an input learned by the end of a flight.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Learned {
    /// Its name.
    pub input: String,
    /// Unit of its changes.
    pub unit: String,
    /// Labels by bin; empty where there are none.
    pub bins: Vec<Bin>,
    /// The model's `b1`; null without a model.
    pub b1: Option<f64>,
    /// The model's `b2`, per unit; null without a model.
    pub b2: Option<f64>,
    /// The change above which it asks for a run; null without a model.
    pub threshold: Option<f64>,
}

/// Labels of like changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Bin {
    /// Their mean change.
    pub change: f64,
    /// Weight of those after which the command was another.
    pub changed: f64,
    /// Weight of the others.
    pub unchanged: f64,
}

impl Bin {
    /// Share of those after which the command was another.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.changed / (self.changed + self.unchanged)
    }
}

impl Learned {
    /// The model's probability of a changed command; none without a model.
    #[must_use]
    pub fn probability(&self, change: f64) -> Option<f64> {
        let (b1, b2) = (self.b1?, self.b2?);
        Some(1.0 / (1.0 + (-(b1 + b2 * change)).exp()))
    }
}

/// Of every input that has labels.
pub(super) fn of(learned: &[native::Learned], settings: &Settings) -> Vec<Learned> {
    let all = learned.iter().map(|learned| of_input(learned, settings));
    all.filter(|learned| !learned.bins.is_empty()).collect()
}

fn of_input(learned: &native::Learned, settings: &Settings) -> Learned {
    let (name, unit) = unit_of(learned.input, settings);
    let unit = f64::from(unit);
    let model: Option<Logistic> = match learned.fit {
        Fit::Model(model) => Some(model),
        Fit::Unfit | Fit::Irrelevant => None,
    };
    let bins = learned.labels.counted().map(|bin| Bin {
        change: f64::from(bin.change) / unit,
        changed: bin.changed.into(),
        unchanged: bin.unchanged.into(),
    });
    Learned {
        input: learned.input.name().to_owned(),
        unit: name.to_owned(),
        bins: bins.collect(),
        b1: model.map(|model| model.b1.into()),
        b2: model.map(|model| f64::from(model.b2) * unit),
        threshold: model
            .map(|_| f64::from(learned.threshold) / unit)
            .filter(|threshold| threshold.is_finite()),
    }
}

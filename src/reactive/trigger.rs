//! The trigger of one input: reference sample, change, model and threshold.

use super::{Fit, Logistic};
use crate::math::Vec3;
use crate::settings::Reference;

/// Everything the hot path needs to decide whether a sample calls for a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    mode: Reference,
    reference: Option<Vec3>,
    newest: Option<Vec3>,
    change: Option<f32>,
    fit: Fit,
    threshold: f32,
    p_run: f32,
}

impl Trigger {
    /// A trigger without a model: unfit, every sample calls for a run.
    #[must_use]
    pub fn new(mode: Reference, p_run: f32) -> Self {
        Self {
            mode,
            reference: None,
            newest: None,
            change: None,
            fit: Fit::Unfit,
            threshold: 0.0,
            p_run,
        }
    }

    /// Takes a filtered sample; true where its change calls for a run.
    pub fn take(&mut self, sample: Vec3) -> bool {
        let x = self
            .reference
            .map(|reference| (sample - reference).max_norm());
        self.newest = Some(sample);
        if self.mode == Reference::PreviousSample || self.reference.is_none() {
            self.reference = Some(sample);
        }
        self.change = x.or(self.change);
        x.is_none_or(|x| x > self.threshold)
    }

    /// A run happened: with `last-run`, the newest sample becomes the reference.
    pub fn on_run(&mut self) {
        if self.mode == Reference::LastRun {
            self.reference = self.newest.or(self.reference);
        }
        self.change = None;
    }

    /// The chip's own reference was set to this sample.
    pub fn rearm(&mut self, sample: Vec3) {
        self.newest = Some(sample);
        self.reference = Some(sample);
        self.change = None;
    }

    /// The newest change that was measured since the last run.
    #[must_use]
    pub fn change(&self) -> Option<f32> {
        self.change
    }

    /// The newest sample.
    #[must_use]
    pub fn newest(&self) -> Option<Vec3> {
        self.newest
    }

    /// Swaps a fit in.
    pub fn set_fit(&mut self, fit: Fit) {
        self.fit = fit;
        self.threshold = match fit {
            Fit::Unfit => 0.0,
            Fit::Irrelevant => f32::INFINITY,
            Fit::Model(model) => finite_or_zero(model.crossing(self.p_run)),
        };
    }

    /// What the labels say of this input.
    #[must_use]
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// The probability of a changed command above which this input calls for a run.
    #[must_use]
    pub fn p_run(&self) -> f32 {
        self.p_run
    }

    /// The model, where there is one.
    #[must_use]
    pub fn model(&self) -> Option<Logistic> {
        match self.fit {
            Fit::Model(model) => Some(model),
            Fit::Unfit | Fit::Irrelevant => None,
        }
    }

    /// The change above which this input calls for a run, in its SI unit.
    ///
    /// Zero or negative where any change does; infinite where none does.
    #[must_use]
    pub fn threshold(&self) -> f32 {
        self.threshold
    }
}

fn finite_or_zero(x: f32) -> f32 {
    if x.is_finite() { x } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along_x(x: f32) -> Vec3 {
        Vec3::new(x, 0.0, 0.0)
    }

    fn fitted(mode: Reference) -> Trigger {
        let mut trigger = Trigger::new(mode, 0.5);
        // Crosses one half at 0.1.
        trigger.set_fit(Fit::Model(Logistic { b1: -1.0, b2: 10.0 }));
        trigger.take(along_x(0.0));
        trigger
    }

    #[test]
    fn a_slow_ramp_triggers_against_the_last_run_only() {
        let mut last_run = fitted(Reference::LastRun);
        let mut previous = fitted(Reference::PreviousSample);
        let samples = (1..10).map(|step| along_x(step as f32 * 0.03));
        assert!(samples.clone().any(|sample| last_run.take(sample)));
        assert!(!samples.clone().any(|sample| previous.take(sample)));
    }

    #[test]
    fn after_a_run_the_newest_sample_is_the_reference() {
        let mut trigger = fitted(Reference::LastRun);
        assert!(trigger.take(along_x(0.2)));
        trigger.on_run();
        assert!(!trigger.take(along_x(0.25)));
        assert!(trigger.take(along_x(0.05)));
    }

    #[test]
    fn an_unfit_input_always_triggers_and_an_irrelevant_one_never() {
        let mut trigger = Trigger::new(Reference::LastRun, 0.6);
        assert!(
            trigger.take(along_x(0.0)),
            "the first sample has no reference"
        );
        assert!(trigger.take(along_x(1e-3)));
        trigger.set_fit(Fit::Irrelevant);
        assert!(!trigger.take(along_x(1e3)));
    }

    #[test]
    fn a_model_that_cannot_be_inverted_calls_for_every_run() {
        let mut trigger = Trigger::new(Reference::LastRun, 0.6);
        trigger.set_fit(Fit::Model(Logistic { b1: 0.0, b2: 0.0 }));
        assert_eq!(trigger.threshold(), 0.0);
    }
}

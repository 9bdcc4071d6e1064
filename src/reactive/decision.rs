//! The decision of one input: does a change of this size call for a run?

use super::logistic::LogOdds;
use super::{Fit, Logistic};

/// How large a change is, and from where on it calls for a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    change: Option<f32>,
    /// The change that the last run met.
    met: Option<f32>,
    fit: Fit,
    threshold: f32,
    rest: Rest,
    p_run: f32,
    /// Of `p_run`, kept because a model is swapped in under a lock.
    odds: LogOdds,
}

/// What decides where no model does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rest {
    /// Every change calls for a run until there is a model.
    Open,
    /// No change calls for a run until there is a model.
    Closed,
    /// A change past this one calls for a run, model or none.
    Budget(f32),
}

impl Decision {
    /// Without a model.
    #[must_use]
    pub fn new(p_run: f32, rest: Rest) -> Self {
        let mut decision = Self {
            change: None,
            met: None,
            fit: Fit::Unfit,
            threshold: 0.0,
            rest,
            p_run,
            odds: LogOdds::of(p_run),
        };
        decision.set_fit(Fit::Unfit);
        decision
    }

    /// Takes a change; true where it calls for a run.
    ///
    /// The hot path of reactive control: one comparison. Without a change to look at, for the
    /// first sample of all, the answer is yes.
    pub fn take(&mut self, x: Option<f32>) -> bool {
        let Some(x) = x else {
            return self.rest == Rest::Open;
        };
        self.change = Some(x);
        x > self.threshold
    }

    /// False where no change calls for a run.
    #[must_use]
    pub fn may_call(&self) -> bool {
        self.threshold < f32::INFINITY
    }

    /// A run happened: what was measured before it is of no use.
    pub fn on_run(&mut self) {
        self.met = self.change.take();
    }

    /// The change that the last run met.
    #[must_use]
    pub fn met(&self) -> Option<f32> {
        self.met
    }

    /// The newest change that was measured since the last run.
    #[must_use]
    pub fn change(&self) -> Option<f32> {
        self.change
    }

    /// The probability that a run now would change the command, by this input's own model.
    #[must_use]
    pub fn probability(&self) -> Option<f32> {
        Some(self.model()?.probability(self.change?))
    }

    /// Swaps a fit in.
    pub fn set_fit(&mut self, fit: Fit) {
        self.fit = fit;
        self.threshold = match (self.rest, fit) {
            (Rest::Budget(budget), _) => budget,
            (Rest::Open, Fit::Unfit) => 0.0,
            (Rest::Closed, Fit::Unfit) | (_, Fit::Irrelevant) => f32::INFINITY,
            (_, Fit::Model(model)) => finite_or_zero(model.crossing_at(self.odds)),
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

    /// True where there is something to decide by: a model, or a budget.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        matches!(self.rest, Rest::Budget(_)) || self.model().is_some()
    }

    /// The model, where there is one.
    #[must_use]
    pub fn model(&self) -> Option<Logistic> {
        match self.fit {
            Fit::Model(model) => Some(model),
            Fit::Unfit | Fit::Irrelevant => None,
        }
    }

    /// The change above which this input calls for a run, in its unit.
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

    #[test]
    fn a_change_calls_for_a_run_past_the_crossing_of_the_model() {
        let mut decision = Decision::new(0.5, Rest::Open);
        decision.set_fit(Fit::Model(Logistic { b1: -1.0, b2: 10.0 }));
        assert!((decision.threshold() - 0.1).abs() < 1e-6);
        assert!(!decision.take(Some(0.09)));
        assert!(decision.take(Some(0.11)));
        assert!(decision.probability().expect("a model and a change") > 0.5);
    }

    #[test]
    fn an_unfit_input_always_triggers_and_an_irrelevant_one_never() {
        let mut decision = Decision::new(0.6, Rest::Open);
        assert!(decision.take(None), "the first sample has no change");
        assert!(decision.take(Some(1e-3)));
        decision.set_fit(Fit::Irrelevant);
        assert!(!decision.take(Some(1e3)));
    }

    #[test]
    fn a_model_that_cannot_be_inverted_calls_for_every_run() {
        let mut decision = Decision::new(0.6, Rest::Open);
        decision.set_fit(Fit::Model(Logistic { b1: 0.0, b2: 0.0 }));
        assert_eq!(decision.threshold(), 0.0);
    }

    #[test]
    fn a_run_leaves_no_change_behind() {
        let mut decision = Decision::new(0.6, Rest::Open);
        decision.take(Some(0.3));
        decision.on_run();
        assert_eq!(decision.change(), None);
    }
}

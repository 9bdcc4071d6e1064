//! The fit of one input's model to its labels.
//!
//! Ordinary least squares on the logit of 0/1 labels, as published, is undefined. So: the logit
//! of each bin's smoothed share, weighted least squares as a start, then Newton steps of the
//! maximum likelihood on the same bins. Runs in idle, on a copy.

use super::labels::Bin;
use super::logistic::log_odds;
use super::{Labels, Logistic};
use crate::config::LABELS_OF_EACH_CLASS;
use crate::sensors::Input;

/// What the labels of an input say.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Fit {
    /// Too few labels, one class only, or no finite coefficients.
    ///
    /// For the leading input also a change that tells nothing: all else is measured against it.
    Unfit,
    /// Enough labels, and the change tells nothing that the leading input does not: there is
    /// none, or that one always tells first, or no command changed with it, or a model with a rising probability explains the
    /// labels no better than a constant. The input joins and never triggers.
    Irrelevant,
    /// The model.
    Model(Logistic),
}

impl Fit {
    /// False for a model that is no model: coefficients that are not finite, or do not rise.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        match self {
            Self::Unfit | Self::Irrelevant => true,
            Self::Model(model) => model.b1.is_finite() && model.b2.is_finite() && model.b2 > 0.0,
        }
    }
}

/// Labels to fit, copied out of the autopilot under one short lock.
#[derive(Clone, Copy, Debug)]
pub struct RefitJob {
    /// Whose labels.
    pub input: Input,
    /// The others are judged against this one: it is never irrelevant.
    pub leads: bool,
    /// The labels.
    pub labels: Labels,
}

/// A fit to swap in.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Refit {
    /// Whose model.
    pub input: Input,
    /// What the labels say.
    pub fit: Fit,
}

impl RefitJob {
    /// Fits the model: the long part, done without any lock.
    #[must_use]
    pub fn fit(&self) -> Refit {
        let mut labels = self.labels;
        labels.settle();
        let fit = match fit(&labels) {
            Fit::Irrelevant if self.leads => Fit::Unfit,
            fit => fit,
        };
        Refit {
            input: self.input,
            fit,
        }
    }
}

/// Twice the log-likelihood that a slope must gain over a constant to be believed.
///
/// The 0.1 % point of the chi-square distribution of one degree of freedom.
const EVIDENCE: f32 = 10.83;

/// Newton steps after the start; the likelihood is concave, they converge quadratically.
const NEWTON_STEPS: u8 = 8;

/// Labels after which an input that never varies, or never told of a change, is done with.
const ENOUGH: f32 = 200.0;

fn fit(labels: &Labels) -> Fit {
    const NEEDED: f32 = LABELS_OF_EACH_CLASS as f32;
    let varies = labels.bins().count() >= 2;
    if labels.with_overtaken() >= ENOUGH && !(varies && labels.of_changed() >= NEEDED) {
        return Fit::Irrelevant;
    }
    if !varies || labels.of_rarer_class() < NEEDED {
        return Fit::Unfit;
    }
    // In units of the mean change, so that both coefficients are of order one.
    let unit = labels.bins().map(|bin| bin.sum).sum::<f32>() / labels.total();
    if !(unit > 0.0 && unit.is_finite()) {
        return Fit::Unfit;
    }
    let Some(start) = least_squares(labels, unit) else {
        return Fit::Unfit;
    };
    let mut best = Candidate::new(labels, unit, start);
    for _ in 0..NEWTON_STEPS {
        match newton_step(labels, unit, &best) {
            Some(better) => best = better,
            None => break,
        }
    }
    judge(labels, unit, &best)
}

/// A model with its likelihood: each costs a pass over all bins, and is looked at twice.
struct Candidate {
    model: Logistic,
    likelihood: f32,
}

impl Candidate {
    fn new(labels: &Labels, unit: f32, model: Logistic) -> Self {
        Self {
            model,
            likelihood: likelihood(labels, unit, model),
        }
    }
}

fn judge(labels: &Labels, unit: f32, Candidate { model, likelihood }: &Candidate) -> Fit {
    let slope = model.b2 / unit;
    if !(model.b1.is_finite() && slope.is_finite()) {
        return Fit::Unfit;
    }
    if slope <= 0.0 {
        return Fit::Irrelevant;
    }
    let share = labels.bins().map(|bin| bin.changed).sum::<f32>() / labels.total();
    let constant = Logistic {
        b1: log_odds(share),
        b2: 0.0,
    };
    let gain = likelihood - Candidate::new(labels, unit, constant).likelihood;
    if 2.0 * gain < EVIDENCE {
        return Fit::Irrelevant;
    }
    Fit::Model(Logistic {
        b1: model.b1,
        b2: slope,
    })
}

fn position(bin: &Bin, unit: f32) -> f32 {
    bin.sum / (bin.weight * unit)
}

/// Weighted least squares on the smoothed logits of the bins.
fn least_squares(labels: &Labels, unit: f32) -> Option<Logistic> {
    let mut normal = Normal::default();
    for bin in labels.bins() {
        let logit = log_odds((bin.changed + 0.5) / (bin.weight + 1.0));
        let share = (bin.changed + 0.5) / (bin.weight + 1.0);
        let weight = bin.weight * share * (1.0 - share);
        normal.add(position(bin, unit), logit, weight);
    }
    normal.solve()
}

/// One step of the maximum likelihood; `None` where it is at its end or fails to gain.
fn newton_step(labels: &Labels, unit: f32, best: &Candidate) -> Option<Candidate> {
    let from = best.model;
    let mut normal = Normal::default();
    for bin in labels.bins() {
        let x = position(bin, unit);
        let share = from.probability(x);
        let weight = (bin.weight * share * (1.0 - share)).max(1e-6);
        let residual = (bin.changed - bin.weight * share) / weight;
        normal.add(x, residual, weight);
    }
    let step = normal.solve()?;
    // Half the step until the likelihood gains: far out the quadratic model overshoots.
    (0..6)
        .map(|halvings| 1.0 / (1 << halvings) as f32)
        .map(|share| Logistic {
            b1: from.b1 + step.b1 * share,
            b2: from.b2 + step.b2 * share,
        })
        .map(|to| Candidate::new(labels, unit, to))
        .find(|to| to.likelihood > best.likelihood)
}

fn likelihood(labels: &Labels, unit: f32, model: Logistic) -> f32 {
    labels
        .bins()
        .map(|bin| {
            let share = model
                .probability(position(bin, unit))
                .clamp(1e-6, 1.0 - 1e-6);
            bin.changed * libm::logf(share) + (bin.weight - bin.changed) * libm::logf(1.0 - share)
        })
        .sum()
}

/// The normal equations of a line.
#[derive(Default)]
struct Normal {
    weight: f32,
    x: f32,
    xx: f32,
    y: f32,
    xy: f32,
}

impl Normal {
    fn add(&mut self, x: f32, y: f32, weight: f32) {
        self.weight += weight;
        self.x += weight * x;
        self.xx += weight * x * x;
        self.y += weight * y;
        self.xy += weight * x * y;
    }

    fn solve(&self) -> Option<Logistic> {
        let determinant = self.weight * self.xx - self.x * self.x;
        let b2 = (self.weight * self.xy - self.x * self.y) / determinant;
        let b1 = (self.y - b2 * self.x) / self.weight;
        (determinant > 0.0 && b1.is_finite() && b2.is_finite()).then_some(Logistic { b1, b2 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{CHIP_MAG, GYRO};
    use crate::reactive::Label;
    use proptest::prelude::*;

    fn label(x: f32, changed: bool, weight: f32) -> Label {
        Label { x, changed, weight }
    }

    /// Labels with exactly the expected share of *changed* at each change.
    fn labelled(model: Logistic, changes: impl Iterator<Item = f32>) -> Labels {
        let mut labels = Labels::new(&GYRO.changes);
        for x in changes {
            let share = model.probability(x);
            labels.add(&label(x, true, 20.0 * share));
            labels.add(&label(x, false, 20.0 * (1.0 - share)));
        }
        labels
    }

    proptest! {
        #[test]
        fn the_crossing_of_known_coefficients_is_found(
            b1 in -3.0f32..0.0, crossing in 0.05f32..0.8
        ) {
            let truth = Logistic { b1, b2: (0.405 - b1) / crossing };
            let labels = labelled(truth, (1..400).map(|i| i as f32 * 0.004));
            let Fit::Model(found) = fit(&labels) else {
                return Err(TestCaseError::fail("no model"));
            };
            let at = truth.probability(found.crossing(0.6));
            prop_assert!((at - 0.6).abs() <= 0.03, "{at}");
        }

        #[test]
        fn any_labels_give_finite_coefficients_or_none(
            labels in prop::collection::vec((0.0f32..20.0, any::<bool>(), 0.0f32..300.0), 0..200)
        ) {
            let mut all = Labels::new(&GYRO.changes);
            for (x, changed, weight) in labels {
                all.add(&label(x, changed, weight));
            }
            if let Fit::Model(model) = fit(&all) {
                prop_assert!(model.b1.is_finite() && model.b2.is_finite() && model.b2 > 0.0);
            }
        }
    }

    #[test]
    fn too_few_labels_of_one_class_are_unfit() {
        let mut labels = Labels::new(&GYRO.changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i % 40 != 0, 1.0));
        }
        assert_eq!(fit(&labels), Fit::Unfit);
    }

    #[test]
    fn a_probability_that_falls_with_the_change_is_irrelevant_but_for_the_leading_input() {
        let mut labels = Labels::new(&GYRO.changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i < 400, 1.0));
        }
        let fit = |leads| {
            let job = RefitJob {
                input: Input::Gyro,
                leads,
                labels,
            };
            job.fit().fit
        };
        assert_eq!(fit(false), Fit::Irrelevant);
        assert_eq!(fit(true), Fit::Unfit);
    }

    #[test]
    fn an_input_that_never_told_of_a_changed_command_is_irrelevant() {
        let mut labels = Labels::new(&GYRO.changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i % 100 == 0, 1.0));
        }
        assert_eq!(fit(&labels), Fit::Irrelevant);
    }

    #[test]
    fn a_constant_input_is_irrelevant() {
        let mut labels = Labels::new(&CHIP_MAG.changes);
        for i in 0..1000 {
            labels.add(&label(0.0, i % 3 == 0, 1.0));
        }
        assert_eq!(fit(&labels), Fit::Irrelevant);
    }

    #[test]
    fn separated_classes_still_give_a_finite_threshold_between_them() {
        let mut labels = Labels::new(&GYRO.changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i >= 500, 1.0));
        }
        let Fit::Model(model) = fit(&labels) else {
            panic!("no model");
        };
        let crossing = model.crossing(0.6);
        assert!((0.3..0.7).contains(&crossing), "{crossing}");
    }
}

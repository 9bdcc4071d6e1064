//! The fit of one input's model to its labels.
//!
//! Ordinary least squares on the logit of 0/1 labels, as published, is undefined. So: the logit
//! of each bin's smoothed share, weighted least squares as a start, then Newton steps of the
//! maximum likelihood on the same bins. Runs in idle, on a copy.

use super::labels::{BIN_COUNT, Bin, Point};
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
    /// It is judged by itself, and so never irrelevant: the others are judged against it, or it is a
    /// second opinion.
    pub leads: bool,
    /// Twice the log-likelihood that a slope must gain over a constant to be believed.
    pub evidence: f32,
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
        let fit = match fit(&labels, self.evidence) {
            Fit::Irrelevant if self.leads => Fit::Unfit,
            fit => fit,
        };
        Refit {
            input: self.input,
            fit,
        }
    }
}

/// The evidence that an input needs to trigger beside another: the 0.1 % point of the chi-square
/// distribution of one degree of freedom.
pub const EVIDENCE: f32 = 10.83;

/// Most Newton steps; near its end, where they converge quadratically, a fit takes six.
///
/// Each costs some 110 instructions a point on the target, of which there are up to 96.
const MOST_STEPS: u8 = 14;

/// A step that would raise the log-likelihood by less than this is not worth another look.
const WORTHWHILE: f32 = 1e-3;

/// Labels after which an input that never varies, or never told of a change, is done with.
const ENOUGH: f32 = 200.0;

fn fit(labels: &Labels, evidence: f32) -> Fit {
    const NEEDED: f32 = LABELS_OF_EACH_CLASS as f32;
    let varies = labels.bins().count() >= 2;
    if labels.with_overtaken() >= ENOUGH && !(varies && labels.of_changed() >= NEEDED) {
        return Fit::Irrelevant;
    }
    if !varies || labels.of_rarer_class() < NEEDED {
        return Fit::Unfit;
    }
    let Some(start) = least_squares(labels) else {
        return Fit::Unfit;
    };
    // Each step looks at all of them: worth their room on the stack.
    let points: Points = labels.points().collect();
    let model = most_likely(&points, start);
    judge(labels, model, likelihood(&points, model), evidence)
}

/// All labels as points.
type Points = heapless::Vec<Point, { 4 * BIN_COUNT }>;

/// Newton steps of the maximum likelihood, from a start.
///
/// The likelihood is concave. A step past its top by more than it began before it is halved: far
/// out the quadratic model overshoots.
fn most_likely(points: &Points, start: Logistic) -> Logistic {
    let mut best = Slope::at(points, start);
    let mut share = 1.0;
    for _ in 0..MOST_STEPS {
        let Some(step) = best.step else {
            break;
        };
        let next = Slope::at(
            points,
            Logistic {
                b1: best.model.b1 + step.b1 * share,
                b2: best.model.b2 + step.b2 * share,
            },
        );
        if next.along(&step) >= -best.along(&step) {
            (best, share) = (next, 1.0);
        } else {
            share *= 0.5;
        }
    }
    best.model
}

fn judge(labels: &Labels, model: Logistic, likelihood: f32, evidence: f32) -> Fit {
    if !(model.b1.is_finite() && model.b2.is_finite()) {
        return Fit::Unfit;
    }
    if model.b2 <= 0.0 {
        return Fit::Irrelevant;
    }
    let (changed, all) = (labels.of_changed(), labels.total());
    let constant =
        changed * libm::logf(changed / all) + (all - changed) * libm::logf((all - changed) / all);
    if 2.0 * (likelihood - constant) < evidence {
        return Fit::Irrelevant;
    }
    Fit::Model(no_steeper_than_a_bin(labels, model))
}

/// Log-odds from a probability of 1 % to one of 99 %.
const NEARLY_ALL: f32 = 9.19;

/// The model with the same crossing, its rise no narrower than the bin that it lies in.
///
/// Bins cannot tell finer changes apart. Of classes that do not overlap the likelihood rises with
/// the slope for ever, and a threshold would seem unstable that moves by a thousandth.
fn no_steeper_than_a_bin(labels: &Labels, model: Logistic) -> Logistic {
    let crossing = model.crossing(0.5);
    let steepest = NEARLY_ALL / labels.bin_width(crossing);
    if model.b2 <= steepest || !steepest.is_finite() {
        return model;
    }
    Logistic {
        b1: -steepest * crossing,
        b2: steepest,
    }
}

/// Weighted least squares on the smoothed logits of the bins.
fn least_squares(labels: &Labels) -> Option<Logistic> {
    let centre = labels.bins().map(Bin::sum).sum::<f32>() / labels.total();
    let mut normal = Normal::around(centre);
    for bin in labels.bins() {
        let share = (bin.changed.weight + 0.5) / (bin.weight() + 1.0);
        let weight = bin.weight() * share * (1.0 - share);
        normal.add(bin.sum() / bin.weight(), weight, weight * log_odds(share));
    }
    normal.solve()
}

/// The slope of the log-likelihood at a model.
struct Slope {
    model: Logistic,
    normal: Normal,
    /// The Newton step from here, where it is worth making.
    step: Option<Logistic>,
}

impl Slope {
    fn at(points: &Points, model: Logistic) -> Self {
        // Most of the weight lies around the crossing, which may be far from zero.
        let crossing = model.crossing(0.5);
        let far = model.b2 <= 0.0 || !crossing.is_finite();
        let mut normal = Normal::around(if far { 0.0 } else { crossing.max(0.0) });
        for Point { x, changed, weight } in points {
            let share = model.probability(*x);
            let outcome = if *changed { 1.0 } else { 0.0 };
            normal.add(
                *x,
                weight * share * (1.0 - share),
                weight * (outcome - share),
            );
        }
        let step = normal.solve();
        Self {
            model,
            step: step.filter(|step| 0.5 * normal.along(step) > WORTHWHILE),
            normal,
        }
    }

    /// How fast the log-likelihood rises along a step.
    fn along(&self, step: &Logistic) -> f32 {
        self.normal.along(step)
    }
}

/// The logarithm of the labels' likelihood.
fn likelihood(points: &Points, model: Logistic) -> f32 {
    let of_point = |point: &Point| {
        let log_odds = model.b1 + model.b2 * point.x;
        point.weight * log_share(if point.changed { log_odds } else { -log_odds })
    };
    points.iter().map(of_point).sum()
}

/// `ln(L)` of the log-odds, for any: far below zero it is the log-odds themselves.
fn log_share(log_odds: f32) -> f32 {
    if log_odds < -15.0 {
        return log_odds;
    }
    -libm::logf(1.0 + libm::expf(-log_odds))
}

/// The normal equations of a line.
struct Normal {
    /// Sums of changes that hardly differ would lose the difference: they start here.
    centre: f32,
    weight: f32,
    x: f32,
    xx: f32,
    y: f32,
    xy: f32,
}

impl Normal {
    fn around(centre: f32) -> Self {
        Self {
            centre,
            weight: 0.0,
            x: 0.0,
            xx: 0.0,
            y: 0.0,
            xy: 0.0,
        }
    }

    /// Adds a point of the line with its weight, and its height times its weight.
    fn add(&mut self, x: f32, weight: f32, weighted_y: f32) {
        let x = x - self.centre;
        self.weight += weight;
        self.x += weight * x;
        self.xx += weight * x * x;
        self.y += weighted_y;
        self.xy += weighted_y * x;
    }

    /// A step times the slope that the heights are.
    fn along(&self, step: &Logistic) -> f32 {
        let at_centre = step.b1 + step.b2 * self.centre;
        at_centre * self.y + step.b2 * self.xy
    }

    fn solve(&self) -> Option<Logistic> {
        let determinant = self.weight * self.xx - self.x * self.x;
        let b2 = (self.weight * self.xy - self.x * self.y) / determinant;
        let b1 = (self.y - b2 * self.x) / self.weight - b2 * self.centre;
        (determinant > 0.0 && b1.is_finite() && b2.is_finite()).then_some(Logistic { b1, b2 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::of_input;
    use crate::reactive::Label;
    use proptest::prelude::*;

    fn label(x: f32, changed: bool, weight: f32) -> Label {
        Label { x, changed, weight }
    }

    /// Labels with exactly the expected share of *changed* at each change.
    fn labelled(model: Logistic, changes: impl Iterator<Item = f32>) -> Labels {
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
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
            let Fit::Model(found) = fit(&labels, EVIDENCE) else {
                return Err(TestCaseError::fail("no model"));
            };
            let at = truth.probability(found.crossing(0.6));
            prop_assert!((at - 0.6).abs() <= 0.03, "{at}");
        }

        #[test]
        fn any_labels_give_finite_coefficients_or_none(
            labels in prop::collection::vec((0.0f32..20.0, any::<bool>(), 0.0f32..300.0), 0..200)
        ) {
            let mut all = Labels::new(&of_input(Input::Gyro).changes);
            for (x, changed, weight) in labels {
                all.add(&label(x, changed, weight));
            }
            if let Fit::Model(model) = fit(&all, EVIDENCE) {
                prop_assert!(model.b1.is_finite() && model.b2.is_finite() && model.b2 > 0.0);
            }
        }
    }

    #[test]
    fn too_few_labels_of_one_class_are_unfit() {
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i % 40 != 0, 1.0));
        }
        assert_eq!(fit(&labels, EVIDENCE), Fit::Unfit);
    }

    #[test]
    fn a_probability_that_falls_with_the_change_is_irrelevant_but_for_the_leading_input() {
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i < 400, 1.0));
        }
        let fit = |leads| {
            let job = RefitJob {
                input: Input::Gyro,
                leads,
                evidence: EVIDENCE,
                labels,
            };
            job.fit().fit
        };
        assert_eq!(fit(false), Fit::Irrelevant);
        assert_eq!(fit(true), Fit::Unfit);
    }

    #[test]
    fn an_input_that_never_told_of_a_changed_command_is_irrelevant() {
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i % 100 == 0, 1.0));
        }
        assert_eq!(fit(&labels, EVIDENCE), Fit::Irrelevant);
    }

    #[test]
    fn a_constant_input_is_irrelevant() {
        let mut labels = Labels::new(&of_input(Input::ChipMag).changes);
        for i in 0..1000 {
            labels.add(&label(0.0, i % 3 == 0, 1.0));
        }
        assert_eq!(fit(&labels, EVIDENCE), Fit::Irrelevant);
    }

    #[test]
    fn separated_classes_still_give_a_finite_threshold_between_them() {
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        for i in 0..1000 {
            labels.add(&label(i as f32 * 0.001, i >= 500, 1.0));
        }
        let Fit::Model(model) = fit(&labels, EVIDENCE) else {
            panic!("no model");
        };
        let crossing = model.crossing(0.6);
        assert!((0.3..0.7).contains(&crossing), "{crossing}");
    }
}

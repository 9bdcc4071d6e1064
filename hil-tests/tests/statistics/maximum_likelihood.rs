//! Maximum-likelihood logistic fits by the crate `linfa-logistic`, unbinned.
//!
//! The library has no sample weights, so weighted samples are repeated; and it stops by a
//! tolerance of its own, so every fit is certified here: the likelihood is concave, and where a
//! Newton step over the weighted samples goes nowhere, the maximum has been found.

use linfa::prelude::*;
use linfa_logistic::LogisticRegression;
use ndarray::{Array1, Array2};

/// One label, unbinned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) x: f64,
    pub(super) changed: bool,
    pub(super) weight: f64,
}

/// What maximum likelihood says.
#[derive(Clone, Copy, Debug)]
pub(super) enum Likeliest {
    Model(Model),
    /// No change up to `below`, always one from `above` on: any threshold between the two
    /// explains all, and the slope has no maximum.
    Separated {
        below: f64,
        above: f64,
    },
    /// The library did not find the maximum.
    Unknown,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    pub(super) b1: f64,
    pub(super) b2: f64,
}

/// Copies of the rarer class, at least: what rounding weights to copies may shift is less than
/// one in this many.
const COPIES: f64 = 1000.0;

/// How far a Newton step may still move the log-odds anywhere near the threshold.
const CERTAIN: f64 = 0.05;

impl Model {
    pub(super) fn probability(&self, x: f64) -> f64 {
        logistic(self.b1 + self.b2 * x)
    }

    pub(super) fn crossing(&self, p: f64) -> f64 {
        ((p / (1.0 - p)).ln() - self.b1) / self.b2
    }

    /// What one Newton step over the samples would add to the log-odds at `x`.
    fn newton_step(&self, samples: &[Sample]) -> Self {
        let [mut w, mut wx, mut wxx, mut g, mut gx] = [0.0; 5];
        for sample in samples {
            let p = self.probability(sample.x);
            let weight = sample.weight * p * (1.0 - p);
            let residual = sample.weight * (f64::from(u8::from(sample.changed)) - p);
            w += weight;
            wx += weight * sample.x;
            wxx += weight * sample.x * sample.x;
            g += residual;
            gx += residual * sample.x;
        }
        let determinant = w * wxx - wx * wx;
        Self {
            b1: (wxx * g - wx * gx) / determinant,
            b2: (w * gx - wx * g) / determinant,
        }
    }

    /// The largest move of the log-odds that a Newton step would make where the probability is
    /// between 0.2 and 0.9.
    pub(super) fn uncertainty(&self, samples: &[Sample]) -> f64 {
        let step = self.newton_step(samples);
        [0.2, 0.9]
            .map(|p| (step.b1 + step.b2 * self.crossing(p)).abs())
            .into_iter()
            .fold(0.0, f64::max)
    }
}

impl Model {
    /// The standard error of the log-odds at the crossing of `p`, from the information.
    pub(super) fn deviation(&self, samples: &[Sample], p: f64) -> f64 {
        let x = self.crossing(p);
        let [mut w, mut wd, mut wdd] = [0.0; 3];
        for sample in samples {
            let share = self.probability(sample.x);
            let (weight, d) = (sample.weight * share * (1.0 - share), sample.x - x);
            w += weight;
            wd += weight * d;
            wdd += weight * d * d;
        }
        (wdd / (w * wdd - wd * wd)).sqrt()
    }
}

fn logistic(z: f64) -> f64 {
    1.0 / (1.0 + (-z).exp())
}

/// Fits the samples.
pub(super) fn likeliest(samples: &[Sample]) -> Likeliest {
    let xs_of = |changed| {
        let of_class = samples.iter().filter(move |s| s.changed == changed);
        of_class.map(|s| s.x)
    };
    let below = xs_of(false).fold(f64::NEG_INFINITY, f64::max);
    let above = xs_of(true).fold(f64::INFINITY, f64::min);
    if below < above {
        return Likeliest::Separated { below, above };
    }
    let model = fit(samples);
    if model.uncertainty(samples) <= CERTAIN {
        Likeliest::Model(model)
    } else {
        Likeliest::Unknown
    }
}

/// The library's fit, repeated in units in which the model before it is of order one: only near
/// the crossing do samples weigh, and far from it the library's steps lose their way.
fn fit(samples: &[Sample]) -> Model {
    let total: f64 = samples.iter().map(|s| s.weight).sum();
    let mean = samples.iter().map(|s| s.weight * s.x).sum::<f64>() / total;
    let square = |s: &Sample| s.weight * (s.x - mean) * (s.x - mean);
    let deviation = (samples.iter().map(square).sum::<f64>() / total).sqrt();
    let copies = copies(samples);
    let mut model = fit_copies(&copies, mean, deviation);
    for _ in 0..6 {
        if model.b2 <= 0.0 || model.uncertainty(samples) <= CERTAIN {
            break;
        }
        model = fit_copies(&copies, model.crossing(0.5), 1.0 / model.b2);
    }
    model
}

fn fit_copies(copies: &[(f64, bool)], centre: f64, unit: f64) -> Model {
    let xs = copies.iter().map(|(x, _)| (x - centre) / unit).collect();
    let records = Array2::from_shape_vec((copies.len(), 1), xs).expect("one column");
    let targets: Array1<bool> = copies.iter().map(|(_, changed)| *changed).collect();
    let fitted = LogisticRegression::default()
        .alpha(0.0)
        .max_iterations(200)
        .gradient_tolerance(1e-8 * copies.len() as f64)
        .fit(&Dataset::new(records, targets))
        .expect("the library fits");
    // The library models the class that it calls positive.
    let sign = if fitted.labels().pos.class { 1.0 } else { -1.0 };
    let slope = sign * fitted.params()[0] / unit;
    Model {
        b1: sign * fitted.intercept() - slope * centre,
        b2: slope,
    }
}

/// Each sample as often as it weighs, in units of a small weight.
///
/// In the order of `x`, what rounding leaves over goes to the next sample of the class.
fn copies(samples: &[Sample]) -> Vec<(f64, bool)> {
    let weight_of = |changed| {
        let of_class = samples.iter().filter(move |s| s.changed == changed);
        of_class.map(|s| s.weight).sum::<f64>()
    };
    let equal = samples.iter().all(|s| s.weight == samples[0].weight);
    let unit = if equal {
        samples[0].weight
    } else {
        weight_of(true).min(weight_of(false)) / COPIES
    };
    let mut sorted = samples.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut copies = Vec::new();
    for changed in [false, true] {
        let mut owed = 0.5;
        for sample in sorted.iter().filter(|s| s.changed == changed) {
            owed += sample.weight / unit;
            while owed >= 1.0 {
                owed -= 1.0;
                copies.push((sample.x, changed));
            }
        }
    }
    copies
}

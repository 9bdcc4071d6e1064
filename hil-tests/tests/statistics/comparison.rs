//! The firmware's threshold under the maximum-likelihood model.

use reflex::reactive::{EVIDENCE, Fit, Labels, RefitJob};
use reflex::sensors::Input;

use super::maximum_likelihood::{Likeliest, Model, Sample, likeliest};

/// Probabilities at which thresholds are compared.
pub(super) const P_RUNS: [f64; 8] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// The result of a comparison.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outcome {
    /// The largest `|L(x*) - P_run|`, with the library's `L`, over all `P_RUNS`.
    Off(f64),
    /// The classes are separated, or go from one to the other within a bin, which no statistics by
    /// bins can see: how far `x*` misses the gap between them, or the library's own, at most, as
    /// a share of the change there.
    Misses(f64),
    /// The firmware made no model: too few labels, or none with information.
    NoModel,
    /// The library did not find the maximum.
    Unknown,
}

/// Fits the labels of an input that leads in both ways.
pub(super) fn compare(binned: &Labels, samples: &[Sample]) -> Outcome {
    let job = RefitJob {
        input: Input::Gyro,
        leads: true,
        evidence: EVIDENCE,
        labels: *binned,
    };
    let Fit::Model(model) = job.fit().fit else {
        return Outcome::NoModel;
    };
    let crossing = |p_run: f64| f64::from(model.crossing(p_run as f32));
    let worst = |off: &dyn Fn(f64) -> f64| P_RUNS.into_iter().map(off).fold(0.0, f64::max);
    match likeliest(samples) {
        Likeliest::Model(likeliest) if is_within_a_bin(&likeliest, binned) => {
            Outcome::Misses(worst(&|p_run| {
                let wanted = likeliest.crossing(p_run);
                (crossing(p_run) - wanted).abs() / wanted
            }))
        }
        Likeliest::Model(likeliest) => Outcome::Off(worst(&|p_run| {
            (likeliest.probability(crossing(p_run)) - p_run).abs()
        })),
        Likeliest::Unknown => Outcome::Unknown,
        Likeliest::Separated { below, above } => Outcome::Misses(worst(&|p_run| {
            let x = crossing(p_run);
            (below - x).max(x - above).max(0.0) / above
        })),
    }
}

/// Whether a model rises from a tenth to nine tenths within the bin of its crossing.
fn is_within_a_bin(model: &Model, binned: &Labels) -> bool {
    let rise = 2.0 * f64::ln(9.0) / model.b2;
    let width = binned.bin_width(model.crossing(0.5) as f32);
    model.b2 > 0.0 && rise < f64::from(width)
}

//! The fit on made-up labels whose coefficients are known.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Exp1, LogNormal, Pareto, StandardUniform};
use reflex::config::of_input;
use reflex::reactive::{EVIDENCE, Fit, Label, Labels, RefitJob};
use reflex::sensors::Input;

use super::comparison::{Outcome, compare};
use super::maximum_likelihood::{Likeliest, Model, Sample, likeliest};

/// How the sizes of made-up changes are spread; all in units of the crossing.
#[derive(Clone, Copy, Debug)]
enum Sizes {
    LogNormal,
    Exponential,
    HeavyTailed,
}

impl Sizes {
    fn draw(self, random: &mut ChaCha8Rng) -> f64 {
        match self {
            Self::LogNormal => LogNormal::new(0.0, 1.0).expect("finite").sample(random),
            Self::Exponential => Exp1.sample(random),
            // Its variance is infinite.
            Self::HeavyTailed => Pareto::new(1.0, 1.5).expect("positive").sample(random) - 1.0,
        }
    }
}

/// A model with this `b1` that crosses 0.6 at `crossing`.
fn truth(b1: f64, crossing: f64) -> Model {
    Model {
        b1,
        b2: ((0.6f64 / 0.4).ln() - b1) / crossing,
    }
}

/// Labels as the model gives them, in single precision as the firmware would see them.
fn labelled(truth: &Model, crossing: f64, sizes: Sizes, count: usize, seed: u64) -> Vec<Sample> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let x = f64::from((crossing * sizes.draw(&mut random)) as f32);
            let drawn: f64 = StandardUniform.sample(&mut random);
            Sample {
                x,
                changed: drawn < truth.probability(x),
                weight: 1.0,
            }
        })
        .collect()
}

fn binned(samples: &[Sample]) -> Labels {
    let mut labels = Labels::new(&of_input(Input::Gyro).changes);
    for sample in samples {
        labels.add(&Label {
            x: sample.x as f32,
            changed: sample.changed,
            weight: sample.weight as f32,
        });
    }
    labels
}

/// Calls `look` for every case in which both classes have 30 samples; returns how many.
fn every_case(b1s: &[f64], mut look: impl FnMut(&Model, &[Sample], &str)) -> usize {
    let mut cases = 0;
    for &b1 in b1s {
        for crossing in [0.01, 0.05, 0.2, 0.8] {
            for sizes in [Sizes::LogNormal, Sizes::Exponential, Sizes::HeavyTailed] {
                for count in [200, 1000, 10_000] {
                    for seed in 1..=3 {
                        let truth = truth(b1, crossing);
                        let samples = labelled(&truth, crossing, sizes, count, seed);
                        let changed = samples.iter().filter(|s| s.changed).count();
                        if changed.min(count - changed) >= 30 {
                            cases += 1;
                            let name = format!("{truth:?} {sizes:?} {count} seed {seed}");
                            look(&truth, &samples, &name);
                        }
                    }
                }
            }
        }
    }
    cases
}

#[test]
fn thresholds_of_known_coefficients_are_those_of_maximum_likelihood() {
    for b1 in [-0.5, -1.5, -3.0, -6.0, -9.0, -12.0] {
        let (mut worst, mut without, mut steep) = ((0.0, String::new()), 0, 0);
        let cases = every_case(&[b1], |_, samples, name| {
            match compare(&binned(samples), samples) {
                Outcome::Off(off) if off > worst.0 => worst = (off, name.to_owned()),
                Outcome::Off(_) => {}
                // The transition lies within a bin of the gyroscope, which is up to 39 % wide.
                Outcome::Misses(by) => {
                    steep += 1;
                    assert!(by <= 0.39, "{name}: {by}");
                }
                Outcome::Unknown => panic!("{name}: nothing to compare"),
                Outcome::NoModel => without += 1,
            }
        });
        println!(
            "b1 {b1}: {cases} cases, {without} without a model, {steep} steep, worst {worst:?}"
        );
        let bound = 0.03;
        assert!(worst.0 <= bound, "{worst:?}");
    }
}

#[test]
fn known_coefficients_are_covered_as_often_as_by_maximum_likelihood() {
    // The true probability at x*, against P_run: binning must not add to the scatter that any
    // estimate from so many samples has.
    let [mut ours, mut best, mut worst] = [0.0f64; 3];
    let mut within = 0;
    let mut models = 0;
    every_case(&[-1.5, -3.0, -6.0], |truth, samples, _| {
        let job = RefitJob {
            input: Input::Gyro,
            leads: true,
            evidence: EVIDENCE,
            labels: binned(samples),
        };
        let (Fit::Model(model), Likeliest::Model(likeliest)) = (job.fit().fit, likeliest(samples))
        else {
            return;
        };
        models += 1;
        let off = truth.probability(f64::from(model.crossing(0.6))) - 0.6;
        let off_best = truth.probability(likeliest.crossing(0.6)) - 0.6;
        ours += off * off;
        best += off_best * off_best;
        worst = worst.max(off.abs());
        within += usize::from(off.abs() <= 1.96 * likeliest.deviation(samples, 0.6) * 0.24);
    });
    let share = within as f64 / models as f64;
    println!(
        "RMS off the truth {:.4}, of maximum likelihood {:.4}, worst {worst:.3}, {share:.3} of {models} within 95 %",
        (ours / models as f64).sqrt(),
        (best / models as f64).sqrt(),
    );
    assert!(ours <= best * 1.05);
    assert!((0.91..=0.99).contains(&share), "{share}");
}

/// A step: everything from `at` on is *changed*, nothing below.
fn step(at: f64, count: usize) -> Vec<Sample> {
    let of = |i: usize| f64::from((2.0 * at * (i as f64 + 0.5) / count as f64) as f32);
    let sample = |i| Sample {
        x: of(i),
        changed: of(i) >= at,
        weight: 1.0,
    };
    (0..count).map(sample).collect()
}

#[test]
fn the_threshold_of_separated_classes_lies_in_the_bin_of_the_gap() {
    // The slope has no maximum and any x* in the gap is as likely; bins know the gap up to their
    // own width, a quarter of the change here.
    for at in [0.011, 0.05, 0.23, 0.9] {
        for count in [100, 1000, 20_000] {
            let samples = step(at, count);
            match compare(&binned(&samples), &samples) {
                Outcome::Misses(by) => {
                    println!("step at {at}, {count} samples: misses by {by:.4}");
                    assert!(by <= 0.27, "{by}");
                }
                other => panic!("{at}: {other:?}"),
            }
        }
    }
}

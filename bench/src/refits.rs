//! Refits of one input, on labels as a flight brings them and on the dearest found.

use core::hint::black_box;

use cortex_m::peripheral::DWT;
use oorandom::Rand32;
use reflex::config::{Changes, of_input};
use reflex::reactive::{BIN_COUNT, Decision, Fit, Label, Labels, Logistic, RefitJob, Rest};
use reflex::sensors::Input;
use reflex_bench::marks::{measured, rounds};
use reflex_bench::{REFIT, SWAP, WORST_REFIT};

pub fn measure() {
    rounds(SWAP, |round| {
        let mut decision = Decision::new(0.6, Rest::Open);
        let fit = Fit::Model(Logistic {
            b1: -2.0,
            b2: 1.0 + round as f32,
        });
        let (decision, fit) = black_box((&mut decision, &fit));
        measured(|| decision.set_fit(*fit));
    });
    let mut chance = Rand32::new(1);
    rounds(REFIT, |_| {
        refit(&Shares::typical(&mut chance));
    });
    search(chance);
}

/// For each bin, the weight of its labels that were *changed*, and of those that were not.
#[derive(Clone, Copy)]
struct Shares([[f32; 2]; BIN_COUNT]);

impl Shares {
    /// A rising probability, all bins alike or fewer labels towards large changes.
    fn typical(chance: &mut Rand32) -> Self {
        let model = Logistic {
            b1: -1.0 - 3.0 * chance.rand_float(),
            b2: 2.0 + 20.0 * chance.rand_float(),
        };
        let falling = chance.rand_float();
        Self(core::array::from_fn(|bin| {
            let weight = 40.0 * (1.0 - falling * bin as f32 / BIN_COUNT as f32);
            let share = model.probability(change(bin));
            [weight * share, weight * (1.0 - share)]
        }))
    }

    /// Nearly separated at some bin, or one class after the other, or by chance.
    fn nasty(chance: &mut Rand32) -> Self {
        let kind = chance.rand_range(0..4);
        let edge = chance.rand_range(1..BIN_COUNT as u32) as usize;
        Self(core::array::from_fn(|bin| {
            let weight = weight(chance);
            let changed = match kind {
                0 => bin >= edge,
                1 => bin % 2 == 0,
                2 => chance.rand_float() < 0.5,
                _ => (bin >= edge) != (chance.rand_float() < 0.1),
            };
            let rest = weight * 0.01 * chance.rand_float();
            if changed {
                [weight, rest]
            } else {
                [rest, weight]
            }
        }))
    }

    /// Some bins anew.
    fn mutated(mut self, chance: &mut Rand32) -> Self {
        for _ in 0..chance.rand_range(1..5) {
            let bin = chance.rand_range(0..BIN_COUNT as u32) as usize;
            let class = chance.rand_range(0..2) as usize;
            self.0[bin][class] = weight(chance);
        }
        self
    }

    fn labels(&self) -> Labels {
        let mut labels = Labels::new(&of_input(Input::Gyro).changes);
        for (bin, weights) in self.0.iter().enumerate() {
            for (weight, changed) in weights.iter().zip([true, false]) {
                labels.add(&Label {
                    x: change(bin),
                    changed,
                    weight: *weight,
                });
            }
        }
        labels
    }
}

/// From hardly anything to a long flight's, even in the logarithm.
fn weight(chance: &mut Rand32) -> f32 {
    let mut weight = 0.01;
    for _ in 0..chance.rand_range(0..16) {
        weight *= 2.0 + chance.rand_float();
    }
    weight.min(5000.0)
}

/// A change in the middle of a bin, which are even in the bits of a float.
fn change(bin: usize) -> f32 {
    let Changes { smallest, largest } = of_input(Input::Gyro).changes;
    let span = u64::from(largest.to_bits() - smallest.to_bits());
    let steps = span * (2 * bin as u64 + 1) / (2 * BIN_COUNT as u64);
    f32::from_bits(smallest.to_bits() + steps as u32)
}

/// Climbs from new starts: what made a refit dearer is kept and varied.
fn search(mut chance: Rand32) {
    const CLIMBS: usize = 16;
    let mut best = (Shares::typical(&mut chance), 0);
    rounds(WORST_REFIT, |round| {
        let steps = WORST_REFIT.rounds / CLIMBS;
        let shares = if round % steps < steps / 4 {
            Shares::nasty(&mut chance)
        } else {
            best.0.mutated(&mut chance)
        };
        if round % steps == 0 {
            best.1 = 0;
        }
        let cost = refit(&shares);
        if cost >= best.1 {
            best = (shares, cost);
        }
    });
}

/// The cycles that the refit took, by the core's own count.
fn refit(shares: &Shares) -> u32 {
    let job = RefitJob {
        input: Input::Gyro,
        leads: true,
        evidence: reflex::reactive::EVIDENCE,
        labels: shares.labels(),
    };
    let job = black_box(&job);
    let start = DWT::cycle_count();
    measured(|| job.fit());
    DWT::cycle_count().wrapping_sub(start)
}

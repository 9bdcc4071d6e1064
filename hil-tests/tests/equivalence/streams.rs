//! Seeded streams of force and field: walks, steps, ramps and vibration.

use std::f64::consts::TAU;
use std::sync::Arc;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};

use chip_models::stimulus::{STANDARD_GRAVITY, Stimulus, StimulusSource};

/// Points per sample of the chip, so that its filters have something to do.
const POINTS_PER_SAMPLE: u64 = 4;

/// Seeded chance.
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// The same numbers for the same seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// A number from `low` to `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        let range = Uniform::new_inclusive(low, high).expect("low is below high");
        range.sample(&mut self.0)
    }

    /// A count from `low` to `high`, both included.
    pub fn count(&mut self, low: u32, high: u32) -> u32 {
        let range = Uniform::new_inclusive(low, high).expect("low is at most high");
        range.sample(&mut self.0)
    }
}

/// How a stream moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Small steps that add up.
    Walk,
    /// Still, then elsewhere at once.
    Steps,
    /// Straight lines, most of them slow.
    Ramps,
    /// Two tones and a drift.
    Vibration,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Walk, Self::Steps, Self::Ramps, Self::Vibration];

    /// One axis over `count` points; `size` is the change that matters.
    fn axis(self, dice: &mut Dice, count: usize, size: f64) -> Vec<f64> {
        match self {
            Self::Walk => walk(dice, count, size),
            Self::Steps => steps(dice, count, size),
            Self::Ramps => ramps(dice, count, size),
            Self::Vibration => vibration(dice, count, size),
        }
    }
}

fn walk(dice: &mut Dice, count: usize, size: f64) -> Vec<f64> {
    let mut value = 0.0;
    let step = |_| {
        value += size * dice.within(-0.25, 0.25);
        value
    };
    (0..count).map(step).collect()
}

fn steps(dice: &mut Dice, count: usize, size: f64) -> Vec<f64> {
    let (mut value, mut left) = (0.0, 0);
    let step = |_| {
        if left == 0 {
            left = dice.count(8, 160);
            value = size * dice.within(-2.0, 2.0);
        }
        left -= 1;
        value
    };
    (0..count).map(step).collect()
}

fn ramps(dice: &mut Dice, count: usize, size: f64) -> Vec<f64> {
    let (mut value, mut slope, mut left) = (0.0, 0.0, 0);
    let step = |_| {
        if left == 0 {
            left = dice.count(40, 400);
            slope = size * dice.within(-0.03, 0.03);
        }
        left -= 1;
        value += slope;
        value
    };
    (0..count).map(step).collect()
}

fn vibration(dice: &mut Dice, count: usize, size: f64) -> Vec<f64> {
    // Radians per point: up to just below half the chip's rate, and a drift.
    let tones = [0.7, 0.3, 1.0].map(|most| most * size * dice.within(0.3, 1.0));
    let speeds = [(0.05, 0.3), (0.3, 0.7), (0.001, 0.01)].map(|(a, b)| dice.within(a, b));
    let start = [0; 3].map(|_| dice.within(0.0, TAU));
    let point = |n: usize| {
        let tone = |i: usize| tones[i] * (start[i] + speeds[i] * n as f64).sin();
        (0..3).map(tone).sum()
    };
    (0..count).map(point).collect()
}

/// A signal over virtual time, held between its points.
pub struct Stream {
    tick_ns: u64,
    points: Vec<[f64; 3]>,
}

impl Stream {
    /// `samples` samples of `period_ns` about `rest`, with changes about `size`.
    pub fn new(
        (kind, seed): (Kind, u64),
        (samples, period_ns): (u32, u64),
        size: f64,
        rest: [f64; 3],
    ) -> Self {
        let mut dice = Dice::new(seed);
        let count = (u64::from(samples) * POINTS_PER_SAMPLE) as usize;
        let axes = rest.map(|_| kind.axis(&mut dice, count, size));
        let at = |n: usize| [0, 1, 2].map(|axis| rest[axis] + axes[axis][n]);
        Self {
            tick_ns: period_ns / POINTS_PER_SAMPLE,
            points: (0..count).map(at).collect(),
        }
    }

    fn at(&self, at_ns: u64) -> [f64; 3] {
        let index = (at_ns / self.tick_ns) as usize;
        self.points[index.min(self.points.len() - 1)]
    }

    /// As specific force; the points are in g.
    pub fn into_force(self) -> Arc<dyn StimulusSource> {
        Arc::new(move |at_ns| Stimulus {
            specific_force: self.at(at_ns).map(|g| g * STANDARD_GRAVITY),
            ..Stimulus::default()
        })
    }

    /// As magnetic field; the points are in gauss.
    pub fn into_field(self) -> Arc<dyn StimulusSource> {
        Arc::new(move |at_ns| Stimulus {
            magnetic_field: self.at(at_ns),
            ..Stimulus::default()
        })
    }
}

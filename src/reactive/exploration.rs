//! Exploration: rare, random runs, so that small changes keep being labelled.
//!
//! Thresholds hide what lies below them; a model that only ever sees triggered runs cannot
//! notice that they have become wrong. The generator is seeded by the settings.

use crate::config::{EXPLORATION_SHARE, EXPLORATION_WEIGHT_CAP};

/// Decides, hyperperiod by hyperperiod, whether to run without being asked.
#[derive(Clone, Debug)]
pub struct Exploration {
    random: oorandom::Rand32,
    /// Hyperperiods until the next run.
    left: u32,
}

impl Exploration {
    /// The weight of a label from an exploration run: the inverse of its probability, truncated.
    ///
    /// Untruncated, a handful of explorations would outweigh thousands of triggered runs;
    /// truncated importance weights trade a little bias for that variance (Ionides 2008).
    pub const WEIGHT: f32 = if 1.0 / EXPLORATION_SHARE < EXPLORATION_WEIGHT_CAP {
        1.0 / EXPLORATION_SHARE
    } else {
        EXPLORATION_WEIGHT_CAP
    };

    /// A generator of the seed.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        let mut exploration = Self {
            random: oorandom::Rand32::new(u64::from(seed)),
            left: 0,
        };
        exploration.wait();
        exploration
    }

    /// True once in `1/EXPLORATION_SHARE` calls on average.
    pub fn draw(&mut self) -> bool {
        let explores = self.left == 0;
        if explores {
            self.wait();
        } else {
            self.left -= 1;
        }
        explores
    }

    /// Draws how many hyperperiods pass by: a geometric distribution, as if each drew for itself.
    #[inline(never)] // Once a second or less.
    fn wait(&mut self) {
        let chance = 1.0 - self.random.rand_float();
        self.left = (libm::logf(chance) / libm::logf(1.0 - EXPLORATION_SHARE)) as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_runs_as_often_as_configured_and_repeats_by_seed() {
        let draws = |seed| {
            let mut exploration = Exploration::new(seed);
            (0..200_000)
                .filter(|_| exploration.draw())
                .collect::<Vec<_>>()
        };
        let share = draws(1).len() as f32 / 200_000.0;
        assert!((share / EXPLORATION_SHARE - 1.0).abs() < 0.15, "{share}");
        assert_eq!(draws(7), draws(7));
        assert_ne!(draws(7), draws(8));
    }
}

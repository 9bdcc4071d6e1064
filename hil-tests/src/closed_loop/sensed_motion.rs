//! A simulated flight as the chips see it: its newest few milliseconds.
//!
//! Chips ask for the past, as their filters delay, and while a bus transfer is played for up to
//! half a millisecond of the future, which is taken to be like the newest present.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

use chip_models::{Stimulus, StimulusSource};

/// Steps that are kept: 0.5 ms or more each, 32 ms. The longest delay of a chip's filter is 19 ms.
const KEPT: usize = 64;

/// The newest steps of a flight, shared between the simulation and the chips.
#[derive(Debug)]
pub(super) struct SensedMotion {
    newest: Mutex<VecDeque<(u64, Stimulus)>>,
}

impl SensedMotion {
    /// Nothing but a first instant.
    pub(super) fn new(at_ns: u64, first: Stimulus) -> Self {
        let mut steps = VecDeque::with_capacity(KEPT + 1);
        steps.push_back((at_ns, first));
        Self {
            newest: Mutex::new(steps),
        }
    }

    /// What is sensed at a later instant than any before.
    pub(super) fn push(&self, at_ns: u64, stimulus: Stimulus) {
        let mut steps = self.steps();
        if steps.len() == KEPT {
            steps.pop_front();
        }
        steps.push_back((at_ns, stimulus));
    }

    fn steps(&self) -> MutexGuard<'_, VecDeque<(u64, Stimulus)>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The steps around an instant, and how far it is from the first to the second.
    fn around<T>(&self, at_ns: u64, join: impl Fn(&Stimulus, &Stimulus, f64) -> T) -> T {
        let steps = self.steps();
        // Nearly always among the newest few.
        let later = steps.iter().rev().take_while(|step| step.0 > at_ns).count();
        let after = steps.len() - later;
        let newest = steps.len() - 1;
        let (from, to) = (&steps[after.max(1) - 1], &steps[after.min(newest)]);
        let share = if to.0 > from.0 && at_ns > from.0 {
            (at_ns - from.0) as f64 / (to.0 - from.0) as f64
        } else {
            0.0
        };
        join(&from.1, &to.1, share)
    }
}

fn between(from: [f64; 3], to: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share)
}

impl StimulusSource for SensedMotion {
    fn at(&self, at_ns: u64) -> Stimulus {
        self.around(at_ns, |from, to, share| Stimulus {
            gyro: between(from.gyro, to.gyro, share),
            specific_force: between(from.specific_force, to.specific_force, share),
            magnetic_field: between(from.magnetic_field, to.magnetic_field, share),
            temperature_c: to.temperature_c,
        })
    }

    fn gyro(&self, at_ns: u64) -> [f64; 3] {
        self.around(at_ns, |from, to, share| between(from.gyro, to.gyro, share))
    }

    fn specific_force(&self, at_ns: u64) -> [f64; 3] {
        self.around(at_ns, |from, to, share| {
            between(from.specific_force, to.specific_force, share)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turning(rate: f64) -> Stimulus {
        Stimulus {
            gyro: [rate, 0.0, -rate],
            ..Stimulus::default()
        }
    }

    #[test]
    fn between_two_steps_signals_are_straight_and_outside_of_all_they_are_held() {
        let motion = SensedMotion::new(1000, turning(1.0));
        motion.push(2000, turning(3.0));
        for (at_ns, rate) in [(0, 1.0), (1000, 1.0), (1250, 1.5), (2000, 3.0), (9000, 3.0)] {
            assert_eq!(motion.gyro(at_ns), [rate, 0.0, -rate], "{at_ns}");
            assert_eq!(motion.at(at_ns).gyro, motion.gyro(at_ns));
        }
    }

    #[test]
    fn only_the_newest_steps_are_kept() {
        let motion = SensedMotion::new(0, turning(0.0));
        for step in 1..=1000u32 {
            motion.push(u64::from(step) * 500, turning(f64::from(step)));
        }
        assert_eq!(motion.steps().len(), KEPT);
        assert_eq!(motion.gyro(999 * 500)[0], 999.0);
    }
}

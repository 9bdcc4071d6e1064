//! The model of one input: the probability that a change calls for a run.

/// `L(x) = 1/(1+exp(-(b1+b2 x)))`, `x` in the input's SI unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Logistic {
    /// Log-odds without any change.
    pub b1: f32,
    /// Log-odds per unit of change; positive in every model in use.
    pub b2: f32,
}

impl Logistic {
    /// The probability that a run on a change of `x` changes the command.
    #[must_use]
    pub fn probability(&self, x: f32) -> f32 {
        1.0 / (1.0 + libm::expf(-(self.b1 + self.b2 * x)))
    }

    /// The change at which the probability reaches `p_run`, the paper's inverse.
    ///
    /// May be zero or negative: then any change calls for a run.
    #[must_use]
    pub fn crossing(&self, p_run: f32) -> f32 {
        self.crossing_at(LogOdds::of(p_run))
    }

    /// The same for a probability whose log-odds are known.
    #[must_use]
    pub(super) fn crossing_at(&self, p_run: LogOdds) -> f32 {
        (p_run.0 - self.b1) / self.b2
    }
}

/// The log-odds of a probability: a logarithm, so 80 instructions to come by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LogOdds(f32);

impl LogOdds {
    /// Never inlined: whoever builds a learner around it would build it twice, 10 KiB of stack.
    #[inline(never)]
    pub(super) fn of(p: f32) -> Self {
        Self(log_odds(p))
    }
}

/// `ln(p/(1-p))` for `p` within (0, 1).
#[must_use]
pub(super) fn log_odds(p: f32) -> f32 {
    libm::logf(p / (1.0 - p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn above_the_crossing_is_more_probable_than_p_run(
            b1 in -6.0f32..3.0, b2 in 0.1f32..200.0, p_run in 0.05f32..0.95
        ) {
            let model = Logistic { b1, b2 };
            let x = model.crossing(p_run);
            prop_assert!((model.probability(x) - p_run).abs() < 1e-3);
            prop_assert!(model.probability(x + 0.5 / b2) > p_run);
        }
    }
}

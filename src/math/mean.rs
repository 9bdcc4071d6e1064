//! A mean over the time so far, until that is long.

use super::min;

/// A mean of all values at first; later ones count as in a low pass of some time constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunningMean {
    value: f32,
    /// Time (s) behind it, up to the time constant.
    behind: f32,
}

impl RunningMean {
    /// Takes a value that held for `dt`; `over` is the time constant, both in s.
    #[inline]
    pub fn take(&mut self, value: f32, dt: f32, over: f32) {
        self.behind = min(self.behind + dt, over);
        if self.behind > 0.0 {
            self.value += (value - self.value) * min(dt / self.behind, 1.0);
        }
    }

    /// The mean; zero before the first value.
    #[must_use]
    pub fn value(&self) -> f32 {
        self.value
    }

    /// The time (s) that it is over, up to the time constant.
    #[must_use]
    pub fn behind(&self) -> f32 {
        self.behind
    }

    /// The next value begins a new mean; until it comes, the old one stands.
    pub fn begin_anew(&mut self) {
        self.behind = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_values_count_alike_and_later_ones_as_in_a_low_pass() {
        let mut mean = RunningMean::default();
        mean.take(3.0, 0.0, 5.0);
        assert_eq!(mean.value(), 0.0, "no time");
        for value in [1.0, 2.0, 3.0, 6.0] {
            mean.take(value, 1.0, 5.0);
        }
        assert_eq!((mean.value(), mean.behind()), (3.0, 4.0));
        for _ in 0..100 {
            mean.take(8.0, 1.0, 5.0);
        }
        assert!((mean.value() - 8.0).abs() < 1e-5);
        mean.begin_anew();
        assert!((mean.value() - 8.0).abs() < 1e-5, "the old one stands");
        mean.take(1.0, 0.5, 5.0);
        assert_eq!(mean.value(), 1.0);
    }
}

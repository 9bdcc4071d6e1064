//! The chips' digital filters, on three axes at once.

use std::f64::consts::{SQRT_2, TAU};

/// A low-pass of first or second order with unit gain at zero frequency.
///
/// Bilinear transform, warped so that the -3 dB corner is exact. It starts
/// settled on its first input: a chip's first valid sample has no transient.
#[derive(Clone, Copy, Debug)]
pub struct LowPass {
    b: [f64; 3],
    a: [f64; 2],
    state: Option<[[f64; 2]; 3]>,
}

impl LowPass {
    /// One pole with its corner at `corner_hz`, run at `rate_hz`.
    pub fn one_pole(corner_hz: f64, rate_hz: f64) -> Self {
        let w = warped(corner_hz, rate_hz);
        let scale = 1.0 / (1.0 + w);
        Self {
            b: [w * scale, w * scale, 0.0],
            a: [(w - 1.0) * scale, 0.0],
            state: None,
        }
    }

    /// A Butterworth of second order with its corner at `corner_hz`.
    pub fn butterworth(corner_hz: f64, rate_hz: f64) -> Self {
        let w = warped(corner_hz, rate_hz);
        let scale = 1.0 / (1.0 + SQRT_2 * w + w * w);
        let b = w * w * scale;
        Self {
            b: [b, 2.0 * b, b],
            a: [
                2.0 * (w * w - 1.0) * scale,
                (1.0 - SQRT_2 * w + w * w) * scale,
            ],
            state: None,
        }
    }

    /// Group delay for slow signals, in periods of the filter's rate.
    pub fn delay(&self) -> f64 {
        let mean = |taps: [f64; 3]| (taps[1] + 2.0 * taps[2]) / taps.iter().sum::<f64>();
        mean(self.b) - mean([1.0, self.a[0], self.a[1]])
    }

    /// Forgets everything: the next input is the new settled value.
    pub fn reset(&mut self) {
        self.state = None;
    }

    /// The filtered value after `input`.
    #[inline]
    pub fn step(&mut self, input: [f64; 3]) -> [f64; 3] {
        let (b, a) = (self.b, self.a);
        let settled = |x: f64| [x * (1.0 - b[0]), x * (b[2] - a[1])];
        let state = self.state.get_or_insert_with(|| input.map(settled));
        let mut output = [0.0; 3];
        for ((y, x), z) in output.iter_mut().zip(input).zip(state) {
            *y = b[0] * x + z[0];
            z[0] = b[1] * x - a[0] * *y + z[1];
            z[1] = b[2] * x - a[1] * *y;
        }
        output
    }
}

fn warped(corner_hz: f64, rate_hz: f64) -> f64 {
    (TAU / 2.0 * corner_hz / rate_hz).tan()
}

/// A first-order high-pass that can be told to take the present as its zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct HighPass {
    zero: [f64; 3],
}

impl HighPass {
    /// How far the zero moves to the input per step, for a corner and a rate.
    pub fn blend(corner_hz: f64, rate_hz: f64) -> f64 {
        1.0 - (-TAU * corner_hz / rate_hz).exp()
    }

    /// The input less the zero; the zero then follows by `blend` of that.
    ///
    /// A step passes whole at first and is `(1 - blend)^n` after `n` more.
    pub fn step(&mut self, input: [f64; 3], blend: f64) -> [f64; 3] {
        let mut output = [0.0; 3];
        for ((y, x), zero) in output.iter_mut().zip(input).zip(&mut self.zero) {
            *y = x - *zero;
            *zero += blend * *y;
        }
        output
    }

    /// Takes `input` as the zero: the output is nothing but change from now on.
    pub fn snap(&mut self, input: [f64; 3]) {
        self.zero = input;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain_at(mut filter: LowPass, hz: f64, rate: f64) -> f64 {
        let wave = |n: usize| (TAU * hz * n as f64 / rate).sin();
        let count = (rate * 2.0) as usize;
        let peak = |from: usize, filter: &mut LowPass| {
            (from..from + count)
                .map(|n| filter.step([wave(n); 3])[0].abs())
                .fold(0.0, f64::max)
        };
        peak(0, &mut filter);
        peak(count, &mut filter)
    }

    #[test]
    fn low_passes_are_3_db_down_at_their_corner() {
        let half_power = std::f64::consts::FRAC_1_SQRT_2;
        for hz in [5.0, 42.0, 98.0, 260.0] {
            for filter in [
                LowPass::one_pole(hz, 8000.0),
                LowPass::butterworth(hz, 8000.0),
            ] {
                let gain = gain_at(filter, hz, 8000.0);
                assert!((gain - half_power).abs() < 0.01, "{hz} Hz: {gain}");
            }
        }
    }

    #[test]
    fn a_low_pass_starts_settled_and_keeps_a_constant() {
        let mut filter = LowPass::butterworth(98.0, 8000.0);
        for _ in 0..100 {
            let out = filter.step([1.0, -2.0, 3.0]);
            for (out, want) in out.iter().zip([1.0, -2.0, 3.0]) {
                assert!((out - want).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_delay_is_that_of_a_slow_ramp() {
        let mut filter = LowPass::butterworth(98.0, 8000.0);
        let mut lag = 0.0;
        for n in 0..8000 {
            let x = f64::from(n);
            lag = x - filter.step([x; 3])[0];
        }
        assert!((lag - filter.delay()).abs() < 1e-6);
        // sqrt(2) / (2 pi 98 Hz) = 2.297 ms is 18.4 periods of 125 us.
        assert!((lag - 18.37).abs() < 0.05, "{lag}");
    }

    #[test]
    fn a_high_pass_forgets_a_step_exponentially() {
        let blend = HighPass::blend(1.0, 100.0);
        let mut filter = HighPass::default();
        let mut out = 0.0;
        for _ in 0..17 {
            out = filter.step([1.0; 3], blend)[0];
        }
        // 16 steps of 10 ms are one time constant, 1 / (2 pi 1 Hz) = 159 ms.
        assert!((out - (-TAU * 0.16).exp()).abs() < 1e-9, "{out}");
    }

    #[test]
    fn a_snap_makes_the_present_value_zero() {
        let mut filter = HighPass::default();
        filter.snap([5.0, 6.0, 7.0]);
        assert_eq!(filter.step([5.0, 7.0, 7.0], 0.1), [0.0, 1.0, 0.0]);
    }
}

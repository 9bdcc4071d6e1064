//! A low-pass filter without delay, for signals known to their end.
//!
//! A first-order filter runs forward and then backward, so that its delays
//! cancel. `dt` is measured between samples. The corners of both passes are set
//! so that together they let half the power through at the stated frequency.

use std::f64::consts::TAU;

use super::track::{Track, seconds};

/// Filters each component; the ends start from their own values.
pub(super) fn zero_phase<const N: usize>(track: &Track<N>, cutoff_hz: f64) -> Track<N> {
    // (1 / (1 + (f/c)^2))^2 = 1/2 at f = cutoff.
    let corner_hz = cutoff_hz / (2.0_f64.sqrt() - 1.0).sqrt();
    let mut values: Vec<[f64; N]> = track.values().to_vec();
    let times = track.times_ns();
    pass(values.iter_mut().zip(times), corner_hz);
    pass(values.iter_mut().zip(times).rev(), corner_hz);
    let mut filtered = values.into_iter();
    track.map(|value| filtered.next().unwrap_or(value))
}

/// One pass of a first-order filter over samples in either direction of time.
fn pass<'a, const N: usize>(
    samples: impl Iterator<Item = (&'a mut [f64; N], &'a i64)>,
    corner_hz: f64,
) {
    let mut last: Option<(i64, [f64; N])> = None;
    for (value, &time) in samples {
        if let Some((last_time, state)) = last {
            let dt = seconds((time - last_time).abs());
            let keep = (-TAU * corner_hz * dt).exp();
            for (component, old) in value.iter_mut().zip(state) {
                *component += (old - *component) * keep;
            }
        }
        last = Some((time, *value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency_hz: f64) -> Track<1> {
        let mut track = Track::new();
        for sample in 0..8000_i64 {
            // 400 Hz with jitter.
            let time = sample * 2_500_000 + sample % 7 * 100_000;
            track.push(time, [(TAU * frequency_hz * seconds(time)).sin()]);
        }
        track
    }

    /// Amplitude and phase (rad) of a frequency, away from the ends.
    fn response(frequency_hz: f64) -> (f64, f64) {
        let (mut re, mut im, mut n) = (0.0, 0.0, 0.0);
        for (time, [value]) in zero_phase(&sine(frequency_hz), 1.0).iter() {
            if (5.0..15.0).contains(&seconds(time)) {
                let angle = TAU * frequency_hz * seconds(time);
                re += value * angle.sin();
                im += value * angle.cos();
                n += 0.5;
            }
        }
        let (re, im): (f64, f64) = (re / n, im / n);
        (re.hypot(im), im.atan2(re))
    }

    #[test]
    fn half_the_power_passes_at_the_cutoff_and_nothing_is_delayed() {
        let (gain, phase) = response(1.0);
        assert!((gain - 0.5_f64.sqrt()).abs() < 0.01, "{gain}");
        assert!(phase.abs() < 0.01, "{phase}");
    }

    #[test]
    fn slow_motion_passes_and_vibration_does_not() {
        assert!(response(0.1).0 > 0.98);
        assert!(response(50.0).0 < 0.01);
    }

    #[test]
    fn a_constant_stays_what_it_is() {
        let mut track = Track::new();
        for time in 0..100 {
            track.push(time * 1_000_000, [0.3, -2.0]);
        }
        assert_eq!(zero_phase(&track, 1.0), track);
    }
}

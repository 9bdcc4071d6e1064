//! Variance, correlation and spectrum against the standard's formulas.

use random_streams::generator;

use super::*;
use crate::environment::Environment;

const SCALE: Scale = Scale {
    intensity: 1.5,
    length: 10.0,
};
const AIRSPEED: f64 = 5.0;
const STEP: f64 = 0.05;

#[test]
fn scales_at_20_ft_and_at_1000_ft_are_the_standards() {
    let mut climate = Environment::calm().wind;
    climate.speed_at_20_ft = 10.0;
    climate.nominal_altitude = 304.8;
    let (horizontal, vertical) = scales(&climate);
    // At 1000 ft 0.177 + 0.823 = 1: all lengths are 1000 ft, all intensities a tenth.
    assert!((horizontal.length - 304.8).abs() < 1e-9);
    assert!((vertical.length - 304.8).abs() < 1e-9);
    assert!((horizontal.intensity - 1.0).abs() < 1e-12);
    assert!((vertical.intensity - 1.0).abs() < 1e-12);
    climate.nominal_altitude = 6.096;
    let (horizontal, vertical) = scales(&climate);
    // 0.177 + 0.01646 = 0.19346; 20 ft / 0.19346^1.2 = 143.57 ft.
    assert!((horizontal.length - 143.57 * 0.3048).abs() < 0.05);
    assert!((horizontal.intensity - 1.0 / 0.19346_f64.powf(0.4)).abs() < 1e-9);
    assert!((vertical.length - 6.096).abs() < 1e-12);
}

/// A long run of each form.
fn runs(samples: usize) -> (Vec<f64>, Vec<f64>) {
    let mut generator = generator(1, 0);
    let mut first = First::new(SCALE, AIRSPEED, STEP, &mut generator);
    let mut second = Second::new(SCALE, AIRSPEED, STEP, &mut generator);
    (0..samples)
        .map(|_| (first.next(&mut generator), second.next(&mut generator)))
        .unzip()
}

fn covariance(values: &[f64], lag: usize) -> f64 {
    let pairs = values.iter().zip(&values[lag..]);
    pairs.map(|(a, b)| a * b).sum::<f64>() / (values.len() - lag) as f64
}

#[test]
fn variance_and_correlation_are_those_of_the_continuous_processes() {
    let (first, second) = runs(2_000_000);
    let variance = SCALE.intensity * SCALE.intensity;
    for lag in [0, 5, 20, 60] {
        let t = lag as f64 * STEP * AIRSPEED / SCALE.length;
        let along = variance * (-t).exp();
        let across = variance * (-t).exp() * (1.0 - 0.5 * t);
        assert!((covariance(&first, lag) - along).abs() < 0.03 * variance);
        assert!((covariance(&second, lag) - across).abs() < 0.03 * variance);
    }
}

/// Two-sided density of a run at an angular frequency, per rad/s.
fn density(values: &[f64], frequency: f64) -> f64 {
    let length = 4096;
    let pieces = values.chunks_exact(length);
    let count = pieces.len() as f64;
    let sum: f64 = pieces
        .map(|piece| {
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (i, value) in piece.iter().enumerate() {
                let window = 1.0 - (std::f64::consts::TAU * i as f64 / length as f64).cos();
                let (s, c) = (frequency * i as f64 * STEP).sin_cos();
                cosine += value * c * window;
                sine += value * s * window;
            }
            // The window 1 - cos has a mean square of 1.5.
            (cosine * cosine + sine * sine) * STEP / (1.5 * length as f64)
        })
        .sum();
    sum / count / std::f64::consts::TAU
}

#[test]
fn spectra_are_the_standards() {
    let (first, second) = runs(2_000_000);
    let time = SCALE.length / AIRSPEED;
    let variance = SCALE.intensity * SCALE.intensity;
    for frequency in [0.1, 0.5, 1.0, 3.0] {
        let turn = time * frequency;
        let square = turn * turn;
        // MIL-F-8785C gives densities for positive frequencies: half of them on each side.
        let unit = variance * time / std::f64::consts::PI;
        let along = unit / (1.0 + square);
        let across = 0.5 * unit * (1.0 + 3.0 * square) / (1.0 + square).powi(2);
        let relative = density(&first, frequency) / along;
        assert!((relative - 1.0).abs() < 0.15, "{frequency}: {relative}");
        let relative = density(&second, frequency) / across;
        assert!((relative - 1.0).abs() < 0.15, "{frequency}: {relative}");
    }
}

#[test]
fn a_step_in_two_halves_has_the_covariance_of_one() {
    // Keep and kick of 2 x follow from those of x if the discretisation is exact.
    let mut generator = generator(1, 0);
    let half = Second::new(SCALE, AIRSPEED, STEP, &mut generator);
    let whole = Second::new(SCALE, AIRSPEED, 2.0 * STEP, &mut generator);
    let [a, b, c] = half.kick;
    let noise = [[a * a, a * b], [a * b, b * b + c * c]];
    let (k, p) = (half.keep, half.pass);
    let carried = [
        k * k * noise[0][0],
        k * p * noise[0][0] + k * k * noise[0][1],
        p * p * noise[0][0] + 2.0 * p * k * noise[0][1] + k * k * noise[1][1],
    ];
    let [wa, wb, wc] = whole.kick;
    assert!((carried[0] + noise[0][0] - wa * wa).abs() < 1e-12);
    assert!((carried[1] + noise[0][1] - wa * wb).abs() < 1e-12);
    assert!((carried[2] + noise[1][1] - (wb * wb + wc * wc)).abs() < 1e-12);
    assert!((whole.pass - 2.0 * k * p).abs() < 1e-12);
}

//! Seeded sensor noise, one independent stream per sensor.
//!
//! Noise is drawn once per sample, present or not in the registers, so that it
//! belongs to the sample's index and not to the moment somebody looks.

use rand_distr::{Distribution, StandardNormal, Uniform};
use random_streams::{Generator, generator};

/// Which random stream of a seed is meant; no two purposes share one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Noise of the MPU6050's gyroscope.
    Mpu6050Gyro = 1,
    /// Noise of the MPU6050's accelerometer.
    Mpu6050Accelerometer,
    /// Error of the MPU6050's relaxation oscillator.
    Mpu6050RelaxationOscillator,
    /// Error of the MPU6050's gyroscope-locked clock.
    Mpu6050GyroClock,
    /// Noise of the LSM303AGR's accelerometer.
    Lsm303agrAccelerometer,
    /// Error of the LSM303AGR's accelerometer oscillator.
    Lsm303agrAccelerometerOscillator,
    /// Noise of the LSM303AGR's magnetometer.
    Lsm303agrMagnetometer,
    /// Error of the LSM303AGR's magnetometer oscillator.
    Lsm303agrMagnetometerOscillator,
    /// Zero-rate output of the MPU6050's gyroscope at turn-on.
    Mpu6050TurnOn,
    /// How it moves with the temperature.
    Mpu6050Temperature,
    /// Offset of the LSM303AGR's magnetometer.
    Lsm303agrMagnetometerOffset,
    /// How it moves with the temperature.
    Lsm303agrMagnetometerTemperature,
}

/// White Gaussian noise on three axes.
#[derive(Clone, Debug)]
pub struct Noise {
    generator: Option<Generator>,
}

impl Noise {
    /// Noise from one stream of a seed; `enabled: false` is silence.
    pub fn new(seed: u64, stream: Stream, enabled: bool) -> Self {
        Self {
            generator: enabled.then(|| generator(seed, stream as u64)),
        }
    }

    /// Adds the next sample of noise with standard deviation `sigma`.
    #[inline]
    pub fn add(&mut self, value: [f64; 3], sigma: f64) -> [f64; 3] {
        match &mut self.generator {
            None => value,
            Some(generator) => value.map(|axis| {
                let unit: f64 = StandardNormal.sample(generator);
                axis + sigma * unit
            }),
        }
    }
}

/// A number drawn evenly from -1 to 1 for one stream of a seed.
pub fn symmetric(seed: u64, stream: Stream) -> f64 {
    Uniform::new_inclusive(-1.0, 1.0)
        .expect("-1 to 1 is a valid range")
        .sample(&mut generator(seed, stream as u64))
}

/// Three of them, one for each axis.
pub fn symmetric_axes(seed: u64, stream: Stream) -> [f64; 3] {
    let even = Uniform::new_inclusive(-1.0, 1.0).expect("-1 to 1 is a valid range");
    let mut generator = generator(seed, stream as u64);
    [0; 3].map(|_| even.sample(&mut generator))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_asked_deviation_and_no_bias() {
        let mut noise = Noise::new(7, Stream::Mpu6050Gyro, true);
        let values: Vec<f64> = (0..20_000).flat_map(|_| noise.add([1.0; 3], 0.5)).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
        assert!((mean - 1.0).abs() < 0.01, "mean {mean}");
        assert!((variance.sqrt() - 0.5).abs() < 0.01, "variance {variance}");
    }

    #[test]
    fn the_same_seed_gives_the_same_noise_and_streams_differ() {
        let draw = |seed, stream| Noise::new(seed, stream, true).add([0.0; 3], 1.0);
        let gyro = draw(3, Stream::Mpu6050Gyro);
        assert_eq!(gyro, draw(3, Stream::Mpu6050Gyro));
        assert_ne!(gyro, draw(4, Stream::Mpu6050Gyro));
        assert_ne!(gyro, draw(3, Stream::Mpu6050Accelerometer));
    }

    #[test]
    fn silence_leaves_the_value_alone() {
        let mut noise = Noise::new(1, Stream::Mpu6050Gyro, false);
        assert_eq!(noise.add([1.0, 2.0, 3.0], 9.0), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn symmetric_draws_stay_within_one_and_use_both_signs() {
        let draws: Vec<f64> = (0..100)
            .map(|seed| symmetric(seed, Stream::Mpu6050GyroClock))
            .collect();
        assert!(draws.iter().all(|draw| draw.abs() <= 1.0));
        assert!(draws.iter().any(|draw| *draw > 0.5) && draws.iter().any(|draw| *draw < -0.5));
    }
}

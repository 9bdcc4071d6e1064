//! What a broken sensor makes of its readings.

use std::sync::{Mutex, PoisonError};

use chip_models::Sensor;
use rand_distr::{Distribution, Uniform};
use random_streams::{Generator, generator};

use super::distortion::{Distortion, Elements};
use super::kinds::Effect;
use super::script::{Fault, Script};

/// Keeps garbage apart from other chance of the same seed.
const STREAM: u64 = 0x4741_5242;
/// Beyond the range of every converter, which clips it.
const BEYOND: f64 = 1e6;

/// All broken sensors of a flight.
#[derive(Debug)]
pub struct BrokenSensors(Vec<Broken>);

#[derive(Debug)]
struct Broken {
    elements: Elements,
    how: Distortion,
    fault: Fault,
    memory: Mutex<Memory>,
}

/// What a fault remembers from one sample to the next.
#[derive(Debug)]
struct Memory {
    held: Option<[f64; 3]>,
    chance: Generator,
}

impl BrokenSensors {
    /// Those of a script.
    #[must_use]
    pub fn of(script: &Script) -> Self {
        let broken = script.iter().filter_map(|fault| match fault.effect {
            Effect::Signal(elements, how) => Some(Broken {
                elements,
                how,
                fault: *fault,
                memory: Mutex::new(Memory {
                    held: None,
                    chance: generator(fault.seed.into(), STREAM),
                }),
            }),
            _ => None,
        });
        Self(broken.collect())
    }

    /// What a sensor delivers instead of its reading.
    #[must_use]
    pub fn delivered(&self, of: Sensor, at_ns: u64, reading: [f64; 3]) -> [f64; 3] {
        let broken = self.0.iter().filter(|broken| broken.elements.of == of);
        broken
            .filter(|broken| broken.fault.holds(at_ns))
            .fold(reading, |reading, broken| broken.distorted(at_ns, reading))
    }
}

impl Broken {
    fn distorted(&self, at_ns: u64, reading: [f64; 3]) -> [f64; 3] {
        let mut memory = self.memory.lock().unwrap_or_else(PoisonError::into_inner);
        let held = *memory.held.get_or_insert(reading);
        let since_s = (at_ns - self.fault.from_ns) as f64 * 1e-9;
        let new = match self.how {
            Distortion::Stuck => held,
            Distortion::Zero => [0.0; 3],
            Distortion::Garbage => {
                let most = full_scale(self.elements.of);
                let even = Uniform::new_inclusive(-most, most).expect("a range around zero");
                reading.map(|_| even.sample(&mut memory.chance))
            }
            Distortion::Saturated => [BEYOND; 3],
            Distortion::Scaled(factor) => reading.map(|axis| axis * factor),
            Distortion::Bias(bias) => reading.map(|axis| axis + bias),
            Distortion::Drift(rate) => reading.map(|axis| axis + rate * since_s),
            Distortion::Turned(degrees) => {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                let [x, y, z] = reading;
                [cosine * x - sine * y, sine * x + cosine * y, z]
            }
        };
        let axes = self.elements.axes;
        std::array::from_fn(|axis| if axes[axis] { new[axis] } else { reading[axis] })
    }
}

/// About the range that the firmware sets, in deg/s, g or gauss.
fn full_scale(of: Sensor) -> f64 {
    match of {
        Sensor::Gyroscope => 2000.0,
        Sensor::ImuAccelerometer | Sensor::Accelerometer => 8.0,
        Sensor::Magnetometer => 49.0,
    }
}

//! What a broken sensor makes of its readings.

use std::sync::{Arc, Mutex, PoisonError};

use chip_models::{Sensor, Stimulus, StimulusSource};
use rand_distr::{Distribution, Uniform};
use random_streams::{Generator, generator};

use super::distortion::{Distortion, Elements};
use super::kinds::Effect;
use super::script::{Fault, Script};

/// Keeps garbage apart from other chance of the same seed.
const STREAM: u64 = 0x4741_5242;
/// Beyond the range of every converter, which clips it.
const BEYOND: f64 = 1e6;

/// What chips feel, and their converters deliver, under a script.
#[must_use]
pub fn broken(source: Arc<dyn StimulusSource>, script: &Script) -> Arc<dyn StimulusSource> {
    let broken: Vec<Broken> = script.iter().filter_map(Broken::of).collect();
    match broken.as_slice() {
        [] => source,
        _ => Arc::new(BrokenSensors { source, broken }),
    }
}

/// All broken sensors of a flight, which feel what sound ones do.
struct BrokenSensors {
    source: Arc<dyn StimulusSource>,
    broken: Vec<Broken>,
}

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

impl StimulusSource for BrokenSensors {
    fn at(&self, at_ns: u64) -> Stimulus {
        self.source.at(at_ns)
    }

    fn gyro(&self, at_ns: u64) -> [f64; 3] {
        self.source.gyro(at_ns)
    }

    fn specific_force(&self, at_ns: u64) -> [f64; 3] {
        self.source.specific_force(at_ns)
    }

    fn temperature_c(&self, at_ns: u64) -> f64 {
        self.source.temperature_c(at_ns)
    }

    fn delivered(&self, of: Sensor, at_ns: u64, reading: [f64; 3]) -> [f64; 3] {
        let reading = self.source.delivered(of, at_ns, reading);
        let broken = self.broken.iter().filter(|broken| broken.elements.of == of);
        broken
            .filter(|broken| broken.fault.holds(at_ns))
            .fold(reading, |reading, broken| broken.distorted(at_ns, reading))
    }
}

impl Broken {
    fn of(fault: &Fault) -> Option<Self> {
        let Effect::Signal(elements, how) = fault.effect else {
            return None;
        };
        Some(Self {
            elements,
            how,
            fault: *fault,
            memory: Mutex::new(Memory {
                held: None,
                chance: generator(fault.seed.into(), STREAM),
            }),
        })
    }

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

//! The true motion and field a chip is exposed to, as a function of time.

use std::sync::Arc;

use super::options::{AS_THE_BODY, Axes};

/// Standard gravity in m/s2: what the datasheets call 1 g.
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// What the sensors feel at one instant, in the chip's own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stimulus {
    /// Angular rate, rad/s.
    pub gyro: [f64; 3],
    /// Specific force (what an accelerometer feels: +1 g up at rest), m/s2.
    pub specific_force: [f64; 3],
    /// Magnetic field, gauss.
    pub magnetic_field: [f64; 3],
    /// Temperature of the die, degrees Celsius.
    pub temperature_c: f64,
}

/// A sensor element, with a converter of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// The MPU6050's gyroscope.
    Gyroscope,
    /// The MPU6050's accelerometer.
    ImuAccelerometer,
    /// The LSM303AGR's accelerometer.
    Accelerometer,
    /// The LSM303AGR's magnetometer.
    Magnetometer,
}

/// A signal over virtual time; must be a pure function of the instant.
pub trait StimulusSource: Send + Sync {
    /// The stimulus at `at_ns`.
    ///
    /// Chips ask about 9000 times per second and in nearly rising order (the
    /// filters' pure delays differ), so it should be cheap.
    fn at(&self, at_ns: u64) -> Stimulus;

    /// Angular rate alone, rad/s: of a chip's signals the one asked for most.
    fn gyro(&self, at_ns: u64) -> [f64; 3] {
        self.at(at_ns).gyro
    }

    /// Specific force alone, m/s2.
    fn specific_force(&self, at_ns: u64) -> [f64; 3] {
        self.at(at_ns).specific_force
    }

    /// What a sensor's converter delivers of its own reading, in deg/s, g or gauss: the reading, unless the
    /// sensor is broken.
    ///
    /// Asked once for each sample of a sensor, in order of time.
    fn delivered(&self, _of: Sensor, _at_ns: u64, reading: [f64; 3]) -> [f64; 3] {
        reading
    }

    /// Temperature alone, degrees Celsius.
    fn temperature_c(&self, at_ns: u64) -> f64 {
        self.at(at_ns).temperature_c
    }
}

impl<F: Fn(u64) -> Stimulus + Send + Sync> StimulusSource for F {
    fn at(&self, at_ns: u64) -> Stimulus {
        self(at_ns)
    }
}

/// What a chip feels that lies so in a body that feels a source.
pub(crate) fn mounted(source: Arc<dyn StimulusSource>, axes: Axes) -> Arc<dyn StimulusSource> {
    if axes == AS_THE_BODY {
        return source;
    }
    Arc::new(Mounted { source, axes })
}

struct Mounted {
    source: Arc<dyn StimulusSource>,
    axes: Axes,
}

impl Mounted {
    /// A vector along the chip's axes.
    fn felt(&self, body: [f64; 3]) -> [f64; 3] {
        (self.axes).map(|axis| {
            axis.into_iter()
                .zip(body)
                .map(|(share, part)| share * part)
                .sum()
        })
    }
}

impl StimulusSource for Mounted {
    fn at(&self, at_ns: u64) -> Stimulus {
        let body = self.source.at(at_ns);
        Stimulus {
            gyro: self.felt(body.gyro),
            specific_force: self.felt(body.specific_force),
            magnetic_field: self.felt(body.magnetic_field),
            ..body
        }
    }

    fn gyro(&self, at_ns: u64) -> [f64; 3] {
        self.felt(self.source.gyro(at_ns))
    }

    fn specific_force(&self, at_ns: u64) -> [f64; 3] {
        self.felt(self.source.specific_force(at_ns))
    }

    /// A converter's faults are along the chip's own axes.
    fn delivered(&self, of: Sensor, at_ns: u64, reading: [f64; 3]) -> [f64; 3] {
        self.source.delivered(of, at_ns, reading)
    }

    fn temperature_c(&self, at_ns: u64) -> f64 {
        self.source.temperature_c(at_ns)
    }
}

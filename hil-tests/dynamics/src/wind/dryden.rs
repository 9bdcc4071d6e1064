//! Dryden turbulence, low-altitude form of MIL-F-8785C.
//!
//! Along the mean wind the spectrum is that of `s sqrt(2 T / pi) / (1 + T p)`, across and
//! vertically that of `s sqrt(T / pi) (1 + sqrt(3) T p) / (1 + T p)^2`, with the intensity `s`
//! and `T` = length over airspeed. Both are driven by white noise and discretised exactly: the
//! values at the instants asked for have the covariance of the continuous process.

use nalgebra::Vector3;
use rand_distr::{Distribution, StandardNormal};
use random_streams::Generator;

use crate::environment::WindClimate;

const FEET_PER_METER: f64 = 1.0 / 0.3048;

/// Intensity, m/s, and length, m, of one component.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    intensity: f64,
    length: f64,
}

/// Scales along the ground, longitudinal and lateral alike, and vertically.
fn scales(climate: &WindClimate) -> (Scale, Scale) {
    let feet = climate.nominal_altitude * FEET_PER_METER;
    let growth = 0.177 + 0.000823 * feet;
    let vertical = Scale {
        intensity: 0.1 * climate.speed_at_20_ft,
        length: climate.nominal_altitude,
    };
    let horizontal = Scale {
        intensity: vertical.intensity / growth.powf(0.4),
        length: feet / growth.powf(1.2) / FEET_PER_METER,
    };
    (horizontal, vertical)
}

fn draw(generator: &mut Generator) -> f64 {
    StandardNormal.sample(generator)
}

/// The longitudinal form: first order.
#[derive(Clone, Debug)]
struct First {
    keep: f64,
    kick: f64,
    value: f64,
}

impl First {
    fn new(scale: Scale, airspeed: f64, dt: f64, generator: &mut Generator) -> Self {
        let keep = (-dt * airspeed / scale.length).exp();
        Self {
            keep,
            kick: scale.intensity * (1.0 - keep * keep).sqrt(),
            value: scale.intensity * draw(generator),
        }
    }

    fn next(&mut self, generator: &mut Generator) -> f64 {
        self.value = self.keep * self.value + self.kick * draw(generator);
        self.value
    }
}

/// The lateral and vertical form: second order.
///
/// Its state is a chain of two lags, `x1' = -x1 / T + w` and `x2' = (x1 - x2) / T` with white
/// noise `w` of density `1 / T`; the output is `s (sqrt(3) x1 + (1 - sqrt(3)) x2)`.
#[derive(Clone, Debug)]
struct Second {
    intensity: f64,
    keep: f64,
    pass: f64,
    /// Lower triangle of the root of the noise's covariance.
    kick: [f64; 3],
    lags: [f64; 2],
}

/// Lower triangle of the root of a covariance.
fn root([first, both, second]: [f64; 3]) -> [f64; 3] {
    let a = first.sqrt();
    let b = both / a;
    [a, b, (second - b * b).max(0.0).sqrt()]
}

impl Second {
    fn new(scale: Scale, airspeed: f64, dt: f64, generator: &mut Generator) -> Self {
        let x = dt * airspeed / scale.length;
        let decay = (-2.0 * x).exp();
        // Integrals of exp(-2 y), y exp(-2 y) and y^2 exp(-2 y) from 0 to x.
        let noise = [
            0.5 * (1.0 - decay),
            0.25 * (1.0 - (1.0 + 2.0 * x) * decay),
            0.25 * (1.0 - (1.0 + 2.0 * x + 2.0 * x * x) * decay),
        ];
        let [a, b, c] = root([0.5, 0.25, 0.25]);
        let (one, two) = (draw(generator), draw(generator));
        Self {
            intensity: scale.intensity,
            keep: (-x).exp(),
            pass: x * (-x).exp(),
            kick: root(noise),
            lags: [a * one, b * one + c * two],
        }
    }

    fn next(&mut self, generator: &mut Generator) -> f64 {
        let (one, two) = (draw(generator), draw(generator));
        let [a, b, c] = self.kick;
        let [first, second] = self.lags;
        self.lags = [
            self.keep * first + a * one,
            self.keep * second + self.pass * first + b * one + c * two,
        ];
        let root = 3.0_f64.sqrt();
        self.intensity * (root * self.lags[0] + (1.0 - root) * self.lags[1])
    }
}

/// Turbulence of a place, in steps of a fixed time.
#[derive(Clone, Debug)]
pub struct Turbulence {
    generator: Generator,
    along: First,
    across: Second,
    down: Second,
    /// Direction of the mean wind.
    heading: Vector3<f64>,
}

impl Turbulence {
    /// Turbulence in steps of `dt` seconds, in its steady state from the start.
    pub fn new(climate: &WindClimate, dt: f64, mut generator: Generator) -> Self {
        let (horizontal, vertical) = scales(climate);
        let speed = climate.nominal_airspeed;
        let level = Vector3::new(climate.mean.x, climate.mean.y, 0.0);
        Self {
            along: First::new(horizontal, speed, dt, &mut generator),
            across: Second::new(horizontal, speed, dt, &mut generator),
            down: Second::new(vertical, speed, dt, &mut generator),
            heading: level.try_normalize(1e-9).unwrap_or(Vector3::x()),
            generator,
        }
    }

    /// The next velocity, m/s, north east down.
    pub fn next(&mut self) -> Vector3<f64> {
        let along = self.along.next(&mut self.generator);
        let across = self.across.next(&mut self.generator);
        let down = self.down.next(&mut self.generator);
        let right = Vector3::z().cross(&self.heading);
        self.heading * along + right * across + Vector3::z() * down
    }
}

#[cfg(test)]
mod tests;

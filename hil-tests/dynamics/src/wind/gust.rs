//! Discrete gusts: one after another, each of its own horizontal direction.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use rand_distr::{Distribution, Exp1, StandardUniform};
use random_streams::Generator;

use crate::environment::Gusts;

/// Gusts of the shape `A / 2 (1 - cos(pi x / d))`, `x` from 0 to `2 d`.
#[derive(Clone, Debug)]
pub struct GustTrain {
    of: Gusts,
    airspeed: f64,
    generator: Generator,
    heading: Vector3<f64>,
    /// Time since the gust began, s; negative before.
    since: f64,
}

impl GustTrain {
    /// Gusts carried past at `airspeed` m/s; the first comes after its own interval.
    pub fn new(of: Gusts, airspeed: f64, generator: Generator) -> Self {
        let mut train = Self {
            of,
            airspeed,
            generator,
            heading: Vector3::zeros(),
            since: 0.0,
        };
        train.wait(0.0);
        train
    }

    fn wait(&mut self, over: f64) {
        let unit: f64 = Exp1.sample(&mut self.generator);
        let turn: f64 = StandardUniform.sample(&mut self.generator);
        let (sine, cosine) = (turn * TAU).sin_cos();
        self.heading = Vector3::new(cosine, sine, 0.0);
        self.since = over - unit * self.of.mean_interval;
    }

    /// The gust's velocity `dt` seconds later, m/s, north east down.
    pub fn next(&mut self, dt: f64) -> Vector3<f64> {
        self.since += dt;
        let lasts = 2.0 * self.of.length / self.airspeed;
        if self.since >= lasts {
            self.wait(self.since - lasts);
        }
        // After a short wait a gust may begin within the step, but none is over in it: a gust
        // lasts at least 2 * 0.5 m / 100 m/s.
        if self.since <= 0.0 {
            return Vector3::zeros();
        }
        let share = 0.5 - 0.5 * (PI * self.since * self.airspeed / self.of.length).cos();
        self.heading * (self.of.amplitude * share)
    }
}

//! Wind: mean, turbulence, gusts and shelter, the same for every drone in it.
//!
//! It is worked out every 10 ms of its own time from the seed and the place's nominal altitude
//! and airspeed alone, never from the drone's motion, and goes in straight lines between. So
//! two flights of one seed meet the same wind, however they differ.

mod dryden;
mod gust;

use std::f64::consts::PI;

use nalgebra::Vector3;
use random_streams::generator;

use crate::environment::{Environment, Shelter, WindClimate};
use crate::range::Unfit;
use dryden::Turbulence;
use gust::GustTrain;

/// Time between two winds that are worked out, s.
const INTERVAL: f64 = 0.01;
/// Width over which a shelter fades out, rad.
const FADING: f64 = PI / 12.0;

/// Which random stream of a seed is meant; the two do not disturb each other.
#[derive(Clone, Copy)]
enum Stream {
    Turbulence = 1,
    Gusts,
}

/// The wind of one place and seed.
#[derive(Clone, Debug)]
pub struct Wind {
    climate: WindClimate,
    turbulence: Turbulence,
    gusts: Option<GustTrain>,
    before: Vector3<f64>,
    after: Vector3<f64>,
    /// Time since `before`, s.
    since: f64,
}

impl Wind {
    /// The wind of a seed, at time zero.
    pub fn new(environment: &Environment, seed: u64) -> Result<Self, Unfit> {
        environment.check()?;
        let climate = &environment.wind;
        let gusts = generator(seed, Stream::Gusts as u64);
        let mut wind = Self {
            turbulence: Turbulence::new(
                climate,
                INTERVAL,
                generator(seed, Stream::Turbulence as u64),
            ),
            gusts: climate
                .gusts
                .map(|of| GustTrain::new(of, climate.nominal_airspeed, gusts)),
            climate: climate.clone(),
            before: Vector3::zeros(),
            after: Vector3::zeros(),
            since: 0.0,
        };
        wind.before = wind.next();
        wind.after = wind.next();
        Ok(wind)
    }

    /// Lets `dt` seconds pass and returns the air's velocity, m/s, north east down.
    ///
    /// A `dt` that is negative or not a number passes no time.
    pub fn advance(&mut self, dt: f64) -> Vector3<f64> {
        self.since += dt.max(0.0);
        while self.since >= INTERVAL {
            self.since -= INTERVAL;
            self.before = self.after;
            self.after = self.next();
        }
        self.now()
    }

    /// The air's velocity now, m/s, north east down.
    pub fn now(&self) -> Vector3<f64> {
        self.before + (self.after - self.before) * (self.since / INTERVAL)
    }

    fn next(&mut self) -> Vector3<f64> {
        let gust = match &mut self.gusts {
            Some(gusts) => gusts.next(INTERVAL),
            None => Vector3::zeros(),
        };
        let open = self.climate.mean + self.turbulence.next() + gust;
        open * left_by(&self.climate.sheltered, &open)
    }
}

/// Share of a wind that shelters leave, from the direction that it comes from.
fn left_by(shelters: &[Shelter], wind: &Vector3<f64>) -> f64 {
    let from = (-wind.y).atan2(-wind.x);
    shelters.iter().fold(1.0, |left, shelter| {
        let off = (from - shelter.from + PI).rem_euclid(2.0 * PI) - PI;
        let beyond = ((off.abs() - shelter.half_width) / FADING).clamp(0.0, 1.0);
        let sheltered = 0.5 + 0.5 * (PI * beyond).cos();
        left * (1.0 - sheltered * (1.0 - shelter.factor))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wind_from_a_sheltered_direction_is_attenuated_and_others_are_not() {
        let west = Shelter {
            from: -PI / 2.0,
            half_width: PI / 4.0,
            factor: 0.3,
        };
        let from_west = Vector3::new(0.0, 4.0, 0.0);
        let from_east = -from_west;
        let from_south = Vector3::new(4.0, 0.0, 0.0);
        assert!((left_by(&[west], &from_west) - 0.3).abs() < 1e-12);
        assert!((left_by(&[west], &from_east) - 1.0).abs() < 1e-12);
        assert!((left_by(&[west], &from_south) - 1.0).abs() < 1e-12);
        // Half way through the fading, half of the attenuation is left.
        let edge = -PI / 4.0 + FADING / 2.0;
        let from_edge = -Vector3::new(edge.cos(), edge.sin(), 0.0);
        assert!((left_by(&[west], &from_edge) - 0.65).abs() < 1e-9);
    }
}

//! Where a flight takes place: air, magnetic field and weather.

use nalgebra::Vector3;

use crate::range::{Unfit, all_within, within};

/// Air, field and weather of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Density of the air, kg/m3, 0.3 to 2; 1.225 at sea level.
    ///
    /// It enters the power of the rotors alone: thrust and drag coefficients are those of this air.
    pub air_density: f64,
    /// Earth's magnetic field, gauss, north east down, each -10 to 10.
    ///
    /// About 0.2, 0, 0.4 in central Europe.
    pub magnetic_field: Vector3<f64>,
    /// The weather.
    pub wind: WindClimate,
}

/// Mean wind, turbulence, gusts and shelter of a place.
#[derive(Clone, Debug, PartialEq)]
pub struct WindClimate {
    /// Mean velocity of the air over the earth, m/s, north east down, up to 50.
    pub mean: Vector3<f64>,
    /// Mean wind speed at 20 ft (6.1 m), m/s, 0 to 50: sets the turbulence; 0 is none.
    /// MIL-F-8785C: light 7.7, moderate 15.4, severe 23.2 m/s.
    pub speed_at_20_ft: f64,
    /// Altitude for which turbulence is worked out, m, 3.048 to 304.8 (10 to 1000 ft).
    pub nominal_altitude: f64,
    /// Speed against the air for which turbulence is worked out, m/s, 0.5 to 100.
    ///
    /// Hovering, it is the mean wind's speed: gusts are carried past the drone.
    pub nominal_airspeed: f64,
    /// Discrete gusts, if any.
    pub gusts: Option<Gusts>,
    /// Directions from which the place is sheltered.
    pub sheltered: Vec<Shelter>,
}

/// Discrete gusts of the shape 1 - cosine (MIL-F-8785C) at random instants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gusts {
    /// Mean time from the end of one gust to the start of the next, s, from 0.1.
    pub mean_interval: f64,
    /// Largest speed of a gust, m/s, 0 to 50; each has its own horizontal direction.
    pub amplitude: f64,
    /// Distance over which a gust rises, and falls again, m, 0.5 to 1000.
    pub length: f64,
}

/// A range of directions from which wind arrives attenuated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shelter {
    /// Middle of the range, rad clockwise from north, where the wind comes **from**.
    pub from: f64,
    /// Half the width of the range, rad, 0 to pi; beyond, 15 degrees of fading.
    pub half_width: f64,
    /// What is left of the wind, 0 to 1.
    pub factor: f64,
}

impl Environment {
    /// Sea level, no wind, a field of 0.2 and 0.4 gauss to the north and down.
    pub fn calm() -> Self {
        Self {
            air_density: 1.225,
            magnetic_field: Vector3::new(0.2, 0.0, 0.4),
            wind: WindClimate {
                mean: Vector3::zeros(),
                speed_at_20_ft: 0.0,
                nominal_altitude: 10.0,
                nominal_airspeed: 5.0,
                gusts: None,
                sheltered: Vec::new(),
            },
        }
    }

    /// Refuses values outside the ranges that the fields state.
    pub fn check(&self) -> Result<(), Unfit> {
        within("air_density", self.air_density, 0.3, 2.0)?;
        let field = self.magnetic_field.as_slice();
        all_within("magnetic_field", field, -10.0, 10.0)?;
        self.wind.check()
    }
}

impl WindClimate {
    fn check(&self) -> Result<(), Unfit> {
        all_within("wind mean", self.mean.as_slice(), -50.0, 50.0)?;
        within("wind speed_at_20_ft", self.speed_at_20_ft, 0.0, 50.0)?;
        let altitude = self.nominal_altitude;
        within("wind nominal_altitude", altitude, 3.048, 304.8)?;
        let airspeed = self.nominal_airspeed;
        within("wind nominal_airspeed", airspeed, 0.5, 100.0)?;
        if let Some(gusts) = &self.gusts {
            within("gusts mean_interval", gusts.mean_interval, 0.1, 1e6)?;
            within("gusts amplitude", gusts.amplitude, 0.0, 50.0)?;
            within("gusts length", gusts.length, 0.5, 1000.0)?;
        }
        self.sheltered.iter().try_for_each(|shelter| {
            let turn = std::f64::consts::TAU;
            within("sheltered from", shelter.from, -turn, turn)?;
            let widest = std::f64::consts::PI;
            within("sheltered half_width", shelter.half_width, 0.0, widest)?;
            within("sheltered factor", shelter.factor, 0.0, 1.0)
        })
    }
}

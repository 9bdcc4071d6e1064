//! `environments/*.toml`: where drones are flown in simulation.
//!
//! Not part of what the firmware is built from: `cargo hil fly` and `cargo hil campaign` read it.

use std::path::Path;

use serde::Deserialize;

use crate::document::Document;
use crate::{ConfigError, names_in, range, selected_file};

/// The content of a file of `environments/`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Environment {
    /// Side of the square in which waypoints lie, in m.
    #[serde(deserialize_with = "range::area")]
    pub area_m: f64,
    /// Magnetic field in gauss: to the north, and down.
    #[serde(deserialize_with = "range::field")]
    pub field_gauss: [f64; 2],
    /// Mean wind and turbulence.
    pub wind: Wind,
    /// Single gusts.
    pub gusts: Gusts,
    /// Directions from which the wind is weaker.
    #[serde(default)]
    pub shelters: Vec<Shelter>,
    /// How the drone's place is known, unless it is said otherwise: a file of `positions/`.
    pub position: String,
}

/// Mean wind, and the turbulence that comes with it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Mean speed at flying height in m/s, before any shelter.
    #[serde(deserialize_with = "range::wind")]
    pub mean_m_s: f64,
    /// Where it comes from, in degrees from north, clockwise.
    #[serde(deserialize_with = "range::direction")]
    pub from_deg: f64,
    /// How far that differs from flight to flight to either side, in degrees.
    #[serde(deserialize_with = "range::spread")]
    pub spread_deg: f64,
    /// Speed at 20 ft in m/s that Dryden's intensities are taken from.
    #[serde(deserialize_with = "range::wind")]
    pub turbulence_m_s: f64,
    /// Height in m that Dryden's lengths are taken from.
    #[serde(deserialize_with = "range::height")]
    pub height_m: f64,
}

/// Gusts of the shape 1 - cosine, at random instants.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gusts {
    /// Mean time between two in s.
    #[serde(deserialize_with = "range::gust_interval")]
    pub interval_s: f64,
    /// Largest speed in m/s; each reaches half of it to all of it.
    #[serde(deserialize_with = "range::wind")]
    pub speed_m_s: f64,
    /// How long one lasts in s.
    #[serde(deserialize_with = "range::short_time")]
    pub length_s: f64,
}

/// A side from which the wind is weaker.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shelter {
    /// Its middle, in degrees from north, clockwise.
    #[serde(deserialize_with = "range::direction")]
    pub from_deg: f64,
    /// How wide it is, in degrees.
    #[serde(deserialize_with = "range::spread")]
    pub width_deg: f64,
    /// Share of the wind that it lets through.
    #[serde(deserialize_with = "range::share")]
    pub passes: f64,
}

/// The content of a file of `positions/`: reports of the drone's place.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tracking {
    /// Reports per second.
    #[serde(deserialize_with = "range::tracking_rate")]
    pub rate_hz: f64,
    /// How old a report is in s.
    #[serde(deserialize_with = "range::tracking_delay")]
    pub delay_s: f64,
    /// Standard deviation of each coordinate in m.
    #[serde(deserialize_with = "range::tracking_noise")]
    pub noise_m: f64,
    /// Standard deviation of each velocity in m/s.
    #[serde(deserialize_with = "range::tracking_noise")]
    pub noise_m_s: f64,
    /// Standard deviation of an error that changes slowly, of each coordinate in m.
    #[serde(deserialize_with = "range::drift")]
    pub drift_m: f64,
    /// How long that error is remembered in s.
    #[serde(deserialize_with = "range::drift_time")]
    pub drift_s: f64,
}

impl Tracking {
    /// Reads what is known of a place by its name, from the folder of the configuration.
    ///
    /// # Errors
    /// An unknown name, with those that are known; a key or value that is wrong.
    pub fn load(dir: &Path, name: &str) -> Result<Self, ConfigError> {
        let file = selected_file(dir, "positions", name)
            .map_err(|message| ConfigError::of_file(Path::new(name), message))?;
        Document::open(&file)?.parse()
    }
}

impl Environment {
    /// Reads an environment by its name, from the folder of the configuration.
    ///
    /// # Errors
    /// An unknown name, with those that are known; a key or value that is wrong.
    pub fn load(dir: &Path, name: &str) -> Result<Self, ConfigError> {
        let file = selected_file(dir, "environments", name)
            .map_err(|message| ConfigError::of_file(Path::new(name), message))?;
        Document::open(&file)?.parse()
    }

    /// The names that [`Self::load`] knows, in order.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn names(dir: &Path) -> Result<Vec<String>, ConfigError> {
        names_in(dir, "environments").map_err(|message| ConfigError::of_file(dir, message))
    }
}

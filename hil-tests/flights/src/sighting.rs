//! Where the drone was, as somebody beside it would have seen it.

use nalgebra::Vector3;

use super::flight::Flight;
use super::quaternion::{about_down, continuous, from_array, to_array};
use super::setpoint::Setpoints;
use super::track::{Cursor, Track};

/// A position older than this is not reported again, ns.
const STALE_NS: i64 = 250_000_000;

/// One report of where a drone is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sighting {
    /// m forward, right and down; forward is the heading at the start.
    pub position: [f64; 3],
    /// m/s, along the same axes.
    pub velocity: [f64; 3],
    /// Against the same axes (w, x, y, z), where it is known.
    pub attitude: Option<[f64; 4]>,
    /// Body rates, rad/s.
    pub rates: [f64; 3],
}

/// All that could be seen of a recorded flight.
#[derive(Debug)]
pub struct Sightings<'a> {
    position: &'a Track<6>,
    attitude: Option<Track<4>>,
    gyro: &'a Track<3>,
    cursor: Cursor,
    heading_at_start: f64,
}

impl<'a> Sightings<'a> {
    /// Of a flight, against the axes of its setpoints; none where the log has no position.
    #[must_use]
    pub fn of(flight: &'a Flight, setpoints: &Setpoints) -> Option<Self> {
        Some(Self {
            position: flight.recorded.position.as_ref()?,
            attitude: flight.recorded.attitude.as_ref().map(continuous),
            gyro: &flight.gyro,
            cursor: Cursor::default(),
            heading_at_start: setpoints.heading_at_start(),
        })
    }

    /// The report at a log time, ns; none while the log's position is invalid.
    #[must_use]
    pub fn at(&self, time_ns: i64) -> Option<Sighting> {
        let (measured, [x, y, z, vx, vy, vz]) = self.position.latest(time_ns)?;
        if time_ns - measured > STALE_NS {
            return None;
        }
        let turn = about_down(-self.heading_at_start);
        let attitude = self.attitude.as_ref().and_then(|track| track.at(time_ns));
        Some(Sighting {
            position: (turn * Vector3::new(x, y, z)).into(),
            velocity: (turn * Vector3::new(vx, vy, vz)).into(),
            attitude: attitude.map(|q| to_array(turn * from_array(q))),
            rates: self
                .gyro
                .at_cursor(time_ns, &self.cursor)
                .unwrap_or_default(),
        })
    }
}

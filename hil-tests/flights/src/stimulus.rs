//! What the emulated sensors feel: a standstill, then the flight.
//!
//! Virtual time is the standstill plus log time. Before the flight the drone rests, in
//! the attitude in which the flight starts, so that the firmware can boot,
//! calibrate its gyroscope and be armed. The last 50 ms of that lead
//! linearly to the first samples of the flight: flights that start in the air
//! then begin with a brisk move instead of an impossible step. After the last
//! sample everything is held.

use super::flight::Flight;
use super::track::{Cursor, Track};
use chip_models::stimulus::{Stimulus, StimulusSource};

/// The time at rest before the flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standstill {
    length_ns: u64,
}

/// Span of the standstill that leads to the flight, ns.
const LEAD_IN_NS: i64 = 50_000_000;
/// The field where the log has no magnetometer, gauss: northward and down.
const NO_FIELD: [f64; 3] = [0.2, 0.0, 0.4];
/// No log's temperature is used: the chips' own errors do not depend on it.
const TEMPERATURE_C: f64 = 25.0;

impl Standstill {
    /// The least that leaves the firmware time to boot and calibrate, ns.
    pub const SHORTEST_NS: u64 = 500_000_000;

    /// A time at rest; shorter ones than [`Standstill::SHORTEST_NS`] are lengthened.
    #[must_use]
    pub fn new(length_ns: u64) -> Self {
        Self {
            length_ns: length_ns.max(Self::SHORTEST_NS),
        }
    }

    /// Its length, ns: the virtual time at which the flight starts.
    #[must_use]
    pub fn length_ns(self) -> u64 {
        self.length_ns
    }

    /// The log time (ns) of a virtual time; negative before the flight.
    #[must_use]
    pub fn log_time_ns(self, virtual_ns: u64) -> i64 {
        let difference = i128::from(virtual_ns) - i128::from(self.length_ns);
        i64::try_from(difference).unwrap_or(i64::MAX)
    }
}

impl Default for Standstill {
    /// One and a half seconds.
    fn default() -> Self {
        Self::new(1_500_000_000)
    }
}

/// A flight as the sensors sense it, in the body frame.
#[derive(Debug)]
pub struct FlightStimulus {
    standstill: Standstill,
    gyro: Signal,
    accel: Signal,
    mag: Signal,
}

impl FlightStimulus {
    /// The stimulus of a flight after a standstill.
    #[must_use]
    pub fn new(flight: &Flight, standstill: Standstill) -> Self {
        let mag = flight.mag.as_ref();
        let field = mag.map_or_else(|| Track::constant(NO_FIELD), Track::clone);
        let at_start = field.at(0).unwrap_or(NO_FIELD);
        Self {
            standstill,
            gyro: Signal::new(&flight.gyro, [0.0; 3]),
            accel: Signal::new(&flight.accel, flight.specific_force_at_rest()),
            mag: Signal::new(&field, at_start),
        }
    }
}

impl StimulusSource for FlightStimulus {
    fn at(&self, at_ns: u64) -> Stimulus {
        let time = self.standstill.log_time_ns(at_ns);
        Stimulus {
            gyro: self.gyro.at(time),
            specific_force: self.accel.at(time),
            magnetic_field: self.mag.at(time),
            temperature_c: TEMPERATURE_C,
        }
    }

    fn gyro(&self, at_ns: u64) -> [f64; 3] {
        self.gyro.at(self.standstill.log_time_ns(at_ns))
    }

    fn specific_force(&self, at_ns: u64) -> [f64; 3] {
        self.accel.at(self.standstill.log_time_ns(at_ns))
    }

    fn temperature_c(&self, _: u64) -> f64 {
        TEMPERATURE_C
    }
}

/// One sensor's signal and where it was read last.
#[derive(Debug)]
struct Signal {
    track: Track<3>,
    cursor: Cursor,
}

impl Signal {
    /// A signal that rests before the flight.
    fn new(flight: &Track<3>, at_rest: [f64; 3]) -> Self {
        let mut track = Track::new();
        track.push(-LEAD_IN_NS, at_rest);
        track.push(0, flight.at(0).unwrap_or(at_rest));
        for (time, value) in flight.iter() {
            track.push(time, value);
        }
        Self {
            track,
            cursor: Cursor::default(),
        }
    }

    fn at(&self, time_ns: i64) -> [f64; 3] {
        self.track
            .at_cursor(time_ns, &self.cursor)
            .unwrap_or_default()
    }
}

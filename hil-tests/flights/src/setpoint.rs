//! What the drone was asked to do: attitude, body rates and thrust over time.
//!
//! Recorded setpoints are used where the log has them and they were flown:
//! where the recorded thrust never leaves zero, the drone stood on the ground,
//! and its recorded setpoints are what nothing followed. Without recorded ones
//! the flight's own attitude and rates serve, low-passed at 1 Hz without delay,
//! and the mean motor command, filtered likewise, is the thrust.
//!
//! Headings are relative to the drone's heading at the start of the flight,
//! which is where the firmware's own heading starts.

use super::attitude::estimate;
use super::flight::Flight;
use super::lowpass::zero_phase;
use super::quaternion::{about_down, continuous, from_array, heading, renormalised, to_array};
use super::recording::Motors;
use super::track::{Cursor, Track};

/// Corner of the filter that makes setpoints of a flight's own motion, Hz.
const CUTOFF_HZ: f64 = 1.0;
/// Thrust below which a drone stands on the ground.
const IDLE_THRUST: f64 = 0.05;
/// Thrust where the log says nothing.
const UNKNOWN_THRUST: f64 = 0.5;

/// Where a part of the setpoint comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SetpointSource {
    /// The log's own setpoint.
    Recorded,
    /// The log's attitude, gyroscope or motors, low-passed.
    Motion,
    /// The attitude computed from gyroscope and accelerometer, low-passed.
    Computed,
    /// Nothing in the log: a constant.
    Constant,
}

/// Where each part of the setpoint comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct SetpointSources {
    /// Of the attitude: recorded, motion or computed.
    pub attitude: SetpointSource,
    /// Of the body rates: recorded or motion.
    pub rates: SetpointSource,
    /// Of the thrust: recorded, motion or constant.
    pub thrust: SetpointSource,
}

/// One setpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// Attitude w, x, y, z: forward-right-down in a level frame whose x axis is
    /// the heading at the start.
    pub attitude: [f64; 4],
    /// Body rates, rad/s.
    pub rates: [f64; 3],
    /// Collective thrust, 0..1.
    pub thrust: f64,
}

/// The setpoints of a flight.
#[derive(Debug)]
pub struct Setpoints {
    /// Where they come from.
    pub sources: SetpointSources,
    attitude: Track<4>,
    rates: Track<3>,
    thrust: Track<1>,
    /// The flight's heading at its start, rad in the log's frame.
    heading_at_start: f64,
    cursors: [Cursor; 3],
}

impl Setpoints {
    /// The setpoints of a flight.
    #[must_use]
    pub fn of(flight: &Flight) -> Self {
        let recorded = &flight.recorded;
        let was_flown = recorded.thrust_setpoint.as_ref().is_none_or(leaves_idle);
        let (attitude, attitude_source) = match &recorded.attitude_setpoint {
            Some(track) if was_flown => (track.clone(), SetpointSource::Recorded),
            _ => own_attitude(flight),
        };
        let (rates, rates_source) = match &recorded.rates_setpoint {
            Some(track) if was_flown => (track.clone(), SetpointSource::Recorded),
            _ => (zero_phase(&flight.gyro, CUTOFF_HZ), SetpointSource::Motion),
        };
        let (thrust, thrust_source) = match &recorded.thrust_setpoint {
            Some(track) if was_flown => (track.clone(), SetpointSource::Recorded),
            _ => own_thrust(flight),
        };
        let heading_at_start = match attitude_source {
            // An attitude that is computed starts at heading 0.
            SetpointSource::Computed => 0.0,
            _ => heading_at_start(flight, &attitude),
        };
        let to_start = about_down(-heading_at_start);
        Self {
            sources: SetpointSources {
                attitude: attitude_source,
                rates: rates_source,
                thrust: thrust_source,
            },
            attitude: continuous(&attitude.map(|q| to_array(to_start * from_array(q)))),
            rates,
            thrust,
            heading_at_start,
            cursors: Default::default(),
        }
    }

    /// The setpoint at a log time (ns), linear between its samples; before the
    /// flight its first attitude and thrust, without rates.
    #[must_use]
    pub fn at(&self, time_ns: i64) -> Setpoint {
        let [attitude, rates, thrust] = &self.cursors;
        let time_in_flight = time_ns.max(0);
        let q = self.attitude.at_cursor(time_in_flight, attitude);
        let asked_rates = self.rates.at_cursor(time_in_flight, rates);
        let asked_thrust = self.thrust.at_cursor(time_in_flight, thrust);
        Setpoint {
            attitude: q.map_or([1.0, 0.0, 0.0, 0.0], |q| to_array(from_array(q))),
            rates: match asked_rates {
                Some(rates) if time_ns >= 0 => rates,
                _ => [0.0; 3],
            },
            thrust: asked_thrust.map_or(UNKNOWN_THRUST, |[thrust]| thrust),
        }
    }

    /// The heading (rad, in the log's level frame) that setpoints count from.
    #[must_use]
    pub fn heading_at_start(&self) -> f64 {
        self.heading_at_start
    }
}

/// True where a thrust shows that the drone was flown.
fn leaves_idle(thrust: &Track<1>) -> bool {
    thrust.values().iter().any(|&[share]| share > IDLE_THRUST)
}

/// The flight's own attitude, low-passed.
fn own_attitude(flight: &Flight) -> (Track<4>, SetpointSource) {
    let (attitude, source) = match &flight.recorded.attitude {
        Some(track) => (track.clone(), SetpointSource::Motion),
        None => (estimate(flight), SetpointSource::Computed),
    };
    let smooth = zero_phase(&continuous(&attitude), CUTOFF_HZ);
    (renormalised(&smooth), source)
}

/// The mean motor command, low-passed.
fn own_thrust(flight: &Flight) -> (Track<1>, SetpointSource) {
    let mean = flight.motors.as_ref().map(Motors::mean);
    match mean.filter(leaves_idle) {
        Some(mean) => (zero_phase(&mean, CUTOFF_HZ), SetpointSource::Motion),
        None => (Track::constant([UNKNOWN_THRUST]), SetpointSource::Constant),
    }
}

/// The flight's heading at time 0 by its attitude, else by its setpoint.
fn heading_at_start(flight: &Flight, setpoint: &Track<4>) -> f64 {
    let attitude = flight.recorded.attitude.as_ref().map(continuous);
    let at_start = attitude.as_ref().unwrap_or(setpoint).at(0);
    at_start.map_or(0.0, |q| heading(from_array(q)))
}

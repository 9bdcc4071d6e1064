//! What a log holds, and what a replay would take of it.

use std::path::Path;

use super::error::FlightError;
use super::flight::{Flight, Reading, RotationReason, read_bytes, recording};
use super::gaps::{self, Gap};
use super::parts::{Flown, Taken, spans};
use super::recording::{Dropouts, Recording, Sensor, Vehicle};
use super::skipped::{Skip, Skipped};
use super::track::{Span, Track, seconds};

/// One signal of a log.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Signal {
    /// What it is.
    pub name: String,
    /// How many samples it has.
    pub samples: usize,
    /// Samples per second, by the median period.
    pub rate_hz: f64,
}

impl Signal {
    fn of<const N: usize>(name: impl Into<String>, track: &Track<N>) -> Self {
        Self {
            name: name.into(),
            samples: track.len(),
            rate_hz: track.rate_hz(),
        }
    }
}

/// What a replay would use.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Replayed {
    /// The part of the log.
    #[serde(flatten)]
    pub part: Taken,
    /// How its axes are turned.
    pub rotation: String,
    /// Why so.
    pub rotation_reason: String,
}

impl Replayed {
    fn of(flight: &Flight) -> Self {
        let reason: RotationReason = flight.rotation_reason;
        Self {
            part: flight.part,
            rotation: flight.rotation.to_string(),
            rotation_reason: reason.to_string(),
        }
    }
}

/// What a log holds.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Contents {
    /// The file.
    pub log: String,
    /// Its format, or whose columns it has.
    pub format: String,
    /// Who flew.
    pub vehicle: Vehicle,
    /// From the first to the last gyroscope sample, s.
    pub length_s: f64,
    /// Sensors and motors.
    pub sensors: Vec<Signal>,
    /// What else a replay can follow or compare with.
    pub recorded: Vec<Signal>,
    /// When motors were armed; null where the log does not tell.
    pub armed: Option<Vec<Span>>,
    /// When it flew.
    pub flown: Flown,
    /// What the autopilot lost.
    pub dropouts: Dropouts,
    /// Spans without samples.
    pub gaps: Vec<Gap>,
    /// What cannot be used.
    pub skipped: Vec<Skip>,
    /// What a user should know of how it was read.
    pub notes: Vec<String>,
    /// What a replay would use; null where it would be refused.
    pub replay: Option<Replayed>,
    /// Why a replay would be refused.
    pub refusal: Option<String>,
}

impl Contents {
    /// Looks into a log.
    ///
    /// # Errors
    /// A file that is no log, or none of which can be read.
    pub fn read(path: &Path, reading: &Reading) -> Result<Self, FlightError> {
        let log = read_bytes(path).and_then(|bytes| recording(&bytes, reading));
        let log = log.map_err(|fault| fault.in_file(path))?;
        let whole = log.span().unwrap_or(Span {
            from_ns: 0,
            to_ns: 0,
        });
        let flight = Flight::of_recording(path.display().to_string(), log.clone(), reading);
        let own_stamps = log.mag.as_ref().filter(|_| log.has_own_stamps());
        let armed = log.armed.as_ref().map(|track| spans(track, whole));
        Ok(Self {
            log: path.display().to_string(),
            sensors: sensors(&log),
            recorded: recorded(&log),
            length_s: seconds(whole.length_ns()),
            flown: Flown::of(&log),
            armed,
            gaps: gaps::find(&log.gyro, &log.accel, own_stamps),
            format: log.dialect,
            vehicle: log.vehicle,
            dropouts: log.dropouts,
            skipped: Skipped::kinds(&log.skipped).to_vec(),
            notes: log.notes,
            replay: flight.as_ref().ok().map(Replayed::of),
            refusal: flight.err().map(|fault| fault.in_file(path).to_string()),
        })
    }
}

/// The sensors, and the motors.
fn sensors(log: &Recording) -> Vec<Signal> {
    let mut signals = vec![
        Signal::of(Sensor::Gyroscope.name(), &log.gyro),
        Signal::of(Sensor::Accelerometer.name(), &log.accel),
    ];
    let mag = log.mag.as_ref();
    signals.extend(mag.map(|track| Signal::of(Sensor::Magnetometer.name(), track)));
    let motors = log.motors.as_ref();
    signals.extend(motors.map(|all| Signal::of(format!("{} motors", all.count), &all.track)));
    signals
}

/// What else there is.
fn recorded(log: &Recording) -> Vec<Signal> {
    let all = &log.recorded;
    let attitudes = [
        ("attitude", &all.attitude),
        ("attitude setpoint", &all.attitude_setpoint),
    ];
    let attitudes = attitudes.into_iter();
    let mut signals: Vec<Signal> = attitudes
        .filter_map(|(name, track)| Some(Signal::of(name, track.as_ref()?)))
        .collect();
    let rates = all.rates_setpoint.as_ref();
    signals.extend(rates.map(|track| Signal::of("rates setpoint", track)));
    let thrust = all.thrust_setpoint.as_ref();
    signals.extend(thrust.map(|track| Signal::of("thrust setpoint", track)));
    let position = all.position.as_ref();
    signals.extend(position.map(|track| Signal::of("position", track)));
    signals
}

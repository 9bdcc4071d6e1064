//! A recorded flight, turned into the board's body frame and checked.

use std::fmt;
use std::path::Path;

use super::error::{Fault, FlightError};
use super::formats;
use super::gaps::{self, Gap};
use super::parts::{Flown, Part, Taken, choose};
use super::recording::{Frame, LogFormat, Motors, Recorded, Recording};
use super::rotation::{Rotate, Rotation};
use super::skipped::Skipped;
use super::track::{SECOND_NS, Track, seconds};
use super::units::Units;
use chip_models::stimulus::STANDARD_GRAVITY;

/// Why the log's axes are turned as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotationReason {
    /// The user named the rotation.
    Named,
    /// The log's format says where its axes point.
    Format,
    /// The mean specific force of the flight, which the propellers push up,
    /// shows which way the log's z axis points.
    SpecificForce,
}

impl fmt::Display for RotationReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Named => "as asked for",
            Self::Format => "by the log's format",
            Self::SpecificForce => "by the direction of the specific force",
        })
    }
}

/// How a log is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// How its axes lie in the body's.
    pub rotate: Rotate,
    /// Which part of it.
    pub part: Part,
    /// Units of a text log that its header does not tell.
    pub units: Units,
}

impl From<Rotate> for Reading {
    /// The longest airborne part.
    fn from(rotate: Rotate) -> Self {
        Self {
            rotate,
            ..Self::default()
        }
    }
}

/// A recorded flight in the body frame (forward, right, down).
///
/// Times are log times: the first gyroscope sample is at 0. Other signals may
/// start earlier or later.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Name of the log's file.
    pub name: String,
    /// Kind of the log.
    pub format: LogFormat,
    /// Time of the last gyroscope sample, ns.
    pub duration_ns: i64,
    /// How the log's axes were turned into the body frame.
    pub rotation: Rotation,
    /// Why so.
    pub rotation_reason: RotationReason,
    /// Angular rates, rad/s.
    pub gyro: Track<3>,
    /// Specific forces, m/s2.
    pub accel: Track<3>,
    /// Magnetic fields, gauss; `None` where the log has none.
    pub mag: Option<Track<3>>,
    /// Motor commands, where recorded.
    pub motors: Option<Motors>,
    /// Attitude, setpoints and position, where recorded.
    pub recorded: Recorded,
    /// Holes in the log.
    pub gaps: Vec<Gap>,
    /// Which part of the log this is.
    pub part: Taken,
    /// What of the log could not be used.
    pub skipped: Skipped,
    /// What a user should know of how it was read.
    pub notes: Vec<String>,
}

impl Flight {
    /// Reads a log of any kind, known by its content, and turns it.
    ///
    /// # Errors
    /// One line with file and place: missing, empty, of a kind that is not read,
    /// of another vehicle, without gyroscope or accelerometer, with values that no
    /// sensor gives, a part that is not there, under 1 s or over 4 h, under 20 Hz,
    /// or (CSV and [`Rotate::Auto`]) with axes that cannot be found out.
    pub fn read(path: &Path, reading: impl Into<Reading>) -> Result<Self, FlightError> {
        let name = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy()
            .into_owned();
        read_bytes(path)
            .and_then(|bytes| Self::of_bytes(name, &bytes, reading))
            .map_err(|fault| fault.in_file(path))
    }

    /// Reads a log that is in memory.
    ///
    /// # Errors
    /// As [`Flight::read`], without the file.
    pub fn of_bytes(
        name: String,
        bytes: &[u8],
        reading: impl Into<Reading>,
    ) -> Result<Self, Fault> {
        let reading = reading.into();
        Self::of_recording(name, recording(bytes, &reading)?, &reading)
    }

    /// Checks, cuts, shifts and turns a recording.
    pub(super) fn of_recording(
        name: String,
        recording: Recording,
        reading: &Reading,
    ) -> Result<Self, Fault> {
        if let Some(vehicle) = &recording.vehicle.other {
            let reason =
                format!("is the log of {vehicle}: only flights of multirotors are replayed");
            return Err(Fault::whole(reason));
        }
        let part = choose(&recording, &Flown::of(&recording), reading.part)?;
        // Which way is up shows best in the air.
        let log = recording.part(part.span);
        log.check()?;
        let (rotation, rotation_reason) = rotation(&log, reading.rotate)?;
        let log = log.starting_at_zero();
        let own_stamps = log.mag.as_ref().filter(|_| log.has_own_stamps());
        let gaps = gaps::find(&log.gyro, &log.accel, own_stamps);
        let turn = |track: &Track<3>| track.map(|v| rotation.vector(v));
        Ok(Self {
            name,
            format: log.format,
            duration_ns: log.gyro.last_time_ns().unwrap_or_default(),
            rotation,
            rotation_reason,
            gyro: turn(&log.gyro),
            accel: turn(&log.accel),
            mag: log.mag.as_ref().map(turn),
            motors: log.motors,
            recorded: turned(log.recorded, rotation),
            gaps,
            part,
            skipped: log.skipped,
            notes: log.notes,
        })
    }

    /// Length, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        seconds(self.duration_ns)
    }

    /// Specific force of a drone at rest in the attitude of the first half
    /// second: the mean direction, 1 g long; level if there is none.
    #[must_use]
    pub fn specific_force_at_rest(&self) -> [f64; 3] {
        let start = self.accel.between(0, SECOND_NS / 2);
        let start = match (start, self.accel.values()) {
            ([], all) => all.get(..1).unwrap_or_default(),
            (start, _) => start,
        };
        let sum = mean(start.iter().copied());
        let norm = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
        if norm < 0.1 * STANDARD_GRAVITY {
            return [0.0, 0.0, -STANDARD_GRAVITY];
        }
        sum.map(|component| component / norm * STANDARD_GRAVITY)
    }
}

/// What a log holds, its first gyroscope sample at time 0.
pub(super) fn recording(bytes: &[u8], reading: &Reading) -> Result<Recording, Fault> {
    formats::read(bytes, &reading.units).map(Recording::starting_at_zero)
}

/// Reads a whole file, and refuses what is none.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, Fault> {
    let unreadable = |error: std::io::Error| Fault::whole(format!("cannot be read: {error}"));
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(Fault::whole("is no file"));
    }
    std::fs::read(path).map_err(unreadable)
}

/// Chooses the rotation.
fn rotation(log: &Recording, rotate: Rotate) -> Result<(Rotation, RotationReason), Fault> {
    /// A flying drone's mean is near 1 g; much less means another mounting.
    const CLEAR: f64 = STANDARD_GRAVITY / 3.0;
    match (rotate, log.frame) {
        (Rotate::Named(rotation), _) => return Ok((rotation, RotationReason::Named)),
        (Rotate::Auto, Frame::Defined(rotation)) => return Ok((rotation, RotationReason::Format)),
        (Rotate::Auto, Frame::UpOrDown | Frame::ForwardMayBeZ) => {}
    }
    let [x, y, z] = mean_in_flight(log);
    let leads = |axis: f64, others: [f64; 2]| {
        axis.abs() >= CLEAR && others.iter().all(|other| axis.abs() >= other.abs())
    };
    let rotation = match log.frame {
        _ if leads(z, [x, y]) && z > 0.0 => Rotation::ROLL_180,
        _ if leads(z, [x, y]) => Rotation::NONE,
        Frame::ForwardMayBeZ if leads(x, [y, z]) && x > 0.0 => Rotation::PITCH_90,
        _ => {
            return Err(Fault::whole(format!(
                "does not show which way its z axis points (mean specific force {x:.1}, {y:.1}, \
                 {z:.1} m/s2): name the rotation with --rotate"
            )));
        }
    };
    Ok((rotation, RotationReason::SpecificForce))
}

/// The mean specific force while motors ran, else of the whole log: a drone
/// that lies upside down after a crash must not count.
fn mean_in_flight(log: &Recording) -> [f64; 3] {
    const RUNNING: f64 = 0.1;
    let commands = log.motors.as_ref().map(Motors::mean);
    let is_running = |time| {
        let command = commands.as_ref().and_then(|track| track.latest(time));
        command.is_some_and(|(_, [mean])| mean > RUNNING)
    };
    let powered: Vec<[f64; 3]> = log
        .accel
        .iter()
        .filter(|&(time, _)| is_running(time))
        .map(|(_, value)| value)
        .collect();
    if powered.is_empty() {
        return mean(log.accel.values().iter().copied());
    }
    mean(powered.into_iter())
}

/// The mean vector; zero of none.
fn mean(values: impl ExactSizeIterator<Item = [f64; 3]>) -> [f64; 3] {
    let count = values.len().max(1) as f64;
    let sum = values.fold([0.0; 3], |sum, v| {
        [sum[0] + v[0], sum[1] + v[1], sum[2] + v[2]]
    });
    sum.map(|component| component / count)
}

/// Attitudes and rates of the turned body.
fn turned(recorded: Recorded, rotation: Rotation) -> Recorded {
    if rotation == Rotation::NONE {
        return recorded;
    }
    let back = rotation.quaternion().inverse();
    let attitude = |track: Track<4>| {
        track.map(|q| super::quaternion::to_array(super::quaternion::from_array(q) * back))
    };
    Recorded {
        attitude: recorded.attitude.map(attitude),
        attitude_setpoint: recorded.attitude_setpoint.map(attitude),
        rates_setpoint: recorded
            .rates_setpoint
            .map(|track| track.map(|v| rotation.vector(v))),
        ..recorded
    }
}

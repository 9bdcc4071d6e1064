//! A recorded flight, turned into the board's body frame and checked.

use std::fmt;
use std::path::Path;

use super::error::{Fault, FlightError};
use super::gaps::{self, Gap};
use super::recording::{LogFormat, Motors, Recorded, Recording};
use super::rotation::{Rotate, Rotation};
use super::track::{SECOND_NS, Track, seconds};
use super::{csv_log, ulog};
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
}

impl Flight {
    /// Reads a log, ULog or CSV by its content, and turns it.
    ///
    /// # Errors
    /// One line with file and place: missing, empty, cut off, of another
    /// format, without gyroscope or accelerometer, with time stamps that go
    /// back or values that no sensor gives, under 1 s or over 4 h, under 20 Hz,
    /// or (CSV and [`Rotate::Auto`]) with axes that cannot be found out.
    pub fn read(path: &Path, rotate: Rotate) -> Result<Self, FlightError> {
        let name = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy()
            .into_owned();
        read_bytes(path)
            .and_then(|bytes| Self::of_bytes(name, &bytes, rotate))
            .map_err(|fault| fault.in_file(path))
    }

    /// Reads a log that is in memory.
    ///
    /// # Errors
    /// As [`Flight::read`], without the file.
    pub fn of_bytes(name: String, bytes: &[u8], rotate: Rotate) -> Result<Self, Fault> {
        Self::of_recording(name, recording(bytes)?, rotate)
    }

    /// Checks, shifts and turns a recording.
    fn of_recording(name: String, recording: Recording, rotate: Rotate) -> Result<Self, Fault> {
        recording.check()?;
        let log = recording.starting_at_zero();
        let (rotation, rotation_reason) = rotation(&log, rotate)?;
        let own_stamps = log.mag.as_ref().filter(|_| log.format == LogFormat::Ulog);
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

/// Reads a whole file, and refuses what is none.
fn read_bytes(path: &Path) -> Result<Vec<u8>, Fault> {
    let unreadable = |error: std::io::Error| Fault::whole(format!("cannot be read: {error}"));
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(Fault::whole("is no file"));
    }
    std::fs::read(path).map_err(unreadable)
}

/// Reads a log by what it starts with.
fn recording(bytes: &[u8]) -> Result<Recording, Fault> {
    const LOOK_AT: usize = 1024;
    if bytes.is_empty() {
        return Err(Fault::whole("is empty"));
    }
    if bytes.starts_with(&ulog::MAGIC) {
        return ulog::read(bytes);
    }
    let start = &bytes[..bytes.len().min(LOOK_AT)];
    let is_binary = start.contains(&0) || !is_text(start);
    let is_blackbox = start.starts_with(b"H Product:Blackbox");
    if is_binary || is_blackbox || start.starts_with(b"ULog") {
        return Err(Fault::whole(
            "is neither a ULog (PX4) nor CSV: logs of other autopilots must be converted to CSV",
        ));
    }
    csv_log::read(bytes)
}

/// True for UTF-8, the last character of which may be cut.
fn is_text(bytes: &[u8]) -> bool {
    std::str::from_utf8(bytes).map_or_else(|error| error.error_len().is_none(), |_| true)
}

/// Chooses the rotation.
fn rotation(log: &Recording, rotate: Rotate) -> Result<(Rotation, RotationReason), Fault> {
    /// A flying drone's mean is near 1 g; much less means another mounting.
    const CLEAR: f64 = STANDARD_GRAVITY / 3.0;
    match (rotate, log.format) {
        (Rotate::Named(rotation), _) => return Ok((rotation, RotationReason::Named)),
        (Rotate::Auto, LogFormat::Ulog) => return Ok((Rotation::NONE, RotationReason::Format)),
        (Rotate::Auto, LogFormat::Csv) => {}
    }
    let [x, y, z] = mean_in_flight(log);
    if z.abs() < CLEAR || z.abs() < x.abs().max(y.abs()) {
        return Err(Fault::whole(format!(
            "does not show which way its z axis points (mean specific force {x:.1}, {y:.1}, \
             {z:.1} m/s2): name the rotation with --rotate"
        )));
    }
    let rotation = if z > 0.0 {
        Rotation::ROLL_180
    } else {
        Rotation::NONE
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

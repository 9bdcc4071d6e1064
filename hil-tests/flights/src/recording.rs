//! What a reader takes from a log, in the log's own axes and time.

use std::cell::Cell;
use std::fmt;

use super::error::{Fault, Location};
use super::rotation::Rotation;
use super::skipped::Skipped;
use super::track::{SECOND_NS, Span, Track, seconds};

/// The kinds of logs that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LogFormat {
    /// Columns of text.
    Csv,
    /// PX4's binary log.
    Ulog,
    /// The log of Betaflight, Cleanflight and INAV.
    Blackbox,
    /// ArduPilot's binary log.
    Dataflash,
    /// The log of a Crazyflie's memory card.
    Usd,
}

impl fmt::Display for LogFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Csv => "CSV",
            Self::Ulog => "ULog (PX4)",
            Self::Blackbox => "Blackbox (Betaflight, Cleanflight, INAV)",
            Self::Dataflash => "DataFlash (ArduPilot)",
            Self::Usd => "uSD (Crazyflie)",
        })
    }
}

/// How a format's axes lie in the body's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// By the format's definition.
    Defined(Rotation),
    /// Its z axis points up or down: the specific force shows which.
    UpOrDown,
    /// As above, or its x axis points up and its z axis forward, as in EuRoC's recordings.
    ForwardMayBeZ,
}

/// What a log says of the drone that wrote it.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Vehicle {
    /// Firmware, board and name, as far as they are told.
    pub description: String,
    /// What it is, where it is no multirotor.
    pub other: Option<String>,
}

/// Messages that the autopilot could not write.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Dropouts {
    /// How many times it lost some.
    pub count: u64,
    /// How long these took together, s, where it is told.
    pub lost_s: f64,
}

/// The sensors of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Sensor {
    /// Angular rate, rad/s.
    Gyroscope,
    /// Specific force, m/s2.
    Accelerometer,
    /// Magnetic field, gauss.
    Magnetometer,
}

impl Sensor {
    /// What it is called.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Gyroscope => "gyroscope",
            Self::Accelerometer => "accelerometer",
            Self::Magnetometer => "magnetometer",
        }
    }

    /// What it measures.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Gyroscope => "rates",
            Self::Accelerometer => "specific forces",
            Self::Magnetometer => "fields",
        }
    }

    /// Unit of the log's values.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Gyroscope => "rad/s",
            Self::Accelerometer => "m/s2",
            Self::Magnetometer => "gauss",
        }
    }

    /// No sensor on a drone reads more: beyond it the unit or the file is wrong.
    fn limit(self) -> f64 {
        match self {
            Self::Gyroscope => 100.0,
            Self::Accelerometer => 2000.0,
            Self::Magnetometer => 100.0,
        }
    }

    /// Says what is wrong with a value, if anything.
    pub(super) fn check(self, value: f64) -> Result<(), String> {
        if !value.is_finite() {
            return Err(format!("{value} is not a number a sensor can give"));
        }
        if value.abs() > self.limit() {
            let (limit, unit) = (self.limit(), self.unit());
            return Err(format!("{value} is beyond +-{limit} {unit}: wrong unit?"));
        }
        Ok(())
    }
}

/// Most motors that a log or the board has.
pub const MAX_MOTORS: usize = 8;

/// Motor commands, 0..1 of full scale; unused ones are 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Motors {
    /// How many motors the log has, 1 to [`MAX_MOTORS`].
    pub count: usize,
    /// Their commands.
    pub track: Track<MAX_MOTORS>,
}

impl Motors {
    /// The mean command of the motors in use.
    #[must_use]
    pub fn mean(&self) -> Track<1> {
        let count = self.count.clamp(1, MAX_MOTORS);
        self.track
            .map(|m| [m[..count].iter().sum::<f64>() / count as f64])
    }
}

/// What some logs hold beside the sensors; quaternions are w, x, y, z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Attitude, forward-right-down in north-east-down.
    pub attitude: Option<Track<4>>,
    /// Desired attitude, same frames.
    pub attitude_setpoint: Option<Track<4>>,
    /// Desired body rates, rad/s.
    pub rates_setpoint: Option<Track<3>>,
    /// Desired collective thrust, 0..1.
    pub thrust_setpoint: Option<Track<1>>,
    /// Position (m) and velocity (m/s), north-east-down, where valid.
    pub position: Option<Track<6>>,
}

/// The content of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Which reader read it.
    pub format: LogFormat,
    /// Its format, or whose columns it has.
    pub dialect: String,
    /// Who flew.
    pub vehicle: Vehicle,
    /// How its axes lie in the body's.
    pub frame: Frame,
    /// Angular rates, rad/s.
    pub gyro: Track<3>,
    /// Specific forces, m/s2.
    pub accel: Track<3>,
    /// Magnetic fields, gauss; `None` where the log has none.
    pub mag: Option<Track<3>>,
    /// Motor commands, where recorded.
    pub motors: Option<Motors>,
    /// The rest.
    pub recorded: Recorded,
    /// 1 while motors were armed, else 0, where the log tells.
    pub armed: Option<Track<1>>,
    /// 1 while the drone stood on the ground, else 0, where the log tells.
    pub landed: Option<Track<1>>,
    /// What the autopilot lost.
    pub dropouts: Dropouts,
    /// What could not be used.
    pub skipped: Skipped,
    /// What a user should know of how it was read.
    pub notes: Vec<String>,
}

impl Default for Recording {
    /// Nothing yet, of a log whose axes are the body's.
    fn default() -> Self {
        Self {
            format: LogFormat::Csv,
            dialect: String::new(),
            vehicle: Vehicle::default(),
            frame: Frame::Defined(Rotation::NONE),
            gyro: Track::new(),
            accel: Track::new(),
            mag: None,
            motors: None,
            recorded: Recorded::default(),
            armed: None,
            landed: None,
            dropouts: Dropouts::default(),
            skipped: Skipped::default(),
            notes: Vec::new(),
        }
    }
}

/// The shortest flight worth replaying.
const SHORTEST_NS: i64 = SECOND_NS;
/// The longest: beyond it a time stamp is more likely wrong than right.
const LONGEST_NS: i64 = 4 * 3600 * SECOND_NS;
/// Slower logs say nothing about control.
const SLOWEST_HZ: f64 = 20.0;

impl Recording {
    /// From the first to the last gyroscope sample.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        Some(Span {
            from_ns: self.gyro.first_time_ns()?,
            to_ns: self.gyro.last_time_ns()?,
        })
    }

    /// True where magnetometer samples have times of their own: lines of text hold them.
    pub(super) fn has_own_stamps(&self) -> bool {
        self.format != LogFormat::Csv
    }

    /// Refuses a recording from which no flight can be replayed.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let Some(span) = self.span() else {
            return Err(Fault::whole("has no gyroscope samples"));
        };
        if self.accel.is_empty() {
            return Err(Fault::whole("has no accelerometer samples"));
        }
        let length = span.length_ns();
        if length < SHORTEST_NS {
            return Err(Fault::whole(format!(
                "is too short: {:.3} s of samples, a replay needs at least {} s",
                seconds(length),
                seconds(SHORTEST_NS)
            )));
        }
        if length > LONGEST_NS {
            return Err(Fault::whole(format!(
                "is too long: its time stamps span {:.0} s, a replay takes at most {:.0} s: \
                 choose a part with --from and --to",
                seconds(length),
                seconds(LONGEST_NS)
            )));
        }
        check_rate(Sensor::Gyroscope, &self.gyro)?;
        check_rate(Sensor::Accelerometer, &self.accel)
    }

    /// The recording without values that are no numbers; they are counted as skipped.
    pub(super) fn of_numbers(self) -> Self {
        let numbers = Numbers {
            left_out: Cell::new(0),
        };
        let mut recording = self.changed(&numbers);
        let left_out = numbers.left_out.get();
        if left_out > 0 {
            let what = "values that are no numbers";
            recording.skipped.add_many(Location::File, what, left_out);
        }
        recording
    }

    /// The recording with its first gyroscope sample at time 0.
    pub(super) fn starting_at_zero(self) -> Self {
        let start = self.gyro.first_time_ns().unwrap_or_default();
        self.changed(&Shift(start))
    }

    /// A part of it. All signals but the gyroscope's, whose span it is, keep the sample before it and
    /// the one behind.
    pub(super) fn part(self, span: Span) -> Self {
        let gyro = self.gyro.within(span);
        Self {
            gyro,
            ..self.changed(&Around(span))
        }
    }

    /// Every track, changed.
    fn changed(self, change: &impl EachTrack) -> Self {
        let Recorded {
            attitude,
            attitude_setpoint,
            rates_setpoint,
            thrust_setpoint,
            position,
        } = self.recorded;
        Self {
            gyro: change.of(self.gyro),
            accel: change.of(self.accel),
            mag: self.mag.map(|track| change.of(track)),
            motors: self.motors.map(|motors| Motors {
                count: motors.count,
                track: change.of(motors.track),
            }),
            recorded: Recorded {
                attitude: attitude.map(|track| change.of(track)),
                attitude_setpoint: attitude_setpoint.map(|track| change.of(track)),
                rates_setpoint: rates_setpoint.map(|track| change.of(track)),
                thrust_setpoint: thrust_setpoint.map(|track| change.of(track)),
                position: position.map(|track| change.of(track)),
            },
            armed: self.armed.map(|track| change.of(track)),
            landed: self.landed.map(|track| change.of(track)),
            ..self
        }
    }
}

/// A change of every track, whatever it holds.
trait EachTrack {
    fn of<const N: usize>(&self, track: Track<N>) -> Track<N>;
}

/// Everything earlier, ns.
struct Shift(i64);

impl EachTrack for Shift {
    fn of<const N: usize>(&self, track: Track<N>) -> Track<N> {
        track.earlier(self.0)
    }
}

/// What holds within a span.
struct Around(Span);

impl EachTrack for Around {
    fn of<const N: usize>(&self, track: Track<N>) -> Track<N> {
        track.around(self.0)
    }
}

/// What is a number, and how many values were none.
struct Numbers {
    left_out: Cell<u64>,
}

impl EachTrack for Numbers {
    fn of<const N: usize>(&self, track: Track<N>) -> Track<N> {
        let numbers = track.numbers();
        let left_out = (track.len() - numbers.len()) as u64;
        self.left_out.update(|sum| sum + left_out);
        numbers
    }
}

/// Refuses a sensor that was logged too slowly to replay.
fn check_rate(sensor: Sensor, track: &Track<3>) -> Result<(), Fault> {
    let rate = track.rate_hz();
    if rate < SLOWEST_HZ {
        let name = sensor.name();
        return Err(Fault::whole(format!(
            "has its {name} at {rate:.1} Hz only, a replay needs at least {SLOWEST_HZ} Hz"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_in_degrees_is_taken_for_a_wrong_unit() {
        assert_eq!(Sensor::Gyroscope.check(20.0), Ok(()));
        let error = Sensor::Gyroscope.check(400.0).expect_err("too fast");
        assert!(error.contains("wrong unit"), "{error}");
        assert!(Sensor::Accelerometer.check(f64::NAN).is_err());
    }

    #[test]
    fn the_mean_counts_only_the_motors_in_use() {
        let motors = Motors {
            count: 4,
            track: Track::constant([0.2, 0.4, 0.6, 0.8, 0.0, 0.0, 0.0, 0.0]),
        };
        assert_eq!(motors.mean().at(0), Some([0.5]));
    }
}

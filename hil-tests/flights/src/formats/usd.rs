//! Reads flights from the memory card of a Crazyflie, as its uSD deck writes them.
//!
//! A header lists events with their variables; each event has a number, a time
//! and its values. Axes are forward, left, up; rates are deg/s, forces g, fields
//! gauss, motors of 65535.

use std::collections::HashMap;

use super::super::error::{Fault, Location};
use super::super::recording::{Frame, LogFormat, MAX_MOTORS, Motors, Recording, Sensor, Vehicle};
use super::super::rotation::Rotation;
use super::super::samples::Samples;
use super::super::skipped::Skipped;
use super::super::track::Track;
use chip_models::stimulus::STANDARD_GRAVITY;

const MAGIC: u8 = 0xbc;
/// The sum that ends a log that was closed.
const SUM_BYTES: usize = 4;
/// Between two events of a log that is whole.
const MOST_TIME_US: u64 = 60_000_000;

/// True for a log of a version that is known.
pub(super) fn knows(bytes: &[u8]) -> bool {
    matches!(bytes, [MAGIC, 1 | 2, 0, ..])
}

/// Reads a log as far as it can be read.
///
/// # Errors
/// A header that is spoilt, or what the log lacks.
pub(super) fn read(bytes: &[u8]) -> Result<Recording, Fault> {
    let mut cursor = Cursor { bytes, position: 1 };
    let header = header(&mut cursor);
    let (version, kinds) = header.ok_or_else(|| {
        let place = Location::Byte(cursor.position as u64);
        Fault::new(place, "is cut off within its header")
    })?;
    let mut flight = Flight::default();
    let end = bytes.len().saturating_sub(SUM_BYTES);
    let mut last_us = None;
    while cursor.position < end {
        let start = cursor.position;
        let place = Location::Byte(start as u64);
        let event = event(bytes, start, version, &kinds, last_us);
        let Some((kind, time_us, values, next)) = event else {
            flight.skipped.add(place, "bytes of garbage");
            cursor.position = start + 1;
            continue;
        };
        last_us = Some(time_us);
        flight.take(place, time_us as i64 * 1000, kind, values);
        cursor.position = next;
    }
    flight.finish()
}

/// One kind of event: where in it is what a flight needs.
struct Kind {
    bytes: usize,
    gyro: Option<[Variable; 3]>,
    accel: Option<[Variable; 3]>,
    mag: Option<[Variable; 3]>,
    motors: Option<[Variable; 4]>,
}

impl Kind {
    /// Of variables in their order.
    fn of(variables: &[(String, Type)]) -> Self {
        let find = |name: String| {
            let at = variables.iter().position(|(known, _)| *known == name)?;
            let before = variables[..at].iter().map(|(_, kind)| kind.bytes());
            let (offset, kind) = (before.sum(), variables[at].1);
            Some(Variable { offset, kind })
        };
        let axes = |name: &str| {
            let [x, y, z] = ["x", "y", "z"].map(|axis| find(format!("{name}.{axis}")));
            Some([x?, y?, z?])
        };
        let [m1, m2, m3, m4] = [1, 2, 3, 4].map(|motor| find(format!("motor.m{motor}")));
        Self {
            bytes: variables.iter().map(|(_, kind)| kind.bytes()).sum(),
            gyro: axes("gyro"),
            accel: axes("acc"),
            mag: axes("mag"),
            motors: (|| Some([m1?, m2?, m3?, m4?]))(),
        }
    }
}

/// A number within an event.
#[derive(Clone, Copy)]
struct Variable {
    offset: usize,
    kind: Type,
}

impl Variable {
    fn number(self, values: &[u8]) -> f64 {
        let end = self.offset + self.kind.bytes();
        let bytes = values.get(self.offset..end).unwrap_or_default();
        self.kind.number(bytes)
    }
}

/// How a number is written.
#[derive(Clone, Copy)]
enum Type {
    Unsigned(usize),
    Signed(usize),
    Float,
    Double,
}

impl Type {
    /// By its letter, as Python's `struct` has them.
    fn of(letter: char) -> Option<Self> {
        Some(match letter {
            'B' | '?' => Self::Unsigned(1),
            'H' => Self::Unsigned(2),
            'I' | 'L' => Self::Unsigned(4),
            'Q' => Self::Unsigned(8),
            'b' => Self::Signed(1),
            'h' => Self::Signed(2),
            'i' | 'l' => Self::Signed(4),
            'q' => Self::Signed(8),
            'f' => Self::Float,
            'd' => Self::Double,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::Unsigned(bytes) | Self::Signed(bytes) => bytes,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    fn number(self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        for (to, from) in word.iter_mut().zip(bytes) {
            *to = *from;
        }
        let word = u64::from_le_bytes(word);
        match self {
            Self::Unsigned(_) => word as f64,
            Self::Signed(bytes) => {
                let unused = 64 - 8 * bytes as u32;
                ((word << unused) as i64 >> unused) as f64
            }
            Self::Float => f32::from_bits(word as u32).into(),
            Self::Double => f64::from_bits(word),
        }
    }
}

struct Cursor<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl Cursor<'_> {
    fn word(&mut self) -> Option<u16> {
        let word = self.bytes.get(self.position..self.position + 2)?;
        self.position += 2;
        Some(u16::from_le_bytes([word[0], word[1]]))
    }

    /// A text that ends with a zero.
    fn text(&mut self) -> Option<String> {
        let rest = self.bytes.get(self.position..)?;
        let length = rest.iter().position(|&byte| byte == 0)?;
        self.position += length + 1;
        Some(String::from_utf8_lossy(&rest[..length]).into_owned())
    }
}

/// The version, and the kinds of events by their numbers.
fn header(cursor: &mut Cursor) -> Option<(u16, HashMap<u16, Kind>)> {
    let version = cursor.word()?;
    let count = cursor.word()?;
    let mut kinds = HashMap::new();
    for _ in 0..count {
        let id = cursor.word()?;
        cursor.text()?;
        let mut variables = Vec::new();
        for _ in 0..cursor.word()? {
            // A variable is written as `gyro.x(f)`.
            let text = cursor.text()?;
            let (name, kind) = text.strip_suffix(')')?.rsplit_once('(')?;
            let mut letters = kind.chars();
            variables.push((name.to_owned(), Type::of(letters.next()?)?));
        }
        kinds.insert(id, Kind::of(&variables));
    }
    Some((version, kinds))
}

/// The event at a position: its kind, time (us), values, and where the next one is.
fn event<'a>(
    bytes: &'a [u8],
    at: usize,
    version: u16,
    kinds: &'a HashMap<u16, Kind>,
    last_us: Option<u64>,
) -> Option<(&'a Kind, u64, &'a [u8], usize)> {
    let id = bytes.get(at..at + 2)?;
    let kind = kinds.get(&u16::from_le_bytes([id[0], id[1]]))?;
    let (values_at, time_us) = match version {
        1 => {
            let ms = bytes.get(at + 2..)?.first_chunk()?;
            (at + 6, u64::from(u32::from_le_bytes(*ms)) * 1000)
        }
        _ => {
            let us = bytes.get(at + 2..)?.first_chunk()?;
            (at + 10, u64::from_le_bytes(*us))
        }
    };
    let is_near = last_us.is_none_or(|last| {
        let (soonest, latest) = (last.saturating_sub(MOST_TIME_US), last + MOST_TIME_US);
        (soonest..latest).contains(&time_us)
    });
    let next = values_at + kind.bytes;
    let values = bytes.get(values_at..next)?;
    (is_near && time_us < 1 << 50).then_some((kind, time_us, values, next))
}

/// A log as far as it is read.
struct Flight {
    gyro: Samples,
    accel: Samples,
    mag: Samples,
    motors: Track<MAX_MOTORS>,
    skipped: Skipped,
}

impl Default for Flight {
    fn default() -> Self {
        Self {
            gyro: Samples::new(Sensor::Gyroscope, "gyro"),
            accel: Samples::new(Sensor::Accelerometer, "acc"),
            mag: Samples::new(Sensor::Magnetometer, "mag"),
            motors: Track::new(),
            skipped: Skipped::default(),
        }
    }
}

impl Flight {
    /// Takes the values of an event in.
    fn take(&mut self, place: Location, time_ns: i64, kind: &Kind, values: &[u8]) {
        let skipped = &mut self.skipped;
        if let Some(rate) = kind.gyro {
            let rate = rate.map(|axis| axis.number(values).to_radians());
            self.gyro.take(place.clone(), time_ns, rate, skipped);
        }
        if let Some(force) = kind.accel {
            let force = force.map(|axis| axis.number(values) * STANDARD_GRAVITY);
            self.accel.take(place.clone(), time_ns, force, skipped);
        }
        if let Some(field) = kind.mag {
            let field = field.map(|axis| axis.number(values));
            self.mag.take(place, time_ns, field, skipped);
        }
        if let Some(motors) = kind.motors {
            let mut shares = [0.0; MAX_MOTORS];
            for (share, motor) in shares.iter_mut().zip(motors) {
                *share = (motor.number(values) / 65535.0).clamp(0.0, 1.0);
            }
            self.motors.push(time_ns, shares);
        }
    }

    fn finish(self) -> Result<Recording, Fault> {
        let mag = self.mag.finish()?;
        Ok(Recording {
            format: LogFormat::Usd,
            dialect: LogFormat::Usd.to_string(),
            vehicle: Vehicle {
                description: "Crazyflie".to_owned(),
                other: None,
            },
            frame: Frame::Defined(Rotation::ROLL_180),
            gyro: self.gyro.finish()?,
            accel: self.accel.finish()?,
            mag: (!mag.is_empty()).then_some(mag),
            motors: (!self.motors.is_empty()).then_some(Motors {
                count: 4,
                track: self.motors,
            }),
            skipped: self.skipped,
            ..Recording::default()
        })
    }
}

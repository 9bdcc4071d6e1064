//! Reads flights from the Blackbox logs of Betaflight, Cleanflight and INAV.
//!
//! The frames are decoded here: the crate `fc-blackbox` panics on headers and
//! encodings that it does not know, ends at the first spoilt event, and counts
//! nothing. A file may hold several sessions, one after each arming; each has
//! its own clock. Where clocks restart, a session follows 10 s behind the last.
//!
//! Axes are forward, left, up. Gyroscopes count `gyro_scale` deg/s; the samples
//! before the firmware's filters are taken where they are logged, since that is
//! what a sensor feels. Accelerometers count `acc_1G` a g, motors from
//! `motorOutput`'s low end to its high end, or pulses from 1000 to 2000 us.

mod frames;
mod header;
mod layout;

use self::frames::{Frame as Decoded, Frames};
use self::header::Header;
use super::super::error::{Fault, Location};
use super::super::recording::{
    Dropouts, Frame, LogFormat, MAX_MOTORS, Motors, Recorded, Recording, Sensor, Vehicle,
};
use super::super::rotation::Rotation;
use super::super::samples::Samples;
use super::super::skipped::Skipped;
use super::super::track::{SECOND_NS, Track};
use chip_models::stimulus::STANDARD_GRAVITY;

/// How a session begins.
const START: &[u8] = b"H Product:Blackbox";
/// Other bytes may stand before the first session, as in a dump of a chip.
const SOUGHT_BYTES: usize = 1 << 20;
/// Between sessions whose clocks say nothing of the time between them.
const PAUSE_NS: i64 = 10 * SECOND_NS;

/// True for a Blackbox log.
pub(super) fn knows(bytes: &[u8]) -> bool {
    let sought = &bytes[..bytes.len().min(SOUGHT_BYTES)];
    starts(sought).next().is_some()
}

/// Where sessions begin.
fn starts(bytes: &[u8]) -> impl Iterator<Item = usize> {
    let lines = bytes.windows(START.len()).enumerate();
    lines
        .filter(|(_, window)| *window == START)
        .map(|(at, _)| at)
}

/// Reads all sessions of a log as far as they can be read.
///
/// # Errors
/// What the log lacks, or why no session of it can be read.
pub(super) fn read(bytes: &[u8]) -> Result<Recording, Fault> {
    let starts: Vec<usize> = starts(bytes).collect();
    let ends = starts.iter().skip(1).copied().chain([bytes.len()]);
    let mut flights = Flights::default();
    let mut refusal = None;
    for (&from, to) in starts.iter().zip(ends) {
        let session = bytes.get(from..to).unwrap_or_default();
        if let Err(fault) = flights.add(from, session) {
            flights
                .skipped
                .add(fault.location.clone(), "sessions that cannot be read");
            refusal.get_or_insert(fault);
        }
    }
    flights.finish().map_err(|fault| refusal.unwrap_or(fault))
}

/// All sessions so far, on one clock.
struct Flights {
    gyro: Samples,
    accel: Samples,
    motors: Track<MAX_MOTORS>,
    motor_count: usize,
    rates: Track<3>,
    dropouts: Dropouts,
    skipped: Skipped,
    vehicle: String,
    notes: Vec<String>,
    /// Time of the newest frame.
    last_ns: Option<i64>,
}

impl Default for Flights {
    fn default() -> Self {
        Self {
            gyro: Samples::new(Sensor::Gyroscope, "gyroscope"),
            accel: Samples::new(Sensor::Accelerometer, "accelerometer"),
            motors: Track::new(),
            motor_count: 0,
            rates: Track::new(),
            dropouts: Dropouts::default(),
            skipped: Skipped::default(),
            vehicle: String::new(),
            notes: Vec::new(),
            last_ns: None,
        }
    }
}

impl Flights {
    /// Takes a session in that begins at a byte of the log.
    fn add(&mut self, from: usize, session: &[u8]) -> Result<(), Fault> {
        let at_start = |reason: String| Fault::new(Location::Byte(from as u64), reason);
        let (header, body) = Header::read(session).map_err(at_start)?;
        let fields = Fields::of(&header).map_err(at_start)?;
        if self.vehicle.is_empty() {
            self.vehicle = header.description();
            self.notes.extend(fields.note());
        }
        self.motor_count = self.motor_count.max(fields.motors.len());
        let first_byte = from + (session.len() - body.len());
        let mut frames = Frames::new(&header, body, first_byte);
        let mut shift = None;
        while let Some(frame) = frames.next(&mut self.skipped) {
            let (place, values) = match frame {
                Decoded::Main { place, values } => (place, values),
                Decoded::Resumed => {
                    self.dropouts.count += 1;
                    continue;
                }
            };
            let time_ns = values[header.time] * 1000;
            let shift = *shift.get_or_insert_with(|| match self.last_ns {
                Some(last) if time_ns < last => last + PAUSE_NS - time_ns,
                _ => 0,
            });
            self.frame(&fields, place, time_ns + shift, values);
        }
        Ok(())
    }

    /// Takes the values of a main frame in.
    fn frame(&mut self, fields: &Fields, place: Location, time_ns: i64, values: &[i64]) {
        let of = |columns: [usize; 3], unit: f64| columns.map(|i| values[i] as f64 * unit);
        let skipped = &mut self.skipped;
        let gyro = of(fields.gyro, fields.gyro_unit);
        self.gyro.take(place.clone(), time_ns, gyro, skipped);
        let accel = of(fields.accel, fields.accel_unit);
        self.accel.take(place, time_ns, accel, skipped);
        if let Some(setpoint) = fields.setpoint {
            self.rates.push(time_ns, of(setpoint, 1.0_f64.to_radians()));
        }
        let mut motors = [0.0; MAX_MOTORS];
        for (share, &column) in motors.iter_mut().zip(&fields.motors) {
            *share = fields.share(values[column]);
        }
        self.motors.push(time_ns, motors);
        self.last_ns = self.last_ns.max(Some(time_ns));
    }

    fn finish(self) -> Result<Recording, Fault> {
        let count = self.motor_count;
        Ok(Recording {
            format: LogFormat::Blackbox,
            dialect: LogFormat::Blackbox.to_string(),
            vehicle: Vehicle {
                description: self.vehicle,
                other: None,
            },
            frame: Frame::Defined(Rotation::ROLL_180),
            gyro: self.gyro.finish()?,
            accel: self.accel.finish()?,
            motors: (count > 0).then_some(Motors {
                count,
                track: self.motors,
            }),
            recorded: Recorded {
                rates_setpoint: (!self.rates.is_empty()).then_some(self.rates),
                ..Recorded::default()
            },
            dropouts: self.dropouts,
            skipped: self.skipped,
            notes: self.notes,
            ..Recording::default()
        })
    }
}

/// Which fields of a frame are used, and their units.
struct Fields {
    gyro: [usize; 3],
    /// rad/s of one count.
    gyro_unit: f64,
    is_unfiltered: bool,
    accel: [usize; 3],
    /// m/s2 of one count.
    accel_unit: f64,
    motors: Vec<usize>,
    /// Motor commands at no thrust and at full thrust.
    motor_ends: [f64; 2],
    setpoint: Option<[usize; 3]>,
}

impl Fields {
    fn of(header: &Header) -> Result<Self, String> {
        let group = |name: &str| -> Option<[usize; 3]> {
            let [x, y, z] = [0, 1, 2].map(|i| header.field(&format!("{name}[{i}]")));
            Some([x?, y?, z?])
        };
        let unfiltered = group("gyroUnfilt");
        let gyro = unfiltered
            .or_else(|| group("gyroADC"))
            .or_else(|| group("gyroData"));
        let missing = |what: &str, field: &str| {
            format!(
                "has no {what} ({field}): log it, by `set blackbox_disable_...` in the firmware"
            )
        };
        let motors = (0..MAX_MOTORS).map_while(|i| header.field(&format!("motor[{i}]")));
        Ok(Self {
            gyro: gyro.ok_or_else(|| missing("gyroscope", "gyroADC"))?,
            gyro_unit: header.gyro_unit(),
            is_unfiltered: unfiltered.is_some(),
            accel: group("accSmooth").ok_or_else(|| missing("accelerometer", "accSmooth"))?,
            accel_unit: STANDARD_GRAVITY / header.counts_of_1_g(),
            motors: motors.collect(),
            motor_ends: header.motor_ends(),
            setpoint: group("setpoint"),
        })
    }

    /// What a user should know of the choice.
    fn note(&self) -> Option<String> {
        let note = "gyroscope: gyroUnfilt, before the firmware's filters";
        self.is_unfiltered.then(|| note.to_owned())
    }

    /// A motor command as a share of full scale.
    fn share(&self, command: i64) -> f64 {
        let [low, high] = self.motor_ends;
        ((command as f64 - low) / (high - low)).clamp(0.0, 1.0)
    }
}

//! Makes a recording of the messages of a DataFlash log.

use std::collections::BTreeMap;

use nalgebra::UnitQuaternion;

use super::super::super::error::{Fault, Location};
use super::super::super::quaternion::to_array;
use super::super::super::recording::{
    Dropouts, LogFormat, MAX_MOTORS, Motors, Recorded, Recording, Sensor, Vehicle,
};
use super::super::super::samples::Samples;
use super::super::super::skipped::Skipped;
use super::super::super::track::Track;
use super::framing::{Fields, Message, Reader};

/// The most channels of `RCOU`.
const CHANNELS: usize = 14;

/// A log as far as it is read.
#[derive(Default)]
pub(super) struct Flight {
    /// Samples by their messages and instances.
    sensors: BTreeMap<(Sensor, String), Live>,
    outputs: Track<CHANNELS>,
    /// For each motor, which channel it is.
    functions: BTreeMap<usize, usize>,
    frame: String,
    attitude: Track<4>,
    attitude_setpoint: Track<4>,
    /// Desired and measured rates, in a unit of the firmware's age.
    rates: Track<6>,
    thrust: Track<1>,
    armed: Track<1>,
    landed: Track<1>,
    vehicle: String,
    dropped: f64,
    now_ns: i64,
    skipped: Skipped,
}

/// The samples of one instance, and whether they ever changed.
struct Live {
    samples: Samples,
    count: usize,
    last: Option<[f64; 3]>,
    moves: bool,
}

impl Live {
    /// Whether it ever moves, as no instance does that is all zero, and how many samples it has.
    fn lively(&self) -> (bool, usize) {
        (self.moves, self.count)
    }
}

impl Reader for Flight {
    fn take(&mut self, message: &Message) {
        let name = message.name();
        let is_wanted = matches!(
            name.trim_end_matches(|c: char| c.is_ascii_digit()),
            "IMU"
                | "GYR"
                | "ACC"
                | "MAG"
                | "RCOU"
                | "ATT"
                | "RATE"
                | "CTUN"
                | "EV"
                | "ARM"
                | "MSG"
                | "PARM"
                | "DSF"
        );
        if !is_wanted {
            return;
        }
        let fields = message.fields();
        // A stamp beyond is wrong; without one, as in old events, it is the time of the last.
        let time_us = fields.time_us().filter(|us| (0.0..4e15).contains(us));
        if let Some(us) = time_us {
            self.now_ns = (us * 1e3) as i64;
        }
        match name {
            "RCOU" => self.outputs(&fields),
            "ATT" => self.attitude(&fields),
            "RATE" => self.rates(&fields),
            "CTUN" => {
                let share = fields.number("ThO");
                let share = share.or_else(|| Some(fields.number("ThrOut")? / 1000.0));
                if let Some(share) = share.filter(|share| share.is_finite()) {
                    self.thrust.push(self.now_ns, [share.clamp(0.0, 1.0)]);
                }
            }
            "EV" => self.event(fields.number("Id").unwrap_or_default() as u64),
            "ARM" => {
                if let Some(state) = fields.number("ArmState") {
                    self.armed.push(self.now_ns, [state.min(1.0)]);
                }
            }
            "MSG" => self.text(fields.text("Message").unwrap_or_default()),
            "PARM" => self.parameter(&fields),
            "DSF" => self.dropped = fields.number("Dp").unwrap_or_default().max(self.dropped),
            _ => self.sensors(message, &fields),
        }
    }

    fn skip(&mut self, place: Location, what: &str, count: u64) {
        self.skipped.add_many(place, what, count);
    }
}

impl Flight {
    fn sensors(&mut self, message: &Message, fields: &Fields) {
        const KINDS: [(Sensor, [&str; 3], f64); 3] = [
            (Sensor::Gyroscope, ["GyrX", "GyrY", "GyrZ"], 1.0),
            (Sensor::Accelerometer, ["AccX", "AccY", "AccZ"], 1.0),
            (Sensor::Magnetometer, ["MagX", "MagY", "MagZ"], 1e-3),
        ];
        // Samples at the full rate have a time of their own.
        let sample_us = fields
            .number("SampleUS")
            .filter(|us| (1.0..4e15).contains(us));
        let time_ns = sample_us.map_or(self.now_ns, |us| (us * 1e3) as i64);
        let name = match fields.number("I") {
            Some(instance) => format!("{}[{instance}]", message.name()),
            None => message.name().to_owned(),
        };
        for (sensor, axes, unit) in KINDS {
            let Some(value) = fields.numbers(axes) else {
                continue;
            };
            let live = self.sensors.entry((sensor, name.clone()));
            let live = live.or_insert_with_key(|(sensor, name)| Live {
                samples: Samples::new(*sensor, name),
                count: 0,
                last: None,
                moves: false,
            });
            live.moves |= live.last.replace(value).is_some_and(|last| last != value);
            live.count += 1;
            let value = value.map(|component| component * unit);
            let place = message.place.clone();
            live.samples.take(place, time_ns, value, &mut self.skipped);
        }
    }

    fn outputs(&mut self, fields: &Fields) {
        let mut pulses = [0.0; CHANNELS];
        for (i, pulse) in pulses.iter_mut().enumerate() {
            let [new, old] = [format!("C{}", i + 1), format!("Ch{}", i + 1)];
            let found = fields.number(&new).or_else(|| fields.number(&old));
            *pulse = found.unwrap_or_default();
        }
        self.outputs.push(self.now_ns, pulses);
    }

    fn attitude(&mut self, fields: &Fields) {
        let quaternion = |angles: [f64; 3]| {
            let [roll, pitch, yaw] = angles.map(f64::to_radians);
            let sane = angles.iter().all(|angle| angle.is_finite());
            sane.then(|| to_array(UnitQuaternion::from_euler_angles(roll, pitch, yaw)))
        };
        let is = fields.numbers(["Roll", "Pitch", "Yaw"]);
        let desired = fields.numbers(["DesRoll", "DesPitch", "DesYaw"]);
        if let Some(q) = is.and_then(quaternion) {
            self.attitude.push(self.now_ns, q);
        }
        if let Some(q) = desired.and_then(quaternion) {
            self.attitude_setpoint.push(self.now_ns, q);
        }
    }

    fn rates(&mut self, fields: &Fields) {
        let rates = fields.numbers(["RDes", "PDes", "YDes", "R", "P", "Y"]);
        if let Some(rates) = rates.filter(|rates| rates.iter().all(|rate| rate.is_finite())) {
            self.rates.push(self.now_ns, rates);
        }
    }

    /// What happened, as ArduPilot numbers it.
    fn event(&mut self, id: u64) {
        match id {
            10 => self.armed.push(self.now_ns, [1.0]),
            11 => {
                self.armed.push(self.now_ns, [0.0]);
                self.landed.push(self.now_ns, [1.0]);
            }
            18 => self.landed.push(self.now_ns, [1.0]),
            28 => self.landed.push(self.now_ns, [0.0]),
            _ => {}
        }
    }

    fn text(&mut self, text: &str) {
        if let Some(frame) = text.strip_prefix("Frame: ") {
            self.frame = frame.to_owned();
        }
        let is_firmware = text.starts_with("Ardu") || text.starts_with("APM:");
        if is_firmware && self.vehicle.is_empty() {
            self.vehicle = text.to_owned();
        }
    }

    fn parameter(&mut self, fields: &Fields) {
        /// The functions of motors 1 to 8.
        const MOTORS: std::ops::RangeInclusive<usize> = 33..=40;
        let name = fields.text("Name").unwrap_or_default();
        let number = name
            .strip_prefix("SERVO")
            .and_then(|name| name.strip_suffix("_FUNCTION"));
        let channel = number.and_then(|number| number.parse::<usize>().ok());
        let function = fields.number("Value").unwrap_or_default() as usize;
        if let Some(channel) = channel.filter(|channel| (1..=CHANNELS).contains(channel))
            && MOTORS.contains(&function)
        {
            self.functions
                .insert(function - MOTORS.start(), channel - 1);
        }
    }

    /// The recording.
    ///
    /// # Errors
    /// A log without samples of an inertial sensor.
    pub(super) fn finish(mut self) -> Result<Recording, Fault> {
        let (gyro, accel) = self.inertial()?;
        let mag = self.liveliest(Sensor::Magnetometer);
        let mag = mag.and_then(|name| self.sensors.remove(&(Sensor::Magnetometer, name)));
        let some = |track: Track<4>| (!track.is_empty()).then_some(track);
        let state = |track: Track<1>| (!track.is_empty()).then_some(track);
        // A log that begins in the air has no event before it lands.
        let took_off = self.landed.values().contains(&[0.0]);
        Ok(Recording {
            format: LogFormat::Dataflash,
            dialect: LogFormat::Dataflash.to_string(),
            mag: mag.map(|live| live.samples.finish()).transpose()?,
            motors: self.motors(),
            recorded: Recorded {
                rates_setpoint: in_rad_s(&self.rates, &gyro),
                attitude: some(self.attitude),
                attitude_setpoint: some(self.attitude_setpoint),
                thrust_setpoint: state(self.thrust),
                position: None,
            },
            gyro,
            accel,
            armed: state(self.armed),
            landed: state(self.landed).filter(|_| took_off),
            dropouts: Dropouts {
                count: self.dropped as u64,
                lost_s: 0.0,
            },
            vehicle: Vehicle {
                other: other(&self.vehicle).map(str::to_owned),
                description: self.vehicle,
            },
            skipped: self.skipped,
            ..Recording::default()
        })
    }

    /// The name of the instance of a sensor with most samples that live.
    fn liveliest(&self, sensor: Sensor) -> Option<String> {
        let instances = self.sensors.iter().filter(|((of, _), _)| *of == sensor);
        let rated = instances.map(|((_, name), live)| (live.lively(), name));
        let best = rated.reduce(|best, next| if next.0 > best.0 { next } else { best });
        best.map(|(_, name)| name.clone())
    }

    /// Gyroscope and accelerometer: of one chip, and the fastest that lives.
    fn inertial(&mut self) -> Result<(Track<3>, Track<3>), Fault> {
        let gyros = self
            .sensors
            .iter()
            .filter(|((of, _), _)| *of == Sensor::Gyroscope);
        let pairs = gyros.filter_map(|((_, name), gyro)| {
            let beside = name.replace("GYR", "ACC");
            let accel = self.sensors.get(&(Sensor::Accelerometer, beside.clone()))?;
            let lively = gyro.lively().min(accel.lively());
            Some((lively, name.clone(), beside))
        });
        let best = pairs.reduce(|best, next| if next.0 > best.0 { next } else { best });
        let (_, gyro, accel) = best.ok_or_else(|| {
            Fault::whole(
                "has no inertial sensor: none of IMU, GYR with ACC; set LOG_BITMASK to log them",
            )
        })?;
        let mut taken = |sensor, name| {
            self.sensors
                .remove(&(sensor, name))
                .map(|live| live.samples)
        };
        let gyro = taken(Sensor::Gyroscope, gyro);
        let accel = taken(Sensor::Accelerometer, accel);
        let finish = |samples: Option<Samples>| samples.map_or(Ok(Track::new()), Samples::finish);
        Ok((finish(gyro)?, finish(accel)?))
    }

    /// The motors: the channels with such a function, else the first of the frame.
    fn motors(&self) -> Option<Motors> {
        let by_frame = || {
            let count = match self.frame.to_ascii_uppercase() {
                frame if frame.contains("HEXA") || frame.contains("Y6") => 6,
                frame if frame.contains("OCTA") => 8,
                frame if frame.contains("TRI") => 3,
                _ => 4,
            };
            (0..count).collect()
        };
        let channels: Vec<usize> = match self.functions.is_empty() {
            false => self.functions.values().copied().collect(),
            true => by_frame(),
        };
        let track = self.outputs.map(|pulses| {
            let mut shares = [0.0; MAX_MOTORS];
            for (share, &channel) in shares.iter_mut().zip(&channels) {
                *share = ((pulses[channel] - 1000.0) / 1000.0).clamp(0.0, 1.0);
            }
            shares
        });
        let count = channels.len().min(MAX_MOTORS);
        (!track.is_empty()).then_some(Motors { count, track })
    }
}

/// Desired rates in rad/s: their unit changed over the years, and the measured ones beside them,
/// against the gyroscope, tell which it is.
fn in_rad_s(rates: &Track<6>, gyro: &Track<3>) -> Option<Track<3>> {
    const UNITS: [f64; 3] = [1.0, 0.017_453_292_519_943_295, 0.000_174_532_925_199_432_95];
    let energy = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let measured = energy(
        &mut rates
            .values()
            .iter()
            .flat_map(|all| all[3..].iter().copied()),
    );
    let felt = energy(
        &mut rates
            .iter()
            .flat_map(|(time, _)| gyro.at(time).unwrap_or_default()),
    );
    let off = |unit: f64| (measured * unit * unit / felt).ln().abs();
    let unit = UNITS
        .into_iter()
        .min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    let desired = rates.map(|[roll, pitch, yaw, ..]| [roll, pitch, yaw].map(|rate| rate * unit));
    (!desired.is_empty() && off(unit) < 1.0).then_some(desired)
}

/// What a vehicle is that is no multirotor, by its firmware.
fn other(firmware: &str) -> Option<&'static str> {
    const KINDS: [(&str, &str); 5] = [
        ("Plane", "a fixed wing"),
        ("Rover", "a rover"),
        ("Sub", "a submarine"),
        ("Tracker", "an antenna tracker"),
        ("Blimp", "a blimp"),
    ];
    KINDS
        .iter()
        .find(|(name, _)| firmware.contains(name))
        .map(|(_, kind)| *kind)
}

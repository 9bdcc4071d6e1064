//! Makes a recording of decoded topics.

use super::super::super::error::{Fault, Location};
use super::super::super::recording::{
    Frame, LogFormat, MAX_MOTORS, Motors, Recorded, Recording, Sensor,
};
use super::super::super::rotation::Rotation;
use super::super::super::samples::Samples;
use super::super::super::skipped::Skipped;
use super::super::super::track::Track;
use super::messages::Content;
use super::table::{Row, Stamp, Table, finite, timed};
use super::vehicle;

/// The recording that a log's topics hold.
pub(super) fn recording(content: Content) -> Result<Recording, Fault> {
    let Content {
        tables,
        dropouts,
        texts,
        mut skipped,
    } = content;
    let (gyro, accel) = imu(&tables, &mut skipped)?;
    let attitude = most(&tables, "vehicle_attitude");
    let attitude_setpoint = most(&tables, "vehicle_attitude_setpoint");
    let rates_setpoint = most(&tables, "vehicle_rates_setpoint");
    Ok(Recording {
        format: LogFormat::Ulog,
        dialect: LogFormat::Ulog.to_string(),
        vehicle: vehicle::of(&texts, most(&tables, "vehicle_status")),
        frame: Frame::Defined(Rotation::NONE),
        gyro,
        accel,
        mag: magnetometer(&tables, &mut skipped)?,
        motors: motors(&tables),
        recorded: Recorded {
            attitude: quaternions(attitude, "q", Stamp::Sample),
            attitude_setpoint: quaternions(attitude_setpoint, "q_d", Stamp::Message),
            rates_setpoint: rates(rates_setpoint),
            thrust_setpoint: thrust(attitude_setpoint).or_else(|| thrust(rates_setpoint)),
            position: position(most(&tables, "vehicle_local_position")),
        },
        armed: vehicle::armed(
            most(&tables, "vehicle_status"),
            most(&tables, "actuator_armed"),
        ),
        landed: vehicle::landed(most(&tables, "vehicle_land_detected")),
        dropouts,
        skipped,
        notes: Vec::new(),
    })
}

/// The instances of a topic, the one with most messages first.
fn instances<'a>(tables: &'a [Table], topic: &str) -> Vec<&'a Table> {
    let mut found: Vec<&Table> = tables.iter().filter(|t| t.name() == topic).collect();
    found.sort_by_key(|table| (std::cmp::Reverse(table.len()), table.instance));
    found
}

/// The instance of a topic with most messages.
fn most<'a>(tables: &'a [Table], topic: &str) -> Option<&'a Table> {
    instances(tables, topic).into_iter().next()
}

/// Three axes of a sensor: where they are, and how they are scaled.
struct Axes<'a> {
    sensor: Sensor,
    table: &'a Table,
    values: [usize; 3],
    /// Integration time (us) by which the values are divided.
    integrated_us: Option<usize>,
    /// Offset of the sample's time (us) from the message's.
    relative_us: Option<usize>,
}

impl<'a> Axes<'a> {
    /// Columns of plain values.
    fn plain(sensor: Sensor, table: &'a Table, values: [usize; 3]) -> Self {
        Self {
            sensor,
            table,
            values,
            integrated_us: None,
            relative_us: None,
        }
    }

    /// The values of a message.
    fn value(&self, row: Row) -> [f64; 3] {
        let value = row.pick(self.values);
        match self.integrated_us {
            Some(column) => value.map(|integral| integral / (row.get(column) * 1e-6)),
            None => value,
        }
    }

    /// The samples; one that does not move time on is a repetition.
    fn track(&self, skipped: &mut Skipped) -> Result<Track<3>, Fault> {
        /// What `sensor_combined` writes where a sensor had no sample yet.
        const INVALID: f64 = i32::MAX as f64;
        let mut samples = Samples::new(self.sensor, self.table.name());
        for (offset, time, row) in timed(self.table, Stamp::Sample) {
            let relative = self.relative_us.map_or(0.0, |column| row.get(column));
            if relative.abs() < INVALID {
                let time = time + relative as i64 * 1000;
                let place = Location::Byte(offset as u64);
                samples.take(place, time, self.value(row), skipped);
            }
        }
        samples.finish()
    }

    /// Whether it ever moves, as no instance does that is all zero, and how many messages it has.
    fn lively(&self) -> (bool, usize) {
        let mut values = self.table.rows().map(|(_, row)| self.value(row));
        let first = values.next();
        (values.any(|value| Some(value) != first), self.table.len())
    }
}

/// The fastest that lives, the first of equals; the first where none does.
fn liveliest<'a>(candidates: impl IntoIterator<Item = Axes<'a>>) -> Option<Axes<'a>> {
    let rated = candidates.into_iter().map(|axes| (axes.lively(), axes));
    let best = rated.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map(|(_, axes)| axes)
}

/// The pair of gyroscope and accelerometer with most samples that live.
fn imu(tables: &[Table], skipped: &mut Skipped) -> Result<(Track<3>, Track<3>), Fault> {
    let separate = |sensor, topic| {
        liveliest(
            instances(tables, topic)
                .into_iter()
                .filter_map(|t| xyz(sensor, t)),
        )
    };
    let gyro = separate(Sensor::Gyroscope, "sensor_gyro");
    let has_gyro = gyro.is_some();
    let both = gyro.zip(separate(Sensor::Accelerometer, "sensor_accel"));
    let combined = instances(tables, "sensor_combined").into_iter();
    let integrated_too = instances(tables, "vehicle_imu").into_iter();
    let candidates = combined
        .filter_map(combined_axes)
        .chain(integrated_too.filter_map(integrated))
        .chain(both);
    let rated = candidates.map(|pair| (pair.0.lively().min(pair.1.lively()), pair));
    let best = rated.reduce(|best, next| if next.0 > best.0 { next } else { best });
    let (_, (gyro, accel)) = best.ok_or_else(|| {
        Fault::whole(if has_gyro {
            "has no accelerometer: none of sensor_combined, vehicle_imu, sensor_accel"
        } else {
            "has no gyroscope: none of sensor_combined, vehicle_imu, sensor_gyro"
        })
    })?;
    Ok((gyro.track(skipped)?, accel.track(skipped)?))
}

/// The columns x, y, z of a topic.
fn xyz(sensor: Sensor, table: &Table) -> Option<Axes<'_>> {
    Some(Axes::plain(sensor, table, table.all(["x", "y", "z"])?))
}

/// Gyroscope and accelerometer of `sensor_combined`.
fn combined_axes(table: &Table) -> Option<(Axes<'_>, Axes<'_>)> {
    let gyro = table.array("gyro_rad")?;
    let accel = Axes {
        relative_us: table.column("accelerometer_timestamp_relative"),
        ..Axes::plain(
            Sensor::Accelerometer,
            table,
            table.array("accelerometer_m_s2")?,
        )
    };
    Some((Axes::plain(Sensor::Gyroscope, table, gyro), accel))
}

/// Gyroscope and accelerometer of `vehicle_imu`.
fn integrated(table: &Table) -> Option<(Axes<'_>, Axes<'_>)> {
    let axes = |sensor, values: &str, time: &str| {
        Some(Axes {
            integrated_us: Some(table.column(time)?),
            ..Axes::plain(sensor, table, table.array(values)?)
        })
    };
    let gyro = axes(Sensor::Gyroscope, "delta_angle", "delta_angle_dt")?;
    let accel = axes(Sensor::Accelerometer, "delta_velocity", "delta_velocity_dt")?;
    Some((gyro, accel))
}

/// The magnetometer, calibrated where the log has it so.
fn magnetometer(tables: &[Table], skipped: &mut Skipped) -> Result<Option<Track<3>>, Fault> {
    let field = |table, relative_us| {
        Some(Axes {
            relative_us,
            ..Axes::plain(Sensor::Magnetometer, table, table.array("magnetometer_ga")?)
        })
    };
    let of = |topic| instances(tables, topic).into_iter();
    let sources = [
        liveliest(of("vehicle_magnetometer").filter_map(|table| field(table, None))),
        liveliest(
            of("sensor_combined")
                .filter_map(|table| field(table, table.column("magnetometer_timestamp_relative"))),
        ),
        liveliest(of("sensor_mag").filter_map(|table| xyz(Sensor::Magnetometer, table))),
    ];
    for source in sources.into_iter().flatten() {
        let track = source.track(skipped)?;
        if !track.is_empty() {
            return Ok(Some(track));
        }
    }
    Ok(None)
}

/// Unit quaternions, w x y z; older logs mark those that hold nothing.
fn quaternions(table: Option<&Table>, name: &str, stamp: Stamp) -> Option<Track<4>> {
    let table = table?;
    let columns = table.array::<4>(name)?;
    let valid = table.column(&format!("{name}_valid"));
    finite(table, stamp, |row| {
        let q = row.pick(columns);
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        let is_unit = (0.9..1.1).contains(&norm);
        let is_valid = valid.is_none_or(|column| row.get(column) != 0.0);
        (is_unit && is_valid).then(|| q.map(|c| c / norm))
    })
}

/// Desired body rates.
fn rates(table: Option<&Table>) -> Option<Track<3>> {
    let table = table?;
    let columns = table.all(["roll", "pitch", "yaw"])?;
    finite(table, Stamp::Message, |row| {
        let value = row.pick(columns);
        let sane = value.iter().all(|&v| Sensor::Gyroscope.check(v).is_ok());
        sane.then_some(value)
    })
}

/// Desired thrust: a scalar in older logs, later a vector that points down.
fn thrust(table: Option<&Table>) -> Option<Track<1>> {
    let table = table?;
    let scalar = table.column("thrust").map(|column| (column, 1.0));
    let (column, sign) = scalar.or_else(|| Some((table.column("thrust_body[2]")?, -1.0)))?;
    finite(table, Stamp::Message, |row| {
        Some([(row.get(column) * sign).clamp(0.0, 1.0)])
    })
}

/// Position and velocity where all of it is valid.
fn position(table: Option<&Table>) -> Option<Track<6>> {
    let table = table?;
    let values = table.all(["x", "y", "z", "vx", "vy", "vz"])?;
    let valid = table.all(["xy_valid", "z_valid", "v_xy_valid", "v_z_valid"])?;
    finite(table, Stamp::Message, |row| {
        let all_valid = row.pick::<4>(valid).iter().all(|&flag| flag != 0.0);
        all_valid.then(|| row.pick(values))
    })
}

/// The motor commands.
fn motors(tables: &[Table]) -> Option<Motors> {
    let shares = instances(tables, "actuator_motors")
        .into_iter()
        .find_map(|table| {
            commands(table, "control", f64::is_finite, |share| {
                if share.is_finite() { share } else { 0.0 }
            })
        });
    // A pulse in us; an output without any stays at 0. Others are no pulses.
    let is_pulse = |pulse: f64| (800.0..2200.0).contains(&pulse);
    let pulses = || {
        instances(tables, "actuator_outputs")
            .into_iter()
            .find_map(|table| {
                let columns: Vec<usize> = (0..MAX_MOTORS)
                    .filter_map(|i| table.column(&format!("output[{i}]")))
                    .collect();
                let is_pulse_or_idle = |(_, row): (usize, Row)| {
                    let mut values = columns.iter().map(|&column| row.get(column));
                    values.all(|value| value == 0.0 || is_pulse(value))
                };
                if !table.rows().all(is_pulse_or_idle) {
                    return None;
                }
                commands(table, "output", is_pulse, |pulse| (pulse - 1000.0) / 1000.0)
            })
    };
    shares.or_else(pulses)
}

/// The commands of those of the first eight outputs that are ever used.
fn commands(
    table: &Table,
    name: &str,
    is_used: impl Fn(f64) -> bool,
    share: impl Fn(f64) -> f64,
) -> Option<Motors> {
    let outputs: Vec<usize> = (0..MAX_MOTORS)
        .filter_map(|i| table.column(&format!("{name}[{i}]")))
        .filter(|&column| table.rows().any(|(_, row)| is_used(row.get(column))))
        .collect();
    let mut track = Track::new();
    for (_, time, row) in timed(table, Stamp::Message) {
        let mut values = [0.0; MAX_MOTORS];
        for (value, &column) in values.iter_mut().zip(&outputs) {
            let command = share(row.get(column));
            *value = if command.is_finite() {
                command.clamp(0.0, 1.0)
            } else {
                0.0
            };
        }
        track.push(time, values);
    }
    let count = outputs.len();
    (count > 0).then_some(Motors { count, track })
}

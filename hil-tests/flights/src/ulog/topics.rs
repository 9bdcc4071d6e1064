//! Makes a recording of decoded topics.

use super::super::error::{Fault, Location};
use super::super::recording::{LogFormat, MAX_MOTORS, Motors, Recorded, Recording, Sensor};
use super::super::track::Track;
use super::table::{Row, Table};

/// The recording that a log's topics hold.
pub(super) fn recording(tables: &[Table]) -> Result<Recording, Fault> {
    let source = imu(tables)?;
    let attitude = most(tables, "vehicle_attitude");
    let attitude_setpoint = most(tables, "vehicle_attitude_setpoint");
    let rates_setpoint = most(tables, "vehicle_rates_setpoint");
    let thrust_setpoint = match thrust(attitude_setpoint)? {
        Some(track) => Some(track),
        None => thrust(rates_setpoint)?,
    };
    Ok(Recording {
        format: LogFormat::Ulog,
        gyro: source.gyro()?,
        accel: source.accel()?,
        mag: magnetometer(tables)?,
        motors: motors(tables)?,
        recorded: Recorded {
            attitude: quaternions(attitude, "q", Stamp::Sample)?,
            attitude_setpoint: quaternions(attitude_setpoint, "q_d", Stamp::Message)?,
            rates_setpoint: rates(rates_setpoint)?,
            thrust_setpoint,
            position: position(most(tables, "vehicle_local_position"))?,
        },
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

/// Which of a message's time stamps counts.
#[derive(Clone, Copy, PartialEq)]
enum Stamp {
    /// When it was published.
    Message,
    /// When its sensor was read, where the topic says it.
    Sample,
}

/// A fault of a message.
fn at(offset: usize, table: &Table, reason: &str) -> Fault {
    Fault::new(
        Location::Byte(offset as u64),
        format!("{}: {reason}", table.name()),
    )
}

/// The messages of a topic with their byte offset and time (ns).
fn timed<'a>(table: &'a Table, stamp: Stamp) -> Result<Vec<(usize, i64, Row<'a>)>, Fault> {
    /// Larger stamps are wrong, and would not be exact in what follows.
    const LATEST_US: f64 = 4e15;
    let sampled = table.column("timestamp_sample").filter(|&column| {
        let first = table.rows().next();
        stamp == Stamp::Sample && first.is_some_and(|(_, row)| row.get(column) > 0.0)
    });
    let mut timed: Vec<(usize, i64, Row)> = Vec::with_capacity(table.len());
    for (offset, row) in table.rows() {
        let column = sampled.or_else(|| table.column("timestamp"));
        let column = column.ok_or_else(|| at(offset, table, "has no time stamp"))?;
        let microseconds = row.get(column);
        if !(0.0..LATEST_US).contains(&microseconds) {
            let reason = format!("the time stamp {microseconds} is out of range");
            return Err(at(offset, table, &reason));
        }
        let time = microseconds as i64 * 1000;
        if let Some(&(_, last, _)) = timed.last()
            && time < last
        {
            let (time, last) = (time / 1000, last / 1000);
            let reason = format!("time goes back: {time} follows {last}");
            return Err(at(offset, table, &reason));
        }
        timed.push((offset, time, row));
    }
    Ok(timed)
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

    /// Number of messages.
    fn len(&self) -> usize {
        self.table.len()
    }

    /// The samples; one that does not move time on is a repetition.
    fn track(&self) -> Result<Track<3>, Fault> {
        /// What `sensor_combined` writes where a sensor had no sample yet.
        const INVALID: f64 = i32::MAX as f64;
        let mut track = Track::new();
        for (offset, time, row) in timed(self.table, Stamp::Sample)? {
            let relative = self.relative_us.map_or(0.0, |column| row.get(column));
            if relative.abs() >= INVALID {
                continue;
            }
            let mut value = row.pick(self.values);
            if let Some(column) = self.integrated_us {
                value = value.map(|integral| integral / (row.get(column) * 1e-6));
            }
            for component in value {
                self.sensor
                    .check(component)
                    .map_err(|reason| at(offset, self.table, &reason))?;
            }
            track.push(time + relative as i64 * 1000, value);
        }
        Ok(track)
    }
}

/// Where gyroscope and accelerometer are.
struct Imu<'a> {
    gyro: Axes<'a>,
    accel: Axes<'a>,
}

impl Imu<'_> {
    fn gyro(&self) -> Result<Track<3>, Fault> {
        self.gyro.track()
    }

    fn accel(&self) -> Result<Track<3>, Fault> {
        self.accel.track()
    }

    /// Samples of the slower of both.
    fn len(&self) -> usize {
        self.gyro.len().min(self.accel.len())
    }
}

/// The pair of gyroscope and accelerometer with most samples.
fn imu(tables: &[Table]) -> Result<Imu<'_>, Fault> {
    let gyros = most(tables, "sensor_gyro").and_then(|t| xyz(Sensor::Gyroscope, t));
    let accels = most(tables, "sensor_accel").and_then(|t| xyz(Sensor::Accelerometer, t));
    let has_gyro = gyros.is_some();
    let separate = gyros.zip(accels).map(|(gyro, accel)| Imu { gyro, accel });
    let candidates = [
        most(tables, "sensor_combined").and_then(combined),
        most(tables, "vehicle_imu").and_then(integrated),
        separate,
    ];
    let mut best: Option<Imu> = None;
    for candidate in candidates.into_iter().flatten() {
        if best
            .as_ref()
            .is_none_or(|best| candidate.len() > best.len())
        {
            best = Some(candidate);
        }
    }
    best.ok_or_else(|| {
        Fault::whole(if has_gyro {
            "has no accelerometer: none of sensor_combined, vehicle_imu, sensor_accel"
        } else {
            "has no gyroscope: none of sensor_combined, vehicle_imu, sensor_gyro"
        })
    })
}

/// The columns x, y, z of a topic.
fn xyz(sensor: Sensor, table: &Table) -> Option<Axes<'_>> {
    Some(Axes::plain(sensor, table, table.all(["x", "y", "z"])?))
}

/// Gyroscope and accelerometer of `sensor_combined`.
fn combined(table: &Table) -> Option<Imu<'_>> {
    let gyro = table.array("gyro_rad")?;
    let accel = table.array("accelerometer_m_s2")?;
    Some(Imu {
        gyro: Axes::plain(Sensor::Gyroscope, table, gyro),
        accel: Axes {
            relative_us: table.column("accelerometer_timestamp_relative"),
            ..Axes::plain(Sensor::Accelerometer, table, accel)
        },
    })
}

/// Gyroscope and accelerometer of `vehicle_imu`.
fn integrated(table: &Table) -> Option<Imu<'_>> {
    let axes = |sensor, values: &str, time: &str| {
        Some(Axes {
            integrated_us: Some(table.column(time)?),
            ..Axes::plain(sensor, table, table.array(values)?)
        })
    };
    Some(Imu {
        gyro: axes(Sensor::Gyroscope, "delta_angle", "delta_angle_dt")?,
        accel: axes(Sensor::Accelerometer, "delta_velocity", "delta_velocity_dt")?,
    })
}

/// The magnetometer, calibrated where the log has it so.
fn magnetometer(tables: &[Table]) -> Result<Option<Track<3>>, Fault> {
    let field = |table, relative_us| {
        Some(Axes {
            relative_us,
            ..Axes::plain(Sensor::Magnetometer, table, table.array("magnetometer_ga")?)
        })
    };
    let sources = [
        most(tables, "vehicle_magnetometer").and_then(|table| field(table, None)),
        most(tables, "sensor_combined")
            .and_then(|table| field(table, table.column("magnetometer_timestamp_relative"))),
        most(tables, "sensor_mag").and_then(|table| xyz(Sensor::Magnetometer, table)),
    ];
    for source in sources.into_iter().flatten() {
        let track = source.track()?;
        if !track.is_empty() {
            return Ok(Some(track));
        }
    }
    Ok(None)
}

/// The finite values of some columns.
fn finite<const N: usize>(
    table: &Table,
    stamp: Stamp,
    mut value: impl FnMut(Row) -> Option<[f64; N]>,
) -> Result<Option<Track<N>>, Fault> {
    let mut track = Track::new();
    for (_, time, row) in timed(table, stamp)? {
        if let Some(value) = value(row).filter(|v| v.iter().all(|c| c.is_finite())) {
            track.push(time, value);
        }
    }
    Ok((!track.is_empty()).then_some(track))
}

/// Unit quaternions, w x y z; older logs mark those that hold nothing.
fn quaternions(table: Option<&Table>, name: &str, stamp: Stamp) -> Result<Option<Track<4>>, Fault> {
    let Some((table, columns)) = table.and_then(|t| Some((t, t.array::<4>(name)?))) else {
        return Ok(None);
    };
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
fn rates(table: Option<&Table>) -> Result<Option<Track<3>>, Fault> {
    match table.and_then(|t| Some((t, t.all(["roll", "pitch", "yaw"])?))) {
        Some((table, columns)) => finite(table, Stamp::Message, |row| {
            let value = row.pick(columns);
            let sane = value.iter().all(|&v| Sensor::Gyroscope.check(v).is_ok());
            sane.then_some(value)
        }),
        None => Ok(None),
    }
}

/// Desired thrust: a scalar in older logs, later a vector that points down.
fn thrust(table: Option<&Table>) -> Result<Option<Track<1>>, Fault> {
    let column = |table: &Table| {
        let scalar = table.column("thrust").map(|column| (column, 1.0));
        scalar.or_else(|| Some((table.column("thrust_body[2]")?, -1.0)))
    };
    match table.and_then(|table| Some((table, column(table)?))) {
        Some((table, (column, sign))) => finite(table, Stamp::Message, |row| {
            Some([(row.get(column) * sign).clamp(0.0, 1.0)])
        }),
        None => Ok(None),
    }
}

/// Position and velocity where all of it is valid.
fn position(table: Option<&Table>) -> Result<Option<Track<6>>, Fault> {
    let found = table.and_then(|table| {
        let values = table.all(["x", "y", "z", "vx", "vy", "vz"])?;
        let valid = table.all(["xy_valid", "z_valid", "v_xy_valid", "v_z_valid"])?;
        Some((table, values, valid))
    });
    match found {
        Some((table, values, valid)) => finite(table, Stamp::Message, |row| {
            let all_valid = row.pick::<4>(valid).iter().all(|&flag| flag != 0.0);
            all_valid.then(|| row.pick(values))
        }),
        None => Ok(None),
    }
}

/// The motor commands.
fn motors(tables: &[Table]) -> Result<Option<Motors>, Fault> {
    for table in instances(tables, "actuator_motors") {
        let motors = commands(table, "control", f64::is_finite, |share| {
            if share.is_finite() { share } else { 0.0 }
        })?;
        if motors.is_some() {
            return Ok(motors);
        }
    }
    // A pulse in us; an output without any stays at 0. Others are no pulses.
    let is_pulse = |pulse: f64| (800.0..2200.0).contains(&pulse);
    for table in instances(tables, "actuator_outputs") {
        let columns: Vec<usize> = (0..MAX_MOTORS)
            .filter_map(|i| table.column(&format!("output[{i}]")))
            .collect();
        let is_pulse_or_idle = |(_, row): (usize, Row)| {
            let mut values = columns.iter().map(|&column| row.get(column));
            values.all(|value| value == 0.0 || is_pulse(value))
        };
        if !table.rows().all(is_pulse_or_idle) {
            continue;
        }
        let motors = commands(table, "output", is_pulse, |pulse| (pulse - 1000.0) / 1000.0)?;
        if motors.is_some() {
            return Ok(motors);
        }
    }
    Ok(None)
}

/// The commands of those of the first eight outputs that are ever used.
fn commands(
    table: &Table,
    name: &str,
    is_used: impl Fn(f64) -> bool,
    share: impl Fn(f64) -> f64,
) -> Result<Option<Motors>, Fault> {
    let outputs: Vec<usize> = (0..MAX_MOTORS)
        .filter_map(|i| table.column(&format!("{name}[{i}]")))
        .filter(|&column| table.rows().any(|(_, row)| is_used(row.get(column))))
        .collect();
    let mut track = Track::new();
    for (_, time, row) in timed(table, Stamp::Message)? {
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
    Ok((count > 0).then_some(Motors { count, track }))
}

//! Reads flights from columns of text.
//!
//! Whose columns they are is found by their names ([`dialects`]); further ones
//! are left out. Lines that are no samples are skipped and counted. A unit that
//! contradicts the samples refuses the log and names the option that helps.
//! Magnetometer and motors are taken where they change, since such logs hold
//! them between their own samples.

mod columns;
mod dialects;
mod encoding;

use csv::{ReaderBuilder, StringRecord};

use self::columns::Columns;
use self::dialects::Motor;
use self::encoding::decoded;
use super::super::error::{Fault, Location, quoted};
use super::super::recording::{LogFormat, MAX_MOTORS, Motors, Recording, Sensor, Vehicle};
use super::super::samples::Samples;
use super::super::skipped::Skipped;
use super::super::track::{SECOND_NS, Track};
use super::super::units::{self, COUNTS, Quantity, Raw, Unit, Units};
use chip_models::stimulus::STANDARD_GRAVITY;

/// Lines that may stand before the names of the columns, as settings do.
const MOST_PREAMBLE: usize = 500;

pub(super) use self::encoding::is_text as knows;

/// Reads a whole log; `told` are units that the user knows.
///
/// # Errors
/// Columns that are not known or incomplete, units that the samples contradict, no samples.
pub(super) fn read(bytes: &[u8], told: &Units) -> Result<Recording, Fault> {
    let (text, encoding) = decoded(bytes);
    let (columns, mut reader) = header(&text)?;
    let mut table = Table::default();
    let mut skipped = Skipped::default();
    let mut row = StringRecord::new();
    while reader.read_record(&mut row).unwrap_or(false) {
        let row = Row {
            line: row.position().map_or(1, csv::Position::line),
            cells: &row,
            columns: &columns,
        };
        match row.values() {
            Ok(Some(values)) => table.rows.push((row.line, values)),
            Ok(None) => {}
            Err(fault) => table.spoil(fault, &mut skipped),
        }
    }
    let mut recording = table.recording(&columns, told, skipped)?;
    recording
        .notes
        .splice(0..0, encoding.into_iter().chain(columns.note()));
    Ok(recording)
}

/// The columns by the first line that names them, and a reader of what follows.
fn header(text: &str) -> Result<(Columns, csv::Reader<&[u8]>), Fault> {
    let mut refusal = None;
    // A stray quotation mark in garbage would swallow all that follows.
    let start: String = text.chars().take(4096).collect();
    let is_quoted = start.contains('"');
    for delimiter in [b',', b';', b'\t'] {
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .quoting(is_quoted)
            .delimiter(delimiter)
            .from_reader(text.as_bytes());
        let mut row = StringRecord::new();
        for _ in 0..MOST_PREAMBLE {
            if !reader.read_record(&mut row).unwrap_or(false) {
                break;
            }
            let line = row.position().map_or(1, csv::Position::line);
            match Columns::of_header(&row) {
                Ok(columns) => return Ok((columns, reader)),
                Err(reason) if refusal.is_none() => {
                    refusal = Some(Fault::new(Location::Line(line), reason));
                }
                Err(_) => {}
            }
        }
    }
    Err(refusal.unwrap_or_else(|| Fault::whole("is empty")))
}

/// One line of the log.
struct Row<'a> {
    line: u64,
    cells: &'a StringRecord,
    columns: &'a Columns,
}

/// The numbers of one line, in the log's units.
struct Values {
    time: f64,
    gyro: [f64; 3],
    accel: [f64; 3],
    mag: Option<[f64; 3]>,
    motors: [f64; MAX_MOTORS],
}

impl Row<'_> {
    /// The numbers; `None` for a line that has no sample.
    fn values(&self) -> Result<Option<Values>, Fault> {
        let columns = self.columns;
        let sensors = columns.gyro.at.iter().chain(&columns.accel.at);
        if sensors.clone().all(|&column| self.text(column).is_empty()) && self.is_whole() {
            return Ok(None);
        }
        if !self.is_whole() {
            return Err(Fault::new(
                Location::Line(self.line),
                format!(
                    "lines of another number of columns than the header's {}",
                    columns.names.len()
                ),
            ));
        }
        let mut motors = [0.0; MAX_MOTORS];
        for (value, &column) in motors.iter_mut().zip(&columns.motors) {
            *value = self.number(column)?;
        }
        Ok(Some(Values {
            time: self.number(columns.time.at)?,
            gyro: self.three(columns.gyro.at)?,
            accel: self.three(columns.accel.at)?,
            mag: columns.mag.map(|mag| self.three(mag.at)).transpose()?,
            motors,
        }))
    }

    fn is_whole(&self) -> bool {
        self.cells.len() == self.columns.names.len()
    }

    /// A cell without the spaces around it.
    fn text(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default().trim()
    }

    /// A cell as a number, in the spelling of any country.
    fn number(&self, column: usize) -> Result<f64, Fault> {
        let text = self.text(column);
        let number = text.parse().or_else(|_| text.replacen(',', ".", 1).parse());
        number.map_err(|_| {
            let location = Location::Cell {
                line: self.line,
                column: self.columns.names[column].clone(),
            };
            let what = if text.is_empty() {
                "cells that are empty"
            } else {
                "cells that are no numbers"
            };
            Fault::new(location, what)
        })
    }

    fn three(&self, columns: [usize; 3]) -> Result<[f64; 3], Fault> {
        let [x, y, z] = columns;
        Ok([self.number(x)?, self.number(y)?, self.number(z)?])
    }
}

/// The lines that were read.
#[derive(Default)]
struct Table {
    rows: Vec<(u64, Values)>,
    spoilt: u64,
    first_spoilt: Option<Fault>,
}

impl Table {
    fn spoil(&mut self, fault: Fault, skipped: &mut Skipped) {
        self.spoilt += 1;
        self.first_spoilt.get_or_insert_with(|| fault.clone());
        skipped.fault(fault);
    }

    /// The recording, once each unit is known.
    fn recording(
        self,
        columns: &Columns,
        told: &Units,
        mut skipped: Skipped,
    ) -> Result<Recording, Fault> {
        if let Some(fault) = self.first_spoilt
            && self.spoilt > self.rows.len() as u64
        {
            return Err(Fault {
                reason: format!("most lines are no samples: {}", fault.reason),
                ..fault
            });
        }
        let mut notes = Vec::new();
        let times = times_ns(&self.rows, columns, told, &mut notes)?;
        let tracks = Tracks::of(&self.rows, &times);
        let scales = tracks.scales(columns, told, &mut notes)?;
        let dialect = columns.dialect;
        let mut take =
            |sensor, name: &str, of: &dyn Fn(&Values) -> Option<[f64; 3]>, scale: f64| {
                let mut samples = Samples::new(sensor, name);
                let mut before = None;
                for ((line, values), &time) in self.rows.iter().zip(&times) {
                    let Some(value) = of(values) else { continue };
                    let is_held =
                        sensor == Sensor::Magnetometer && before.replace(value) == Some(value);
                    if !is_held {
                        let value = value.map(|component| component * scale);
                        samples.take(Location::Line(*line), time, value, &mut skipped);
                    }
                }
                samples.finish()
            };
        let gyro = take(
            Sensor::Gyroscope,
            "gyroscope",
            &|row| Some(row.gyro),
            scales[0],
        )?;
        let accel = take(
            Sensor::Accelerometer,
            "accelerometer",
            &|row| Some(row.accel),
            scales[1],
        )?;
        let mag = take(
            Sensor::Magnetometer,
            "magnetometer",
            &|row| row.mag,
            scales[2],
        )?;
        let motors = motors(&self.rows, &times, columns, &mut skipped);
        Ok(Recording {
            format: LogFormat::Csv,
            dialect: format!("CSV, columns of {}", dialect.name),
            vehicle: Vehicle::default(),
            frame: dialect.frame,
            gyro,
            accel,
            mag: (!mag.is_empty()).then_some(mag),
            motors,
            skipped,
            notes,
            ..Recording::default()
        })
    }
}

/// The times of all lines, in ns.
fn times_ns(
    rows: &[(u64, Values)],
    columns: &Columns,
    told: &Units,
    notes: &mut Vec<String>,
) -> Result<Vec<i64>, Fault> {
    /// Fewer lines show no unit.
    const ENOUGH: usize = 100;
    let mut periods: Vec<f64> = rows
        .windows(2)
        .map(|two| two[1].1.time - two[0].1.time)
        .collect();
    periods.retain(|period| *period > 0.0);
    periods.sort_by(f64::total_cmp);
    let period = periods.get(periods.len() / 2).copied().unwrap_or_default();
    let seen = units::of_time(period).filter(|_| rows.len() >= ENOUGH);
    let told = told.of(Quantity::Time);
    let unit = match (told, columns.time.unit, seen) {
        (Some(told), ..) => told,
        (None, Some(unit), Some(seen)) if seen != unit && !units::is_period(period, unit) => {
            let name = &columns.names[columns.time.at];
            return Err(contradicted(name, "time", unit, seen));
        }
        (None, Some(unit), _) => unit,
        (None, None, seen) => seen.unwrap_or(units::S),
    };
    if Some(unit) != columns.time.unit {
        notes.push(format!("time taken as {}", unit.name));
    }
    // Counted from the first: stamps in ns since 1970 are good to a quarter of a microsecond.
    let ns = unit.factor * SECOND_NS as f64;
    let first = rows.first().map_or(0.0, |(_, row)| row.time);
    Ok(rows
        .iter()
        .map(|(_, row)| ((row.time - first) * ns).round() as i64)
        .collect())
}

/// A unit that the samples contradict.
fn contradicted(column: &str, what: &str, taken_for: Unit, seen: Unit) -> Fault {
    Fault::new(
        Location::Line(1),
        format!(
            "its {what} (column {column}) looks like {}, not {}: add --units {}",
            seen.name, taken_for.name, seen.name
        ),
    )
}

/// The samples in the log's units.
struct Tracks {
    gyro: Track<3>,
    accel: Track<3>,
    mag: Track<3>,
}

impl Tracks {
    fn of(rows: &[(u64, Values)], times: &[i64]) -> Self {
        let (mut gyro, mut accel, mut mag) = (Track::new(), Track::new(), Track::new());
        for ((_, row), &time) in rows.iter().zip(times) {
            gyro.push(time, row.gyro);
            accel.push(time, row.accel);
            if let Some(field) = row.mag {
                mag.push(time, field);
            }
        }
        Self { gyro, accel, mag }
    }

    /// By what gyroscope, accelerometer and magnetometer are multiplied.
    fn scales(
        &self,
        columns: &Columns,
        told: &Units,
        notes: &mut Vec<String>,
    ) -> Result<[f64; 3], Fault> {
        let raw = Raw {
            gyro: &self.gyro,
            accel: &self.accel,
        };
        let sensors = [
            (
                Sensor::Gyroscope,
                "gyroscope",
                Some(columns.gyro),
                &self.gyro,
            ),
            (
                Sensor::Accelerometer,
                "accelerometer",
                Some(columns.accel),
                &self.accel,
            ),
            (Sensor::Magnetometer, "magnetometer", columns.mag, &self.mag),
        ];
        let mut scales = [1.0; 3];
        for (scale, (sensor, what, group, track)) in scales.iter_mut().zip(sensors) {
            let Some(group) = group else { continue };
            let told = told.of(Quantity::Of(sensor));
            let unit = told.unwrap_or(group.unit);
            *scale = match unit {
                COUNTS => STANDARD_GRAVITY / units::counts_of_1_g(track),
                unit => unit.factor,
            };
            if unit.name != sensor.unit() {
                notes.push(format!("{what} converted from {}", unit.name));
            }
            if told.is_some() || unit == COUNTS {
                continue;
            }
            if let Some(seen) = raw.looks_like(sensor, track, unit) {
                let name = &columns.names[group.at[0]];
                return Err(contradicted(name, what, unit, seen));
            }
        }
        Ok(scales)
    }
}

/// The motor commands as shares of full scale.
fn motors(
    rows: &[(u64, Values)],
    times: &[i64],
    columns: &Columns,
    skipped: &mut Skipped,
) -> Option<Motors> {
    let count = columns.motors.len();
    let all = rows
        .iter()
        .flat_map(|(_, row)| row.motors.iter().take(count));
    let most = all.copied().fold(0.0, f64::max);
    let [low, high] = match columns.dialect.motors.1 {
        Motor::Share => [0.0, 1.0],
        Motor::Of65535 => [0.0, 65535.0],
        // Pulses, or what digital controllers count.
        Motor::Betaflight if most > 2000.0 => [48.0, 2047.0],
        Motor::Betaflight => [1000.0, 2000.0],
    };
    let mut track = Track::new();
    for ((line, row), &time) in rows.iter().zip(times) {
        let mut shares = row.motors.map(|command| (command - low) / (high - low));
        shares[count..].fill(0.0);
        let is_command = |share: &f64| match columns.dialect.motors.1 {
            Motor::Share => (-0.05..=1.05).contains(share),
            Motor::Of65535 | Motor::Betaflight => share.is_finite(),
        };
        if !shares.iter().all(is_command) {
            let place = Location::Cell {
                line: *line,
                column: quoted(&columns.names[columns.motors[0]]),
            };
            skipped.add(place, "motor commands that are not in 0..1 of full scale");
            continue;
        }
        track.push_change(time, shares.map(|share| share.clamp(0.0, 1.0)));
    }
    (count > 0).then_some(Motors { count, track })
}

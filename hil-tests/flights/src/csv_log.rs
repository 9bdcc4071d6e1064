//! Reads flights from columns of text.
//!
//! The header names the columns: `t_us` (whole microseconds, strictly rising),
//! `gx,gy,gz` (rad/s), `ax,ay,az` (m/s2), optionally `mx,my,mz` (gauss) and
//! `m1` to `mN` (motor commands, 0..1 of full scale, N up to 8), in any order.
//! Magnetometer and motors are taken where they change, since such logs hold
//! them between their own samples.

use csv::{ReaderBuilder, StringRecord};

use super::error::{Fault, Location, quoted};
use super::recording::{LogFormat, MAX_MOTORS, Motors, Recorded, Recording, Sensor};
use super::track::Track;

const EXPECTED: &str = "t_us,gx,gy,gz,ax,ay,az[,mx,my,mz][,m1..m8]";

/// Reads a whole log.
///
/// # Errors
/// The first line, and column where one is to blame, that cannot be read.
pub(super) fn read(bytes: &[u8]) -> Result<Recording, Fault> {
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .quoting(false)
        .from_reader(bytes);
    let mut row = StringRecord::new();
    if !next_row(&mut reader, &mut row)? {
        return Err(Fault::whole("is empty"));
    }
    let columns = Columns::of_header(&row)?;
    let mut samples = Samples::default();
    while next_row(&mut reader, &mut row)? {
        let row = Row {
            line: line_of(&row),
            cells: &row,
            columns: &columns,
        };
        samples.add(&row)?;
    }
    if bytes.last() != Some(&b'\n') {
        let reason = "has no line end: the file looks cut off";
        return Err(Fault::new(Location::Line(line_of(&row)), reason));
    }
    Ok(samples.into_recording(&columns))
}

/// Reads the next row; false at the end.
fn next_row(reader: &mut csv::Reader<&[u8]>, row: &mut StringRecord) -> Result<bool, Fault> {
    reader.read_record(row).map_err(|error| {
        let line = error.position().map_or(1, csv::Position::line);
        let reason = match error.kind() {
            csv::ErrorKind::Utf8 { .. } => "is not text (UTF-8)".to_owned(),
            _ => error.to_string(),
        };
        Fault::new(Location::Line(line), reason)
    })
}

/// The line a row started on.
fn line_of(row: &StringRecord) -> u64 {
    row.position().map_or(1, csv::Position::line)
}

/// Which column holds what.
struct Columns {
    names: Vec<String>,
    time: usize,
    gyro: [usize; 3],
    accel: [usize; 3],
    mag: Option<[usize; 3]>,
    motors: Vec<usize>,
}

impl Columns {
    /// Finds the columns by their names.
    fn of_header(header: &StringRecord) -> Result<Self, Fault> {
        let names: Vec<String> = (header.iter()).map(|name| name.trim().to_owned()).collect();
        check_names(&names)?;
        let find = |name: &str| names.iter().position(|n| n == name);
        let group = |axes: [&str; 3]| -> Option<[usize; 3]> {
            let [x, y, z] = axes.map(find);
            Some([x?, y?, z?])
        };
        let needed = |found: Option<[usize; 3]>, what: &str| {
            found.ok_or_else(|| fault_in_header(format!("has no {what}, expected {EXPECTED}")))
        };
        let time = find("t_us")
            .ok_or_else(|| fault_in_header(format!("has no column t_us, expected {EXPECTED}")))?;
        let mag = group(["mx", "my", "mz"]);
        if mag.is_none() && ["mx", "my", "mz"].iter().any(|name| find(name).is_some()) {
            return Err(fault_in_header("has only a part of the columns mx,my,mz"));
        }
        let motors: Vec<usize> = (1..=MAX_MOTORS)
            .map_while(|number| find(&format!("m{number}")))
            .collect();
        if motors.len() < names.iter().filter(|name| is_motor(name)).count() {
            return Err(fault_in_header(format!(
                "has no column m{}",
                motors.len() + 1
            )));
        }
        Ok(Self {
            time,
            gyro: needed(group(["gx", "gy", "gz"]), "gyroscope (columns gx,gy,gz)")?,
            accel: needed(
                group(["ax", "ay", "az"]),
                "accelerometer (columns ax,ay,az)",
            )?,
            mag,
            motors,
            names,
        })
    }
}

/// A fault of the header line.
fn fault_in_header(reason: impl Into<String>) -> Fault {
    Fault::new(Location::Line(1), reason)
}

/// Refuses names that are unknown or given twice.
fn check_names(names: &[String]) -> Result<(), Fault> {
    const SENSORS: [&str; 10] = ["t_us", "gx", "gy", "gz", "ax", "ay", "az", "mx", "my", "mz"];
    for (index, name) in names.iter().enumerate() {
        let problem = if !SENSORS.contains(&name.as_str()) && !is_motor(name) {
            "unknown"
        } else if names[..index].contains(name) {
            "repeated"
        } else {
            continue;
        };
        return Err(fault_in_header(format!(
            "column {} is the {problem} name {}, expected {EXPECTED}",
            index + 1,
            quoted(name)
        )));
    }
    Ok(())
}

/// True for `m1` to `m8`.
fn is_motor(name: &str) -> bool {
    (1..=MAX_MOTORS).any(|number| name == format!("m{number}"))
}

/// One line of the log.
struct Row<'a> {
    line: u64,
    cells: &'a StringRecord,
    columns: &'a Columns,
}

impl Row<'_> {
    /// A fault of one cell.
    fn fault(&self, column: usize, reason: impl Into<String>) -> Fault {
        let place = Location::Cell {
            line: self.line,
            column: self.columns.names.get(column).cloned().unwrap_or_default(),
        };
        Fault::new(place, reason)
    }

    /// Refuses a line with missing or surplus cells.
    fn check_width(&self) -> Result<(), Fault> {
        let (have, want) = (self.cells.len(), self.columns.names.len());
        if have == want {
            return Ok(());
        }
        let reason = format!("has {have} columns, the header has {want}");
        Err(Fault::new(Location::Line(self.line), reason))
    }

    /// A cell without the blanks around it; the reader's own trimming copies every row twice.
    fn text(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default().trim()
    }

    /// The time stamp in ns.
    fn time_ns(&self) -> Result<i64, Fault> {
        let column = self.columns.time;
        let text = self.text(column);
        text.parse::<i64>()
            .ok()
            .and_then(|us| us.checked_mul(1000))
            .ok_or_else(|| {
                let text = quoted(text);
                self.fault(
                    column,
                    format!("{text} is not a whole number of microseconds"),
                )
            })
    }

    /// A cell as a number.
    fn number(&self, column: usize) -> Result<f64, Fault> {
        let text = self.text(column);
        text.parse()
            .map_err(|_| self.fault(column, format!("{} is not a number", quoted(text))))
    }

    /// Three cells of a sensor.
    fn sensor(&self, sensor: Sensor, columns: [usize; 3]) -> Result<[f64; 3], Fault> {
        let mut values = [0.0; 3];
        for (value, column) in values.iter_mut().zip(columns) {
            *value = self.number(column)?;
            sensor
                .check(*value)
                .map_err(|reason| self.fault(column, reason))?;
        }
        Ok(values)
    }

    /// The motor commands.
    fn motors(&self) -> Result<[f64; MAX_MOTORS], Fault> {
        let mut values = [0.0; MAX_MOTORS];
        for (value, &column) in values.iter_mut().zip(&self.columns.motors) {
            *value = self.number(column)?;
            if !(0.0..=1.0).contains(value) {
                return Err(self.fault(column, format!("{value} is not in 0..1 of full scale")));
            }
        }
        Ok(values)
    }
}

/// The samples read so far.
#[derive(Default)]
struct Samples {
    gyro: Track<3>,
    accel: Track<3>,
    mag: Track<3>,
    motors: Track<MAX_MOTORS>,
}

impl Samples {
    /// Takes in one line.
    fn add(&mut self, row: &Row) -> Result<(), Fault> {
        row.check_width()?;
        let time = row.time_ns()?;
        if let Some(last) = self.gyro.last_time_ns()
            && time <= last
        {
            return Err(row.fault(
                row.columns.time,
                format!("time goes back: {} follows {}", time / 1000, last / 1000),
            ));
        }
        let Columns {
            gyro, accel, mag, ..
        } = row.columns;
        self.gyro.push(time, row.sensor(Sensor::Gyroscope, *gyro)?);
        self.accel
            .push(time, row.sensor(Sensor::Accelerometer, *accel)?);
        if let Some(mag) = mag {
            self.mag
                .push_change(time, row.sensor(Sensor::Magnetometer, *mag)?);
        }
        self.motors.push_change(time, row.motors()?);
        Ok(())
    }

    /// All of it.
    fn into_recording(self, columns: &Columns) -> Recording {
        let count = columns.motors.len();
        Recording {
            format: LogFormat::Csv,
            gyro: self.gyro,
            accel: self.accel,
            mag: columns.mag.map(|_| self.mag),
            motors: (count > 0).then_some(Motors {
                count,
                track: self.motors,
            }),
            recorded: Recorded::default(),
        }
    }
}

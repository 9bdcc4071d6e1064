//! The messages of one topic instance, as columns of numbers.

use px4_ulog::stream_parser::model::{FlattenedField, FlattenedFieldType};
use px4_ulog::stream_parser::{DataMessage, LittleEndianParser};

use super::super::super::track::Track;

/// A topic and which of its fields are kept.
pub(super) struct Topic {
    /// Name in the log.
    pub(super) name: &'static str,
    /// Names of fields; an array is named without its brackets.
    fields: &'static [&'static str],
}

/// A topic and its fields.
const fn topic(name: &'static str, fields: &'static [&'static str]) -> Topic {
    Topic { name, fields }
}

/// All that a flight is made of.
pub(super) static TOPICS: [Topic; 15] = [
    topic(
        "sensor_combined",
        &[
            "timestamp",
            "gyro_rad",
            "accelerometer_timestamp_relative",
            "accelerometer_m_s2",
            "magnetometer_timestamp_relative",
            "magnetometer_ga",
        ],
    ),
    topic(
        "vehicle_imu",
        &[
            "timestamp",
            "timestamp_sample",
            "delta_angle",
            "delta_angle_dt",
            "delta_velocity",
            "delta_velocity_dt",
        ],
    ),
    topic(
        "sensor_gyro",
        &["timestamp", "timestamp_sample", "x", "y", "z"],
    ),
    topic(
        "sensor_accel",
        &["timestamp", "timestamp_sample", "x", "y", "z"],
    ),
    topic(
        "sensor_mag",
        &["timestamp", "timestamp_sample", "x", "y", "z"],
    ),
    topic(
        "vehicle_magnetometer",
        &["timestamp", "timestamp_sample", "magnetometer_ga"],
    ),
    topic("vehicle_attitude", &["timestamp", "timestamp_sample", "q"]),
    topic(
        "vehicle_attitude_setpoint",
        &["timestamp", "q_d", "q_d_valid", "thrust", "thrust_body"],
    ),
    topic(
        "vehicle_rates_setpoint",
        &["timestamp", "roll", "pitch", "yaw", "thrust", "thrust_body"],
    ),
    topic("actuator_motors", &["timestamp", "control"]),
    topic("actuator_outputs", &["timestamp", "noutputs", "output"]),
    topic(
        "vehicle_local_position",
        &[
            "timestamp",
            "x",
            "y",
            "z",
            "vx",
            "vy",
            "vz",
            "xy_valid",
            "z_valid",
            "v_xy_valid",
            "v_z_valid",
        ],
    ),
    topic(
        "vehicle_status",
        &[
            "timestamp",
            "arming_state",
            "vehicle_type",
            "is_rotary_wing",
            "is_vtol",
        ],
    ),
    topic("actuator_armed", &["timestamp", "armed"]),
    topic("vehicle_land_detected", &["timestamp", "landed"]),
];

/// All messages of one instance of a topic.
pub(super) struct Table {
    topic: &'static Topic,
    /// Which of several instances of the topic.
    pub(super) instance: u8,
    columns: Vec<FlattenedField>,
    offsets: Vec<usize>,
    /// One row of `columns.len()` values after the other.
    values: Vec<f64>,
}

impl Table {
    /// An empty table for messages like this one.
    pub(super) fn new(topic: &'static Topic, message: &DataMessage) -> Self {
        let kept = |name: &str| {
            let base = name.split('[').next().unwrap_or_default();
            topic.fields.contains(&base)
        };
        Self {
            topic,
            instance: message.multi_id.value(),
            columns: message
                .flattened_format
                .field_iter()
                .filter(|field| kept(&field.flattened_field_name))
                .cloned()
                .collect(),
            offsets: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Appends a message that starts at a byte offset of the log.
    pub(super) fn push(&mut self, offset: usize, message: &DataMessage) {
        self.offsets.push(offset);
        for column in &self.columns {
            self.values.push(number(column, message.data));
        }
    }

    /// Name of the topic.
    pub(super) fn name(&self) -> &'static str {
        self.topic.name
    }

    /// Number of messages.
    pub(super) fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Where in a row a field is.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        self.columns
            .iter()
            .position(|field| field.flattened_field_name == name)
    }

    /// Where in a row the elements of an array are.
    pub(super) fn array<const N: usize>(&self, name: &str) -> Option<[usize; N]> {
        self.all(std::array::from_fn(|i| format!("{name}[{i}]")))
    }

    /// Where in a row several fields are; `None` unless all are there.
    pub(super) fn all<const N: usize, S: AsRef<str>>(&self, names: [S; N]) -> Option<[usize; N]> {
        let found = names.map(|name| self.column(name.as_ref()));
        let complete = found.iter().all(Option::is_some);
        complete.then(|| found.map(Option::unwrap_or_default))
    }

    /// Byte offsets and values of all messages.
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, Row<'_>)> {
        self.offsets.iter().copied().enumerate().map(|(i, offset)| {
            let width = self.columns.len();
            let values = self.values.get(i * width..(i + 1) * width);
            (offset, Row(values.unwrap_or_default()))
        })
    }
}

/// The values of one message.
#[derive(Clone, Copy)]
pub(super) struct Row<'a>(&'a [f64]);

impl Row<'_> {
    /// The value of a column.
    pub(super) fn get(self, column: usize) -> f64 {
        self.0.get(column).copied().unwrap_or(f64::NAN)
    }

    /// The values of several columns.
    pub(super) fn pick<const N: usize>(self, columns: [usize; N]) -> [f64; N] {
        columns.map(|column| self.get(column))
    }
}

/// Decodes one field; whole numbers are exact up to 2^53.
fn number(field: &FlattenedField, data: &[u8]) -> f64 {
    let Some(data) = data.get(usize::from(field.offset)..) else {
        return f64::NAN;
    };
    match field.field_type {
        FlattenedFieldType::Int8 => i8::parse(data).into(),
        FlattenedFieldType::UInt8 | FlattenedFieldType::Char => u8::parse(data).into(),
        FlattenedFieldType::Int16 => i16::parse(data).into(),
        FlattenedFieldType::UInt16 => u16::parse(data).into(),
        FlattenedFieldType::Int32 => i32::parse(data).into(),
        FlattenedFieldType::UInt32 => u32::parse(data).into(),
        FlattenedFieldType::Int64 => i64::parse(data) as f64,
        FlattenedFieldType::UInt64 => u64::parse(data) as f64,
        FlattenedFieldType::Float => f32::parse(data).into(),
        FlattenedFieldType::Double => f64::parse(data),
        FlattenedFieldType::Bool => f64::from(u8::from(bool::parse(data))),
    }
}

/// Which of a message's time stamps counts.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Stamp {
    /// When it was published.
    Message,
    /// When its sensor was read, where the topic says it.
    Sample,
}

/// The messages of a topic with their byte offset and time (ns), those without a time left out.
pub(super) fn timed<'a>(
    table: &'a Table,
    stamp: Stamp,
) -> impl Iterator<Item = (usize, i64, Row<'a>)> + use<'a> {
    /// Larger stamps are wrong, and would not be exact in what follows.
    const LATEST_US: f64 = 4e15;
    let sampled = table.column("timestamp_sample").filter(|&column| {
        let first = table.rows().next();
        stamp == Stamp::Sample && first.is_some_and(|(_, row)| row.get(column) > 0.0)
    });
    let column = sampled.or_else(|| table.column("timestamp"));
    let time_us = move |row: Row| column.map(|column| row.get(column));
    table.rows().filter_map(move |(offset, row)| {
        let time_us = time_us(row).filter(|us| (0.0..LATEST_US).contains(us))?;
        Some((offset, time_us as i64 * 1000, row))
    })
}

/// The finite values of some columns.
pub(super) fn finite<const N: usize>(
    table: &Table,
    stamp: Stamp,
    mut value: impl FnMut(Row) -> Option<[f64; N]>,
) -> Option<Track<N>> {
    let mut track = Track::new();
    for (_, time, row) in timed(table, stamp) {
        if let Some(value) = value(row).filter(|v| v.iter().all(|c| c.is_finite())) {
            track.push(time, value);
        }
    }
    (!track.is_empty()).then_some(track)
}

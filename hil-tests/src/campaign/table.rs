//! `flights.parquet`: a row for every flight, with all that is known of it.
//!
//! Columns that may have no value are null there. `per_second` is a list: runs of each second.
//! The same flights give the same bytes: rows are in the order of sorties, and nothing of the day
//! or the machine is written.

use std::sync::Arc;

use anyhow::{Context, Result};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use super::journal::{Landed, Records};
use crate::closed_loop::report::FlightReport;

/// The values of a column, a row each.
enum Column {
    Text(Vec<Option<String>>),
    Number(Vec<Option<f64>>),
    Whole(Vec<Option<i64>>),
    Truth(Vec<bool>),
    Wholes(Vec<Vec<i32>>),
}

/// The whole file.
///
/// # Errors
/// None in practice: nothing is written but memory.
pub fn parquet(records: &Records) -> Result<Vec<u8>> {
    let flights: Vec<&Landed> = records.flights.values().collect();
    let columns = columns(&flights);
    let fields = columns
        .iter()
        .map(|(name, column)| Ok(Arc::new(column.field(name)?)));
    let fields = fields.collect::<Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("flight")
        .with_fields(fields)
        .build()?;
    let stamp = records.stamp.clone();
    let origin = stamp.map_or(String::new(), |stamp| {
        format!("{} {}", stamp.plan, stamp.sources)
    });
    let properties =
        WriterProperties::builder().set_created_by(format!("reflex campaign {origin}"));
    let mut bytes = Vec::new();
    let properties = Arc::new(properties.build());
    let mut file = SerializedFileWriter::new(&mut bytes, Arc::new(schema), properties)?;
    let mut rows = file.next_row_group()?;
    for (_, column) in &columns {
        column.write(&mut rows)?;
    }
    rows.close()?;
    file.close()?;
    Ok(bytes)
}

fn columns(flights: &[&Landed]) -> Vec<(String, Column)> {
    let mut columns = job_columns(flights);
    columns.extend(report_columns(flights));
    columns.extend(axis_columns(flights));
    columns.extend(control_columns(flights));
    columns
}

fn job_columns(flights: &[&Landed]) -> Vec<(String, Column)> {
    let text = |of: &dyn Fn(&Landed) -> String| {
        Column::Text(flights.iter().map(|landed| Some(of(landed))).collect())
    };
    let report = |of: fn(&FlightReport) -> &String| text(&|landed| of(&landed.report).clone());
    let whole = |of: &dyn Fn(&Landed) -> Option<u64>| {
        Column::Whole(
            flights
                .iter()
                .map(|landed| of(landed).map(|it| it as i64))
                .collect(),
        )
    };
    named([
        ("tier", text(&|landed| landed.report.tier.to_string())),
        ("airframe", report(|report| &report.airframe)),
        ("logic", report(|report| &report.logic)),
        ("environment", report(|report| &report.environment)),
        ("mission", report(|report| &report.mission)),
        ("role", text(&|landed| landed.job.sortie.role.to_string())),
        ("policy", report(|report| &report.policy)),
        ("seed", whole(&|landed| Some(landed.job.sortie.seed.into()))),
        (
            "planned_s",
            whole(&|landed| Some(landed.job.sortie.duration_s.into())),
        ),
        ("period_us", whole(&|landed| landed.job.period_us)),
        (
            "clock_mhz",
            whole(&|landed| Some(landed.report.clock_mhz.into())),
        ),
        ("digest", report(|report| &report.digest)),
    ])
}

fn report_columns(flights: &[&Landed]) -> Vec<(String, Column)> {
    let number = |of: fn(&FlightReport) -> Option<f64>| {
        Column::Number(flights.iter().map(|landed| of(&landed.report)).collect())
    };
    let what = |landed: &&Landed| landed.report.crash.as_ref().map(|crash| crash.what.clone());
    named([
        ("duration_s", number(|report| Some(report.duration_s))),
        ("scored_from_s", number(|report| report.scored_from_s)),
        (
            "crashed",
            Column::Truth(flights.iter().map(|landed| landed.report.crashed).collect()),
        ),
        ("crash", Column::Text(flights.iter().map(what).collect())),
        (
            "crash_s",
            number(|report| report.crash.as_ref().map(|crash| crash.at_s)),
        ),
        (
            "roll_error_deg",
            number(|report| report.attitude_error_deg.roll),
        ),
        (
            "pitch_error_deg",
            number(|report| report.attitude_error_deg.pitch),
        ),
        (
            "yaw_error_deg",
            number(|report| report.attitude_error_deg.yaw),
        ),
        ("turning_rad_s", number(|report| report.turning_rad_s)),
        ("bandwidth", number(|report| Some(report.bandwidth))),
        ("position_error_m", number(|report| report.position_error_m)),
        ("asked_rate_hz", number(|report| report.rate_hz)),
        ("rate_hz", number(|report| report.control.rate_hz)),
        (
            "unchanged_share",
            number(|report| report.control.unchanged_share),
        ),
        (
            "busy_fraction",
            number(|report| report.cpu.map(|cpu| cpu.busy_fraction)),
        ),
        ("energy_j", number(|report| Some(report.energy_j))),
        (
            "energy_per_minute_j",
            number(|report| report.energy_per_minute_j),
        ),
        ("flight_time_s", number(|report| report.flight_time_s)),
        ("wind_m_s", number(|report| report.wind_m_s)),
    ])
}

/// Where and how a crash was, an axis a column.
fn axis_columns(flights: &[&Landed]) -> Vec<(String, Column)> {
    let mut columns = Vec::new();
    for (axis, name) in ["north_m", "east_m", "down_m"].into_iter().enumerate() {
        columns.push((
            format!("crash_{name}"),
            at_crash(flights, |crash| crash.position_m[axis]),
        ));
        let name = format!("crash_{name}_s");
        columns.push((name, at_crash(flights, |crash| crash.velocity_m_s[axis])));
    }
    for (axis, name) in ["roll", "pitch", "yaw"].into_iter().enumerate() {
        let name = format!("crash_{name}_deg");
        columns.push((name, at_crash(flights, |crash| crash.attitude_deg[axis])));
    }
    columns
}

fn at_crash(
    flights: &[&Landed],
    of: impl Fn(&crate::closed_loop::report::CrashReport) -> f64,
) -> Column {
    let values = flights
        .iter()
        .map(|landed| landed.report.crash.as_ref().map(&of));
    Column::Number(values.collect())
}

fn control_columns(flights: &[&Landed]) -> Vec<(String, Column)> {
    let runs = flights
        .iter()
        .map(|landed| Some(landed.report.control.runs as i64));
    let mut columns = named([("runs", Column::Whole(runs.collect()))]);
    let reasons = crate::scoring::ByReason::<u64>::default();
    for (place, (name, _)) in reasons.named().iter().enumerate() {
        let of = |landed: &&Landed| {
            let named = landed.report.control.by_reason.named();
            named.get(place).map(|(_, count)| **count as i64)
        };
        columns.push((
            format!("runs_{name}"),
            Column::Whole(flights.iter().map(of).collect()),
        ));
    }
    let seconds = |landed: &&Landed| {
        let runs = landed.report.control.per_second.iter();
        runs.map(|runs| i32::try_from(*runs).unwrap_or(i32::MAX))
            .collect()
    };
    let seconds = Column::Wholes(flights.iter().map(seconds).collect());
    columns.push(("per_second".to_owned(), seconds));
    columns
}

fn named<const N: usize>(columns: [(&str, Column); N]) -> Vec<(String, Column)> {
    columns
        .into_iter()
        .map(|(name, column)| (name.to_owned(), column))
        .collect()
}

impl Column {
    fn field(&self, name: &str) -> Result<Type> {
        let (physical, repetition) = match self {
            Self::Text(_) => (Physical::BYTE_ARRAY, Repetition::OPTIONAL),
            Self::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL),
            Self::Whole(_) => (Physical::INT64, Repetition::OPTIONAL),
            Self::Truth(_) => (Physical::BOOLEAN, Repetition::REQUIRED),
            Self::Wholes(_) => (Physical::INT32, Repetition::REPEATED),
        };
        let mut field = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        if matches!(self, Self::Text(_)) {
            field = field.with_logical_type(Some(LogicalType::String));
        }
        Ok(field.build()?)
    }

    fn write(&self, rows: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>) -> Result<()> {
        let mut column = rows.next_column()?.context("the schema has this column")?;
        match self {
            Self::Text(rows) => {
                let bytes = |text: &String| ByteArray::from(text.as_str());
                let (values, levels) = optional(rows.iter().map(|row| row.as_ref().map(bytes)));
                let typed = column.typed::<ByteArrayType>();
                typed.write_batch(&values, Some(&levels), None)?;
            }
            Self::Number(rows) => {
                let (values, levels) = optional(rows.iter().copied());
                let typed = column.typed::<DoubleType>();
                typed.write_batch(&values, Some(&levels), None)?;
            }
            Self::Whole(rows) => {
                let (values, levels) = optional(rows.iter().copied());
                let typed = column.typed::<Int64Type>();
                typed.write_batch(&values, Some(&levels), None)?;
            }
            Self::Truth(rows) => {
                column.typed::<BoolType>().write_batch(rows, None, None)?;
            }
            Self::Wholes(rows) => {
                let (values, [defined, repeated]) = lists(rows);
                let typed = column.typed::<Int32Type>();
                typed.write_batch(&values, Some(&defined), Some(&repeated))?;
            }
        }
        Ok(column.close()?)
    }
}

/// The values that there are, and for each row whether it has one.
fn optional<T>(rows: impl Iterator<Item = Option<T>>) -> (Vec<T>, Vec<i16>) {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    for row in rows {
        levels.push(i16::from(row.is_some()));
        values.extend(row);
    }
    (values, levels)
}

/// All values of all lists, with the levels that Parquet keeps: defined or not, in the same list or not.
fn lists(rows: &[Vec<i32>]) -> (Vec<i32>, [Vec<i16>; 2]) {
    let (mut values, mut defined, mut repeated) = (Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        if row.is_empty() {
            defined.push(0);
            repeated.push(0);
        }
        for (place, value) in row.iter().enumerate() {
            values.push(*value);
            defined.push(1);
            repeated.push(i16::from(place > 0));
        }
    }
    (values, [defined, repeated])
}

//! Settings in a report: by their options' names, with their units.

use reflex::sensors::Input;
use reflex::settings::{Declared, Policy, Settings};
use reflex_settings::{Kind, Setting, Value, Written};
use schemars::{Schema, SchemaGenerator, json_schema};
use serde::Serializer;
use serde::ser::SerializeMap;

/// The name of a setting in a report: that of its option, with the unit where there is one.
#[must_use]
pub fn report_name(setting: &Setting) -> String {
    let [option, _] = setting.option.unwrap_or([setting.name; 2]);
    let name = option.replace('-', "_");
    match setting.unit {
        "" => name,
        unit => format!("{name}_{}", unit.to_lowercase()),
    }
}

/// A number as it was written, without the digits that its storage adds; NaN where it is no number.
#[must_use]
pub fn number(setting: &'static Setting, value: Value) -> f64 {
    let text = Written(setting, value).to_string();
    text.parse().unwrap_or(f64::NAN)
}

/// Writes each setting by its name.
///
/// Null: a word in place of a number, and under reactive control a setting that only periodic
/// control has.
pub(super) fn named<S: Serializer>(settings: &Settings, to: S) -> Result<S::Ok, S::Error> {
    let mut map = to.serialize_map(None)?;
    for (setting, value) in settings.values() {
        let name = report_name(setting);
        let absent =
            setting.policy == Some(Policy::Periodic) && settings.policy != Policy::Periodic;
        match (setting.kind, value) {
            _ if absent => map.serialize_entry(&name, &None::<f64>)?,
            (Kind::WordOrSpan(..), Value::Word(_)) => map.serialize_entry(&name, &None::<f64>)?,
            (Kind::Count(_), Value::Number(count)) => {
                map.serialize_entry(&name, &(count as u64))?;
            }
            (_, Value::Number(_)) => map.serialize_entry(&name, &number(setting, value))?,
            (_, Value::Inputs(inputs)) => {
                let keys: Vec<&str> = inputs.iter().map(Input::key).collect();
                map.serialize_entry(&name, &keys)?;
            }
            (_, Value::Flag(flag)) => map.serialize_entry(&name, &flag)?,
            (_, value) => map.serialize_entry(&name, &Written(setting, value).to_string())?,
        }
    }
    map.end()
}

/// What [`named`] writes, for the page of reports.
pub(super) fn described(_: &mut SchemaGenerator) -> Schema {
    let fields = Settings::SETTINGS.iter();
    let fields: serde_json::Map<_, _> = fields
        .map(|setting| {
            (
                report_name(setting),
                json_schema!({ "description": setting.meaning }).into(),
            )
        })
        .collect();
    json_schema!({ "type": "object", "properties": fields })
}

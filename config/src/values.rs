//! Values of a TOML file, read against their declarations.
//!
//! The declarations are `reflex-settings`'; here serde is driven by them, so that an unknown key,
//! a wrong type and a value out of its range are found and placed as in every other file.

use std::fmt;

use reflex_settings::{Kind, Setting, Value};
use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error, MapAccess, Visitor};

/// What a file must hold: each setting with its full key.
pub(crate) type Schema = Vec<(String, &'static Setting)>;

/// What a file holds, in the order of its schema.
#[derive(Clone, Debug, PartialEq)]
pub struct Values(pub(crate) Vec<(String, &'static Setting, Value)>);

impl Values {
    /// The value at a full key.
    pub(crate) fn at(&self, path: &str) -> Option<Value> {
        let mut values = self.0.iter();
        values.find_map(|(key, _, value)| (key == path).then_some(*value))
    }

    /// The number at a full key, 0 where none is.
    pub(crate) fn number(&self, path: &str) -> f64 {
        match self.at(path) {
            Some(Value::Number(number)) => number,
            _ => 0.0,
        }
    }
}

/// Settings with the keys that their declarations name.
pub(crate) fn schema(settings: impl IntoIterator<Item = &'static Setting>) -> Schema {
    let settings = settings.into_iter();
    settings
        .map(|setting| (setting.path().to_string(), setting))
        .collect()
}

/// Reads a file of a schema.
pub(crate) struct File<'s> {
    pub(crate) schema: &'s Schema,
    /// A key that is missing is an error.
    pub(crate) is_whole: bool,
}

impl<'de> DeserializeSeed<'de> for File<'_> {
    type Value = Values;

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<Values, D::Error> {
        let mut found = vec![None; self.schema.len()];
        let table = Table {
            schema: self.schema,
            is_whole: self.is_whole,
            path: String::new(),
            found: &mut found,
        };
        table.deserialize(source)?;
        let values = self.schema.iter().zip(found);
        let values =
            values.filter_map(|((key, setting), value)| Some((key.clone(), *setting, value?)));
        Ok(Values(values.collect()))
    }
}

/// A table of the file: its path, with a dot behind, and where its values go.
struct Table<'s> {
    schema: &'s Schema,
    is_whole: bool,
    path: String,
    found: &'s mut Vec<Option<Value>>,
}

impl Table<'_> {
    /// The keys that may be in this table, in the order of the schema.
    fn keys(&self) -> Vec<String> {
        let inside = self
            .schema
            .iter()
            .filter_map(|(key, _)| key.strip_prefix(&self.path));
        let mut keys: Vec<String> = Vec::new();
        for key in inside {
            let first = key.split('.').next().unwrap_or(key);
            if !keys.iter().any(|known| known == first) {
                keys.push(first.to_owned());
            }
        }
        keys
    }
}

impl<'de> DeserializeSeed<'de> for Table<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<(), D::Error> {
        source.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Table<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<(), M::Error> {
        let keys = self.keys();
        let mut seen = Vec::new();
        while let Some(key) = map.next_key_seed(Key(&keys))? {
            let path = format!("{}{key}", self.path);
            match self.schema.iter().position(|(known, _)| *known == path) {
                Some(place) => {
                    self.found[place] = Some(map.next_value_seed(One(self.schema[place].1))?);
                }
                None => map.next_value_seed(Table {
                    schema: self.schema,
                    is_whole: self.is_whole,
                    path: path + ".",
                    found: &mut *self.found,
                })?,
            }
            seen.push(key);
        }
        match keys.iter().find(|key| !seen.contains(key)) {
            Some(missing) if self.is_whole => {
                Err(M::Error::custom(format!("missing field `{missing}`")))
            }
            _ => Ok(()),
        }
    }
}

/// One of the keys of a table; the error of another one has the key's place.
struct Key<'k>(&'k [String]);

impl<'de> DeserializeSeed<'de> for Key<'_> {
    type Value = String;

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<String, D::Error> {
        let key = String::deserialize(source)?;
        if self.0.contains(&key) {
            return Ok(key);
        }
        let known = self.0.join(", ");
        Err(D::Error::custom(format!(
            "unknown field `{key}`, expected one of {known}"
        )))
    }
}

/// The value of one setting, checked against its range.
struct One(&'static Setting);

impl<'de> DeserializeSeed<'de> for One {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<Value, D::Error> {
        let Self(setting) = self;
        let value = match setting.kind {
            Kind::Number(_) | Kind::Span(_) | Kind::Rate(_) => {
                Value::Number(f64::deserialize(source)?)
            }
            Kind::Count(_) => Value::Number(u32::deserialize(source)?.into()),
            Kind::Step { steps, .. } => {
                let count = u32::deserialize(source)?.into();
                if !steps.contains_count(count) {
                    let line = format!("{count} is out of range, must be {steps}");
                    return Err(D::Error::custom(line));
                }
                Value::Number(1.0 / count)
            }
            Kind::Axes(_) => Value::Axes(<[f64; 3]>::deserialize(source)?),
            Kind::Flag => Value::Flag(bool::deserialize(source)?),
            Kind::Word(_) => word(setting, &String::deserialize(source)?)?,
            Kind::WordOrSpan(..) => source.deserialize_any(WordOrNumber(setting))?,
            Kind::Inputs => return Err(D::Error::custom("inputs have tables of their own")),
        };
        setting.check(value, None).map_err(D::Error::custom)?;
        Ok(value)
    }
}

fn word<E: Error>(setting: &'static Setting, word: &str) -> Result<Value, E> {
    setting
        .parse(word)
        .map_err(|refusal| E::custom(format!("unknown variant `{word}`, {refusal}")))
}

/// A setting that is a word or a time.
struct WordOrNumber(&'static Setting);

impl Visitor<'_> for WordOrNumber {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.range())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Value, E> {
        word(self.0, text)
    }

    fn visit_f64<E: Error>(self, seconds: f64) -> Result<Value, E> {
        Ok(Value::Number(seconds))
    }

    fn visit_i64<E: Error>(self, seconds: i64) -> Result<Value, E> {
        self.visit_f64(seconds as f64)
    }
}

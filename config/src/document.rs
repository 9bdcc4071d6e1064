//! One TOML file: its text, and the way from a place in it to line and key.

use std::marker::PhantomData;
use std::ops::Range;
use std::path::{Path, PathBuf};

use reflex_settings::Limits;
use serde::de::{DeserializeOwned, DeserializeSeed};
use toml::de::{DeTable, DeValue};

use crate::ConfigError;
use crate::values::{File, Schema, Values};

/// A file that was read.
#[derive(Clone, Debug)]
pub struct Document {
    file: PathBuf,
    text: String,
}

impl Document {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn open(file: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(file)
            .map_err(|error| ConfigError::of_file(file, format!("cannot be read: {error}")))?;
        Ok(Self {
            file: file.to_owned(),
            text,
        })
    }

    /// The typed content.
    ///
    /// # Errors
    /// Unknown keys, wrong types and values out of range, with file, line and key.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, ConfigError> {
        self.seeded(PhantomData)
    }

    /// The declared content; errors as those of [`Self::parse`].
    pub(crate) fn values(&self, schema: &Schema) -> Result<Values, ConfigError> {
        self.seeded(File {
            schema,
            is_whole: true,
        })
    }

    /// Some of the declared content; errors as those of [`Self::parse`].
    pub(crate) fn some_values(&self, schema: &Schema) -> Result<Values, ConfigError> {
        self.seeded(File {
            schema,
            is_whole: false,
        })
    }

    fn seeded<'d, S: DeserializeSeed<'d>>(&'d self, seed: S) -> Result<S::Value, ConfigError> {
        let content = toml::Deserializer::parse(&self.text);
        let content = content.and_then(|content| seed.deserialize(content));
        content.map_err(|error| {
            let span = error.span();
            let key = span.as_ref().and_then(|span| self.key_at(span));
            let message = error.message().replace('\n', " ");
            ConfigError {
                file: self.file.clone(),
                line: span.map(|span| self.line_at(span.start)),
                message: key.map_or(message.clone(), |key| format!("{key}: {message}")),
            }
        })
    }

    /// Refuses the first value that passes a limit set by another one.
    pub(crate) fn check(&self, values: &Values, limits: &Limits) -> Result<(), ConfigError> {
        values.0.iter().try_for_each(|(path, setting, value)| {
            let checked = setting.check(*value, Some(limits));
            checked.map_err(|refusal| self.error_at(path, refusal.to_string()))
        })
    }

    /// Refuses a number that is not below another one of the file.
    pub(crate) fn check_below(
        &self,
        values: &Values,
        [lower, upper]: [&str; 2],
    ) -> Result<(), ConfigError> {
        let limit = values.number(upper);
        if values.number(lower) < limit {
            return Ok(());
        }
        Err(self.error_at(lower, format!("must be below {upper}, {limit}")))
    }

    /// An error of one key, for what only several values together can show.
    ///
    /// Numbers in `path` are places in a list, from 0.
    pub fn error_at(&self, path: &str, message: impl Into<String>) -> ConfigError {
        let keys: Vec<&str> = path.split('.').collect();
        let line = DeTable::parse(&self.text).ok().and_then(|table| {
            find(&DeValue::Table(table.into_inner()), &keys).map(|at| self.line_at(at))
        });
        ConfigError {
            file: self.file.clone(),
            line,
            message: format!("{path}: {}", message.into()),
        }
    }

    fn line_at(&self, offset: usize) -> usize {
        let before = self.text.get(..offset).unwrap_or(&self.text);
        before.matches('\n').count() + 1
    }

    /// The full name of the innermost key whose name or value holds a span.
    fn key_at(&self, span: &Range<usize>) -> Option<String> {
        let table = DeTable::parse(&self.text).ok()?;
        let mut path = Vec::new();
        descend(&DeValue::Table(table.into_inner()), span, &mut path);
        (!path.is_empty()).then(|| path.join("."))
    }
}

fn holds(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

/// Walks down the keys and list places that hold `span`, and notes their names.
fn descend(value: &DeValue<'_>, span: &Range<usize>, path: &mut Vec<String>) {
    match value {
        DeValue::Table(table) => {
            for (key, inner) in table {
                let before = path.len();
                path.push(key.get_ref().to_string());
                descend(inner.get_ref(), span, path);
                // A table's own span is only its header, so that its content is asked first.
                let found = path.len() > before + 1;
                if found || holds(&key.span(), span) || holds(&inner.span(), span) {
                    return;
                }
                path.truncate(before);
            }
        }
        DeValue::Array(list) => {
            for (place, inner) in list.iter().enumerate() {
                let before = path.len();
                path.push(place.to_string());
                descend(inner.get_ref(), span, path);
                if path.len() > before + 1 || holds(&inner.span(), span) {
                    return;
                }
                path.truncate(before);
            }
        }
        _ => {}
    }
}

/// Where the key or list place at the end of `path` begins.
fn find(value: &DeValue<'_>, path: &[&str]) -> Option<usize> {
    let (first, rest) = path.split_first()?;
    let (at, inner) = match value {
        DeValue::Table(table) => {
            let (key, inner) = table.iter().find(|(key, _)| key.get_ref() == first)?;
            (key.span().start, inner)
        }
        DeValue::Array(list) => {
            let inner = list.get(first.parse::<usize>().ok()?)?;
            (inner.span().start, inner)
        }
        _ => return None,
    };
    if rest.is_empty() {
        Some(at)
    } else {
        find(inner.get_ref(), rest)
    }
}

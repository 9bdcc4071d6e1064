//! Parameters are checked once, before the first step.

use std::error::Error;
use std::fmt;

/// Parameters that describe no drone or weather: name, value and range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unfit(pub String);

impl fmt::Display for Unfit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl Error for Unfit {}

/// Refuses a value outside `low..=high`, or that is not a number.
pub fn within(name: &str, value: f64, low: f64, high: f64) -> Result<(), Unfit> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Unfit(format!(
        "{name} is {value}; it must be from {low} to {high}"
    )))
}

/// Refuses a vector of which one component is outside `low..=high`.
pub fn all_within(name: &str, values: &[f64], low: f64, high: f64) -> Result<(), Unfit> {
    values
        .iter()
        .try_for_each(|&value| within(name, value, low, high))
}

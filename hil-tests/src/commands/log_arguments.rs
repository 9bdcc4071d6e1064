//! The arguments that say how a log is read, and which part of it.

use clap::Args;

use super::quantities::number;
use crate::refusal::Refusal;
use recorded_flights::{Part, Reading, Rotate, Units};

/// How a log is read.
#[derive(Clone, Debug, Args)]
pub(super) struct LogArguments {
    /// How the log's axes lie in the body's: auto, none, or such as roll180yaw90
    #[arg(long, value_name = "ROTATION", default_value = "auto")]
    rotate: Rotate,
    /// Which flight of the log, from 1; `cargo hil info` lists them [default: the longest]
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["from", "to"])]
    flight: Option<usize>,
    /// Start of the part to take, in s of the log, in place of a flight
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    from: Option<f64>,
    /// End of the part to take, in s of the log
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    to: Option<f64>,
    /// Units of a CSV log where it tells none or wrong ones, such as deg/s,g,ms
    #[arg(long, value_name = "UNIT,...")]
    units: Option<Units>,
}

impl LogArguments {
    /// How the log is read.
    ///
    /// # Errors
    /// A part that ends before it begins.
    pub(super) fn reading(&self) -> Result<Reading, Refusal> {
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            return Err(Refusal::new(format!(
                "--from {from} --to {to}: must come in order"
            )));
        }
        Ok(Reading {
            rotate: self.rotate,
            part: match (self.flight, self.from, self.to) {
                (Some(number), ..) => Part::Number(number),
                (None, None, None) => Part::Longest,
                (None, from, to) => Part::Between(from, to),
            },
            units: self.units.clone().unwrap_or_default(),
        })
    }
}

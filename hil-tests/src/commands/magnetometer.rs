//! `cargo hil magnetometer`: the iron of a board, for its file.

use std::fs;
use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use crate::magnetometer;
use crate::refusal::Refusal;
use recorded_flights::{Flight, Rotate};

/// Which log shows it.
#[derive(Clone, Debug, Args)]
pub(super) struct MagnetometerArguments {
    /// Log of the board being turned: the firmware's own, ULog or CSV, its field without any calibration
    log: PathBuf,

    /// How the log's axes lie in the body's: none, or such as roll180yaw90
    #[arg(long, value_name = "ROTATION", default_value = "none")]
    rotate: Rotate,
}

/// Prints the lines of a board's file.
pub(super) fn run(arguments: &MagnetometerArguments) -> Result<()> {
    let refuse = |line: &str| Refusal::new(format!("{}: {line}", arguments.log.display()));
    let logged =
        fs::read(&arguments.log).map_or_else(|_| Vec::new(), |bytes| magnetometer::logged(&bytes));
    let iron = if logged.is_empty() {
        let flight = Flight::read(&arguments.log, arguments.rotate)?;
        let fields = flight.mag.ok_or_else(|| refuse("has no magnetometer"))?;
        magnetometer::find(fields.values())
    } else {
        magnetometer::find(&logged)
    };
    let iron = iron.map_err(|line| refuse(&line.to_string()))?;
    super::print(&iron.to_string())
}

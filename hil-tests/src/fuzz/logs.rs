//! Logs of flights: read or refused, and what was read can be used.

use anyhow::Result;
use recorded_flights::{Flight, Rotate, Setpoints, Sightings};

use super::{Loaded, Source, Target, is_one_line, samples};

/// A target for each kind of log: its folder under `hil-tests/corpus/`, and what it is called.
pub(super) const ULOG: Target = target("ulog", "ULog files", || sound("ulog"));
pub(super) const BLACKBOX: Target = target("blackbox", "Blackbox logs", || sound("blackbox"));
pub(super) const DATAFLASH: Target = target("dataflash", "DataFlash logs", || sound("dataflash"));
pub(super) const USD: Target = target("usd", "logs of a Crazyflie's card", || sound("usd"));
pub(super) const CSV: Target = target("csv", "CSV of each writer", || sound("csv"));
pub(super) const PACKED: Target = target("packed", "packed logs", || sound("packed"));

const fn target(name: &'static str, reads: &'static str, load: fn() -> Result<Loaded>) -> Target {
    Target {
        name,
        reads,
        inputs: 6000,
        load,
    }
}

fn sound(folder: &str) -> Result<Loaded> {
    Ok(Loaded::new(Source::Spoilt(samples::corpus(folder)?), check))
}

/// Reads a log and, if it is good, uses all of it.
fn check(input: &[u8]) -> bool {
    match Flight::of_bytes("fuzz".to_owned(), input, Rotate::Auto) {
        Ok(flight) => {
            use_all_of(&flight);
            true
        }
        Err(fault) => {
            is_one_line(&fault.in_file("fuzz".as_ref()).to_string());
            false
        }
    }
}

fn use_all_of(flight: &Flight) {
    let setpoints = Setpoints::of(flight);
    let sightings = Sightings::of(flight, &setpoints);
    for step in 0..=20 {
        let at_ns = flight.duration_ns / 20 * step;
        let setpoint = setpoints.at(at_ns);
        assert!(setpoint.thrust.is_finite(), "{setpoint:?}");
        let seen = sightings.as_ref().and_then(|sightings| sightings.at(at_ns));
        let is_finite = seen.is_none_or(|seen| seen.position.iter().all(|it| it.is_finite()));
        assert!(is_finite, "{seen:?}");
    }
}

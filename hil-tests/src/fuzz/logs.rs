//! Logs of flights: read or refused, and what was read can be used.

use recorded_flights::{Flight, Rotate, Setpoints, Sightings};

use super::{Loaded, Source, Target, is_one_line, samples};

pub(super) const ULOG: Target = Target {
    name: "ulog",
    reads: "ULog files",
    inputs: 12_000,
    load: || Ok(Loaded::new(Source::Spoilt(samples::corpus("ulog")?), check)),
};

pub(super) const CSV: Target = Target {
    name: "csv",
    reads: "CSV logs",
    inputs: 12_000,
    load: || Ok(Loaded::new(Source::Spoilt(samples::corpus("csv")?), check)),
};

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

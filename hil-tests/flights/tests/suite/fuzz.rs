//! Spoilt logs are refused or read, never followed by a panic.

use proptest::prelude::*;

use super::samples::full_csv;
use super::ulog_bytes::{Ulog, level_flight};
use recorded_flights::{Flight, Rotate, Setpoints, Sightings};

/// Reads a log and, if it is good, uses all of it.
fn read_and_use(bytes: &[u8]) {
    match Flight::of_bytes("fuzz".to_owned(), bytes, Rotate::Auto) {
        Ok(flight) => {
            let setpoints = Setpoints::of(&flight);
            let sightings = Sightings::of(&flight, &setpoints);
            for step in 0..=20 {
                let at_ns = flight.duration_ns / 20 * step;
                let setpoint = setpoints.at(at_ns);
                assert!(setpoint.thrust.is_finite());
                let seen = sightings.as_ref().and_then(|sightings| sightings.at(at_ns));
                assert!(seen.is_none_or(|seen| seen.position.iter().all(|it| it.is_finite())));
            }
        }
        Err(fault) => {
            let line = fault.in_file("fuzz".as_ref()).to_string();
            assert!(!line.contains('\n') && line.len() < 400, "{line}");
        }
    }
}

fn ulog() -> Vec<u8> {
    let mut log = Ulog::new();
    level_flight(&mut log);
    log.message(b'P', b"\x0bint32_t ABC\x01\0\0\0");
    log.message(b'I', b"\x0bchar[1] abcx");
    log.bytes
}

/// What to do to a log: positions are parts of its length.
#[derive(Clone, Debug)]
enum Change {
    Overwrite(f64, u8),
    Insert(f64, Vec<u8>),
    Remove(f64, usize),
    Cut(f64),
}

fn change() -> impl Strategy<Value = Change> {
    // The beginning, where headers and formats are, deserves as much as the rest.
    let place = || prop_oneof![0.0..1.0_f64, 0.0..0.02_f64];
    let byte = || {
        prop_oneof![
            any::<u8>(),
            prop::sample::select(b"0,.-e\nnaif\xff".to_vec())
        ]
    };
    prop_oneof![
        6 => (place(), byte()).prop_map(|(at, byte)| Change::Overwrite(at, byte)),
        2 => (place(), prop::collection::vec(byte(), 1..9)).prop_map(|(at, b)| Change::Insert(at, b)),
        2 => (place(), 1..60_usize).prop_map(|(at, length)| Change::Remove(at, length)),
        1 => place().prop_map(Change::Cut),
    ]
}

fn spoilt(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for change in changes {
        let place = |part: &f64| (bytes.len() as f64 * part) as usize;
        match change {
            Change::Overwrite(part, byte) => {
                let at = place(part);
                if let Some(slot) = bytes.get_mut(at) {
                    *slot = *byte;
                }
            }
            Change::Insert(part, new) => {
                let at = place(part);
                bytes.splice(at..at, new.iter().copied());
            }
            Change::Remove(part, length) => {
                let at = place(part);
                let end = (at + length).min(bytes.len());
                bytes.drain(at..end);
            }
            Change::Cut(part) => bytes.truncate(place(part)),
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn spoilt_text_never_panics(changes in prop::collection::vec(change(), 1..5)) {
        read_and_use(&spoilt(full_csv().into_bytes(), &changes));
    }

    #[test]
    fn spoilt_ulogs_never_panic(changes in prop::collection::vec(change(), 1..5)) {
        read_and_use(&spoilt(ulog(), &changes));
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        read_and_use(&bytes);
        read_and_use(&[b"ULog\x01\x12\x35\x01", &bytes[..]].concat());
    }

    #[test]
    fn a_cut_ulog_is_refused_or_a_shorter_flight(part in 0.0..1.0_f64) {
        let bytes = ulog();
        let length = (bytes.len() as f64 * part) as usize;
        let flight = Flight::of_bytes("cut".to_owned(), &bytes[..length], Rotate::Auto);
        // A cut between messages leaves a shorter log, which is a good one.
        if let Ok(flight) = flight {
            prop_assert!(flight.duration_s() >= 1.0);
        }
    }
}

//! Each reader of a binary format against a reader that somebody else wrote.

use std::env;
use std::path::Path;
use std::process::Command;

use recorded_flights::recordings::recording;
use recorded_flights::{Flight, Part, Reading, Rotate, Rotation};

/// What an independent reader reads; `None` where it is missing.
///
/// Continuous integration installs it and says so: there its absence is a failure.
fn peer(kind: &str, log: &Path) -> Option<Vec<[f64; 7]>> {
    let python = env::var("REFLEX_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python)
        .args(["-c", &format!("import {kind}")])
        .output();
    if !found.is_ok_and(|found| found.status.success()) {
        assert!(env::var_os("CI").is_none(), "{python} lacks {kind}");
        eprintln!(
            "skipped: {python} lacks {kind}, see .ci/python.txt; REFLEX_PYTHON names another"
        );
        return None;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers.py");
    let output = Command::new(python).args([script, kind]).arg(log).output();
    let output = output.expect("started before");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).expect("numbers");
    let row = |line: &str| -> [f64; 7] {
        let numbers = line.split(' ').map(|word| word.parse().expect("a number"));
        numbers.collect::<Vec<f64>>().try_into().expect("seven")
    };
    Some(text.lines().map(row).collect())
}

/// A log, all of it, in its own axes.
fn read(log: &Path) -> Flight {
    let reading = Reading {
        rotate: Rotate::Named(Rotation::NONE),
        part: Part::Between(None, None),
        ..Reading::default()
    };
    Flight::read(log, reading).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_sample_is_the_one_that_an_independent_reader_reads() {
    let degree = 1.0_f64.to_radians();
    let g = 9.806_65 / 2048.0;
    for (kind, name, rates, forces) in [
        ("pyulog", "px4_v6c_quad_calm.ulg", 1.0, 1.0),
        ("pyulog", "px4_v5_hexa_vib.ulg", 1.0, 1.0),
        ("orangebox", "bf42_gecko_cruise.bbl", degree, g),
        ("orangebox", "bf42_kakutef7_ar8_hover.bfl", degree, g),
        ("orangebox", "bf45_speedybee_freestyle.bfl", degree, g),
        ("pymavlink", "ap33_solo_log171.bin", 1.0, 1.0),
    ] {
        let Some(log) = recording(&format!("raw/{name}")) else {
            continue;
        };
        let Some(expected) = peer(kind, &log) else {
            continue;
        };
        let flight = read(&log);
        // The first frames of a log that begins with a pause, orangebox misreads.
        let end_us = expected.last().map_or(0.0, |row| row[0]);
        let mut met = 0;
        for [time_us, gx, gy, gz, ax, ay, az] in &expected {
            let at = flight.duration_ns - ((end_us - time_us) * 1000.0).round() as i64;
            let Ok(place) = flight.gyro.times_ns().binary_search(&at) else {
                continue;
            };
            met += 1;
            let read = flight.gyro.values()[place];
            for (a, b) in read.iter().zip([gx, gy, gz]) {
                assert!((a - b * rates).abs() < 1e-6, "{name} {time_us}: {a} {b}");
            }
            if kind != "pyulog" {
                // PX4's accelerometer has stamps of its own.
                let read = flight.accel.values()[place];
                for (a, b) in read.iter().zip([ax, ay, az]) {
                    assert!((a - b * forces).abs() < 1e-5, "{name} {time_us}: {a} {b}");
                }
            }
        }
        let most = expected.len().max(flight.gyro.len());
        assert!(met + 20 > most, "{name}: {met} samples agree of {most}");
    }
}

//! Real flights, where they are at hand.

use std::path::Path;

use chip_models::stimulus::StimulusSource;
use recorded_flights::recordings::recording;
use recorded_flights::{
    Flight, FlightStimulus, Part, Reading, Rotate, Rotation, SetpointSource, Setpoints, Standstill,
    Track, sample_flight,
};

fn read(path: &Path) -> Flight {
    Flight::read(path, Rotate::Auto).unwrap_or_else(|error| panic!("{error}"))
}

/// Checks of any real flight; prints what a person would want to know of it.
fn check(flight: &Flight) {
    let setpoints = Setpoints::of(flight);
    let mag = flight.mag.as_ref().map(|mag| (mag.len(), mag.rate_hz()));
    eprintln!(
        "{}: {}, {}, {:.1} s, gyro {:.0} Hz, {} gaps {:?}, {} ({}), mag {mag:?}, motors {:?}, {:?}",
        flight.name,
        flight.part.span,
        flight.part.reason,
        flight.duration_s(),
        flight.gyro.rate_hz(),
        flight.gaps.len(),
        flight.gaps.first(),
        flight.rotation,
        flight.rotation_reason,
        flight.motors.as_ref().map(|m| m.count),
        setpoints.sources,
    );
    let source = FlightStimulus::new(flight, Standstill::default());
    let start = Standstill::default().length_ns();
    for (time, value) in flight.gyro.iter() {
        assert_eq!(source.at(start + time as u64).gyro, value);
    }
    let [_, _, z] = flight.specific_force_at_rest();
    assert!(z < -5.0, "{}: starts with {z} m/s2 along z", flight.name);
    for step in 0..100 {
        let at = flight.duration_ns / 100 * step;
        let thrust = setpoints.at(at).thrust;
        assert!((0.0..=1.0).contains(&thrust), "{thrust}");
    }
}

#[test]
fn every_recorded_csv_is_read_and_turned_with_z_down() {
    for (name, seconds, gaps, rotation, has_mag) in [
        ("ansfl_phantom4_h11", 55.1, 0, Rotation::ROLL_180, false),
        (
            "ap33_solo_acro_crash_mpu6000_lsm303d",
            100.0,
            0,
            Rotation::NONE,
            true,
        ),
        (
            "ap33_solo_loiter_mpu6000_lsm303d",
            120.0,
            0,
            Rotation::NONE,
            true,
        ),
        ("bf42_gecko_cruise", 120.0, 0, Rotation::ROLL_180, false),
        (
            "bf42_kakutef7_ar8_hover",
            16.2,
            0,
            Rotation::ROLL_180,
            false,
        ),
        (
            "bf45_speedybee_freestyle",
            16.3,
            0,
            Rotation::ROLL_180,
            false,
        ),
        (
            "bf45_speedybee_freestyle_unfilt",
            16.3,
            0,
            Rotation::ROLL_180,
            false,
        ),
        ("px4_v5_hexa_vib", 9.9, 0, Rotation::NONE, true),
        ("px4_v6c_quad_calm", 84.4, 0, Rotation::NONE, true),
    ] {
        let Some(path) = recording(&format!("csv/{name}.csv")) else {
            continue;
        };
        let flight = read(&path);
        assert!(
            (flight.duration_s() - seconds).abs() < 0.1,
            "{name}: {} s, {}",
            flight.duration_s(),
            flight.part.span
        );
        assert_eq!(flight.gaps.len(), gaps, "{name}: {:?}", flight.gaps);
        assert_eq!(flight.rotation, rotation, "{name}");
        assert_eq!(flight.mag.is_some(), has_mag, "{name}");
        check(&flight);
    }
}

#[test]
fn every_recorded_ulog_is_read_with_its_own_setpoints() {
    for (name, seconds, motors) in [("px4_v5_hexa_vib", 10.7, 6), ("px4_v6c_quad_calm", 85.6, 4)] {
        let Some(path) = recording(&format!("raw/{name}.ulg")) else {
            continue;
        };
        let flight = read(&path);
        assert!(
            (flight.duration_s() - seconds).abs() < 0.1,
            "{name}: {} s, {}",
            flight.duration_s(),
            flight.part.span
        );
        assert_eq!(flight.rotation, Rotation::NONE);
        assert_eq!(flight.motors.as_ref().map(|m| m.count), Some(motors));
        let sources = Setpoints::of(&flight).sources;
        assert_eq!(sources.attitude, SetpointSource::Recorded);
        assert_eq!(sources.rates, SetpointSource::Recorded);
        assert_eq!(sources.thrust, SetpointSource::Recorded);
        check(&flight);
    }
}

#[test]
fn the_default_flight_is_read() {
    let flight = read(&sample_flight().expect("a dependency"));
    assert!((flight.duration_s() - 68.9).abs() < 0.1);
    assert!((flight.gyro.rate_hz() - 250.0).abs() < 1.0);
    assert!(flight.mag.is_some());
    check(&flight);
}

/// All of a log.
fn whole(path: &Path) -> Flight {
    let reading = Reading {
        part: Part::Between(None, None),
        ..Reading::default()
    };
    Flight::read(path, reading).unwrap_or_else(|error| panic!("{error}"))
}

/// The most that two signals differ where the first is part of the second, and how many samples
/// the first has.
fn difference(part: &Track<3>, all: &Track<3>) -> Option<(f64, usize)> {
    let apart = |a: &[f64; 3], b: &[f64; 3]| {
        let parts = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        parts.fold(0.0, f64::max)
    };
    let (part, all) = (part.values(), all.values());
    let starts = all.windows(8.min(part.len()));
    let start = starts
        .enumerate()
        .find(|(_, window)| window.iter().zip(part).all(|(a, b)| apart(a, b) < 1e-4));
    let (start, _) = start?;
    let pairs = part.iter().zip(&all[start..]);
    let most = pairs.map(|(a, b)| apart(a, b)).fold(0.0, f64::max);
    Some((most, part.len()))
}

#[test]
fn each_reader_reads_what_the_converted_columns_hold() {
    for (raw, csv, accel) in [
        ("px4_v6c_quad_calm.ulg", "px4_v6c_quad_calm", true),
        ("px4_v5_hexa_vib.ulg", "px4_v5_hexa_vib", true),
        ("bf42_gecko_cruise.bbl", "bf42_gecko_cruise", true),
        (
            "bf42_kakutef7_ar8_hover.bfl",
            "bf42_kakutef7_ar8_hover",
            true,
        ),
        (
            "bf45_speedybee_freestyle.bfl",
            "bf45_speedybee_freestyle_unfilt",
            true,
        ),
        // The columns mix the gyroscope of one chip with the accelerometer of another.
        (
            "ap33_solo_log171.bin",
            "ap33_solo_loiter_mpu6000_lsm303d",
            false,
        ),
        (
            "ap33_solo_log171.bin",
            "ap33_solo_acro_crash_mpu6000_lsm303d",
            false,
        ),
        ("ansfl_phantom4_h11_imu1.csv", "ansfl_phantom4_h11", true),
    ] {
        let (Some(raw), Some(csv)) = (
            recording(&format!("raw/{raw}")),
            recording(&format!("csv/{csv}.csv")),
        ) else {
            continue;
        };
        let (read, expected) = (whole(&raw), whole(&csv));
        let (most, samples) = difference(&expected.gyro, &read.gyro)
            .unwrap_or_else(|| panic!("{}: not the same flight", raw.display()));
        assert!(
            most < 1e-5 && samples > 2000,
            "{}: {most} rad/s",
            raw.display()
        );
        if accel {
            let (most, _) = difference(&expected.accel, &read.accel).expect("the same flight");
            assert!(most < 1e-4, "{}: {most} m/s2", raw.display());
        }
        let motors = |flight: &Flight| flight.motors.as_ref().map(|motors| motors.count);
        assert_eq!(motors(&read), motors(&expected), "{}", raw.display());
    }
}

#[test]
fn the_computed_attitude_agrees_with_the_recorded_one() {
    let Some(path) = recording("raw/px4_v6c_quad_calm.ulg") else {
        return;
    };
    let recorded = read(&path);
    let mut bare = recorded.clone();
    bare.recorded = recorded_flights::Recorded {
        thrust_setpoint: None,
        ..Default::default()
    };
    let mut filmed = recorded.clone();
    filmed.recorded.attitude_setpoint = None;
    let (computed, own) = (Setpoints::of(&bare), Setpoints::of(&filmed));
    assert_eq!(computed.sources.attitude, SetpointSource::Computed);
    assert_eq!(own.sources.attitude, SetpointSource::Motion);
    for second in 1..90 {
        let (a, b) = (
            computed.at(second * 1_000_000_000),
            own.at(second * 1_000_000_000),
        );
        let tilt = |q: [f64; 4]| {
            let [w, x, y, z] = q;
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x)]
        };
        for (a, b) in tilt(a.attitude).iter().zip(tilt(b.attitude)) {
            assert!((a - b).abs() < 0.07, "{second} s: {a} {b}");
        }
    }
}

#[test]
fn a_real_log_cut_short_is_read_to_there() {
    let Some(path) = recording("raw/px4_v5_hexa_vib.ulg") else {
        return;
    };
    let bytes = std::fs::read(&path).expect("at hand");
    let half = &bytes[..bytes.len() / 2];
    let flight = Flight::of_bytes("half".to_owned(), half, Rotate::Auto).expect("half of it");
    assert!(flight.duration_s() > 3.0, "{}", flight.duration_s());
    assert_eq!(flight.skipped.kinds().len(), 1, "{:?}", flight.skipped);
}

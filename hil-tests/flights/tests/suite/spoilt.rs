//! Logs of every format, cut to 20 KB, with each byte spoilt in turn.

use std::io::Write;

use recorded_flights::recordings::recording;
use recorded_flights::{Flight, Rotate};

use super::samples::full_csv;
use super::ulog_bytes::{Ulog, level_flight};

const CUT: usize = 20_000;

/// Reads a log; what it says of a bad one is a line.
fn read(bytes: &[u8]) {
    if let Err(fault) = Flight::of_bytes("spoilt".to_owned(), bytes, Rotate::Auto) {
        let line = fault.in_file("spoilt".as_ref()).to_string();
        assert!(!line.contains('\n') && line.len() < 500, "{line}");
    }
}

/// The log of a Crazyflie's card: half a minute at 100 Hz.
pub(super) fn usd() -> Vec<u8> {
    let mut log = vec![0xbc, 2, 0, 1, 0, 7, 0];
    log.extend(b"fixedFrequency\0");
    let names = ["gyro.x", "gyro.y", "gyro.z", "acc.x", "acc.y", "acc.z"];
    log.extend((names.len() as u16 + 4).to_le_bytes());
    for name in names {
        log.extend(format!("{name}(f)\0").bytes());
    }
    for motor in 1..=4 {
        log.extend(format!("motor.m{motor}(H)\0").bytes());
    }
    for sample in 0..3000_u64 {
        log.extend(7_u16.to_le_bytes());
        log.extend((sample * 10_000).to_le_bytes());
        let wave = (sample as f32 / 20.0).sin();
        for value in [10.0 * wave, 0.0, -3.0, 0.1 * wave, 0.0, 1.0] {
            log.extend(value.to_le_bytes());
        }
        for motor in [30_000_u16, 31_000, 32_000, 33_000] {
            log.extend(motor.to_le_bytes());
        }
    }
    log.extend([0; 4]);
    log
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gz.write_all(bytes).expect("in memory");
    gz.finish().expect("in memory")
}

/// A short log of each format; of real flights where they are at hand.
fn logs() -> Vec<(String, Vec<u8>)> {
    let mut ulog = Ulog::new();
    level_flight(&mut ulog);
    let mut logs = vec![
        ("ULog".to_owned(), ulog.bytes.clone()),
        ("CSV".to_owned(), full_csv().into_bytes()),
        ("uSD".to_owned(), usd()),
        ("gzip".to_owned(), packed(&ulog.bytes)),
    ];
    for name in [
        "bf42_kakutef7_ar8_hover.bfl",
        "ap33_solo_log171.bin",
        "px4_v5_hexa_vib.ulg",
    ] {
        if let Some(path) = recording(&format!("raw/{name}")) {
            logs.push((name.to_owned(), std::fs::read(path).expect("at hand")));
        }
    }
    for (_, bytes) in &mut logs {
        bytes.truncate(CUT);
    }
    logs
}

#[test]
fn no_flipped_byte_of_any_log_is_followed_by_a_panic() {
    for (name, mut bytes) in logs() {
        eprintln!("{name}");
        for place in 0..bytes.len() {
            let good = bytes[place];
            // Another bit of each byte.
            bytes[place] = good ^ 1 << (place % 8);
            read(&bytes);
            bytes[place] = good;
        }
    }
}

#[test]
fn no_cut_log_is_followed_by_a_panic() {
    for (_, bytes) in logs() {
        for end in (0..bytes.len()).step_by(37) {
            read(&bytes[..end]);
        }
    }
}

#[test]
fn a_log_that_is_packed_is_read_and_a_bomb_is_refused() {
    let mut ulog = Ulog::new();
    level_flight(&mut ulog);
    let read = |bytes: &[u8]| Flight::of_bytes("log".to_owned(), bytes, Rotate::Auto);
    let plain = read(&ulog.bytes).expect("a good log");
    let gz = packed(&ulog.bytes);
    assert_eq!(read(&gz).expect("a good log"), plain);
    let cut = read(&gz[..gz.len() - 100]).expect("most of it");
    assert!(cut.skipped.count() > 0 && cut.gyro.len() > 100);
    let bomb = packed(&vec![0; 200 << 20]);
    let fault = read(&bomb)
        .map(|flight| flight.duration_ns)
        .expect_err("too much");
    assert!(
        fault.reason.contains("unpacks to more than 128 MiB"),
        "{fault:?}"
    );
}

#[test]
fn a_crazyflie_is_read_forward_left_up_in_its_units() {
    let flight = Flight::of_bytes("log".to_owned(), &usd(), Rotate::Auto).expect("a good log");
    assert_eq!(flight.duration_ns, 29_990_000_000);
    let [_, _, yaw] = flight.gyro.at(0).unwrap_or_default();
    assert!((yaw - 3.0_f64.to_radians()).abs() < 1e-6, "{yaw}");
    assert_eq!(flight.accel.at(0), Some([0.0, 0.0, -9.806_65]));
    let motors = flight.motors.expect("motors");
    assert_eq!((motors.count, motors.track.len()), (4, 3000));
}

//! ULog files: what is read, and how bad ones are refused.

use super::ulog_bytes::{COMBINED, Ulog, combined, level_flight};
use recorded_flights::{
    Fault, Flight, Location, LogFormat, Part, Reading, Rotate, Rotation, RotationReason,
};

fn read(log: &Ulog) -> Result<Flight, Fault> {
    Flight::of_bytes("log".to_owned(), &log.bytes, Rotate::Auto)
}

fn level() -> Ulog {
    let mut log = Ulog::new();
    level_flight(&mut log);
    log
}

/// A log of other topics whose samples are made by `fill`.
fn filled(
    topics: &[(&str, &str)],
    samples: u64,
    period_us: u64,
    fill: impl Fn(&mut Ulog, u64),
) -> Ulog {
    let mut log = Ulog::new();
    for (name, fields) in topics {
        log.topic(name, fields);
    }
    for sample in 0..samples {
        fill(&mut log, 1_000_000 + sample * period_us);
    }
    log
}

#[test]
fn combined_sensors_are_read_with_their_own_times() {
    let flight = read(&level()).expect("a good log");
    assert_eq!(flight.format, LogFormat::Ulog);
    assert_eq!(flight.duration_ns, 2_000_000_000);
    assert_eq!(
        flight.gyro.at(1_000_000_000),
        Some([1.0, 0.0, f64::from(0.1_f32)])
    );
    // The accelerometer's samples are a millisecond older.
    assert_eq!(flight.accel.first_time_ns(), Some(-1_000_000));
    assert_eq!(
        flight.accel.at(999_000_000),
        Some([0.0, 1.0, f64::from(-9.8_f32)])
    );
    assert_eq!(flight.rotation, Rotation::NONE);
    assert_eq!(flight.rotation_reason, RotationReason::Format);
    assert!(flight.mag.is_none() && flight.motors.is_none());
}

#[test]
fn the_fastest_source_of_samples_is_taken() {
    let xyz = "uint64_t timestamp;uint64_t timestamp_sample;float x;float y;float z;";
    let topics = [
        ("sensor_combined", COMBINED),
        ("sensor_gyro", xyz),
        ("sensor_accel", xyz),
    ];
    let log = filled(&topics, 2001, 1000, |log, time| {
        if time % 5000 == 0 {
            combined(log, time, [1.0; 3], [1.0; 3]);
        }
        for (topic, values) in [("sensor_gyro", [2.0_f32; 3]), ("sensor_accel", [3.0; 3])] {
            log.data(topic, time, |data| {
                data.extend((time - 500).to_le_bytes());
                values.iter().for_each(|v| data.extend(v.to_le_bytes()));
            });
        }
    });
    let flight = read(&log).expect("a good log");
    assert_eq!(flight.gyro.at(0), Some([2.0; 3]));
    assert_eq!(flight.accel.at(0), Some([3.0; 3]));
    assert!((flight.gyro.rate_hz() - 1000.0).abs() < 1.0);
}

#[test]
fn integrated_sensors_are_divided_by_their_time() {
    let imu = "uint64_t timestamp;float[3] delta_angle;float[3] delta_velocity;\
               uint16_t delta_angle_dt;uint16_t delta_velocity_dt;";
    let log = filled(&[("vehicle_imu", imu)], 401, 5000, |log, time| {
        log.data("vehicle_imu", time, |data| {
            for value in [0.01_f32, 0.0, 0.0, 0.0, 0.0, -0.04] {
                data.extend(value.to_le_bytes());
            }
            data.extend(5000_u16.to_le_bytes());
            data.extend(4000_u16.to_le_bytes());
        });
    });
    let flight = read(&log).expect("a good log");
    let gyro = flight.gyro.at(0).unwrap_or_default();
    let accel = flight.accel.at(0).unwrap_or_default();
    assert!((gyro[0] - 2.0).abs() < 1e-6 && (accel[2] + 10.0).abs() < 1e-6);
}

#[test]
fn motors_and_setpoints_that_are_not_controlled_are_left_out() {
    let mut log = level();
    log.topic("actuator_motors", "uint64_t timestamp;float[12] control;");
    log.topic(
        "vehicle_rates_setpoint",
        "uint64_t timestamp;float roll;float pitch;float yaw;",
    );
    let n = f32::NAN;
    let used = [0.5, -0.2, 1.2, 0.1, n, n, n, n, n, n, n, n];
    for time in [1_000_000, 2_000_000] {
        log.floats("actuator_motors", time, &used);
        log.floats("vehicle_rates_setpoint", time, &[0.1, n, 0.3]);
    }
    log.floats("vehicle_rates_setpoint", 3_000_000, &[0.1, 0.2, 0.3]);
    let flight = read(&log).expect("a good log");
    let motors = flight.motors.expect("motors");
    assert_eq!(motors.count, 4);
    let first = motors
        .track
        .at(0)
        .unwrap_or_default()
        .map(|m| (m * 10.0).round());
    assert_eq!(first, [5.0, 0.0, 10.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(
        flight.recorded.rates_setpoint.map(|track| track.len()),
        Some(1)
    );
}

#[test]
fn pulses_are_motors_where_nothing_better_is_logged() {
    let mut log = level();
    log.topic(
        "actuator_outputs",
        "uint64_t timestamp;uint32_t noutputs;float[16] output;",
    );
    log.data("actuator_outputs", 1_000_000, |data| {
        data.extend(2_u32.to_le_bytes());
        for output in [900.0_f32, 1250.0].into_iter().chain([0.0; 14]) {
            data.extend(output.to_le_bytes());
        }
    });
    let motors = read(&log).expect("a good log").motors.expect("motors");
    assert_eq!((motors.count, motors.mean().at(0)), (2, Some([0.125])));
}

/// What is skipped of a log that is otherwise good.
fn skipped(log: &Ulog) -> String {
    let flight = read(log)
        .map_err(|fault| fault.reason)
        .expect("the rest of it");
    assert!(flight.duration_s() > 1.9, "{}", flight.duration_s());
    let kinds = flight.skipped.kinds().iter().map(ToString::to_string);
    kinds.collect::<Vec<_>>().join("; ")
}

#[test]
fn a_log_cut_within_a_message_is_read_to_there() {
    let whole = level();
    for cut in [1, 17, 30] {
        let mut log = level();
        log.bytes.truncate(whole.bytes.len() - cut);
        let start_of_last = whole.bytes.len() - (3 + 2 + 8 + 12 + 4 + 12);
        let lost = log.bytes.len() - start_of_last;
        let expected =
            format!("{lost} x bytes behind the last whole message (first at byte {start_of_last})");
        assert_eq!(skipped(&log), expected);
    }
    assert_eq!(skipped(&whole), "");
}

#[test]
fn garbage_in_the_middle_and_zeros_at_the_end_are_skipped() {
    let mut log = level();
    let middle = log.bytes.len() as u64;
    log.bytes.extend([0xee; 1000]);
    for time in [3_005_000, 3_010_000, 3_015_000] {
        combined(&mut log, time, [0.0, 0.5, 0.0], [0.0, 0.0, -9.8]);
    }
    let zeros = log.bytes.len() as u64;
    log.bytes.extend([0; 5000]);
    let expected = format!(
        "1000 x bytes of garbage (first at byte {middle}); 5000 x bytes of zeros (first at byte {zeros})"
    );
    assert_eq!(skipped(&log), expected);
    assert_eq!(
        read(&log).map(|flight| flight.duration_ns),
        Ok(2_015_000_000)
    );
}

#[test]
fn time_that_goes_back_is_skipped_with_its_topic() {
    let mut log = level();
    let offset = log.bytes.len() as u64;
    combined(&mut log, 2_999_999, [0.0; 3], [0.0; 3]);
    let expected = format!("2 x sensor_combined: a time that goes back (first at byte {offset})");
    assert_eq!(skipped(&log), expected);
}

#[test]
fn values_no_sensor_gives_are_skipped_and_many_refuse_the_log() {
    for bad in [f32::NAN, f32::INFINITY, 1e30] {
        let mut log = level();
        let offset = log.bytes.len() as u64;
        combined(&mut log, 3_005_000, [0.0, bad, 0.0], [0.0, 0.0, -9.8]);
        let expected =
            format!("1 x sensor_combined: rates that no sensor gives (first at byte {offset})");
        assert_eq!(skipped(&log), expected);
        for sample in 2..50 {
            combined(
                &mut log,
                3_000_000 + sample * 5000,
                [0.0, bad, 0.0],
                [0.0, 0.0, -9.8],
            );
        }
        let fault = read(&log)
            .map(|flight| flight.duration_ns)
            .expect_err("one in nine");
        assert_eq!(fault.location, Location::Byte(offset));
        assert!(fault.reason.starts_with("sensor_combined: "), "{fault:?}");
    }
}

#[test]
fn an_instance_that_is_all_zero_never_wins() {
    let xyz = "uint64_t timestamp;float x;float y;float z;";
    let mut log = level();
    for topic in ["sensor_gyro", "sensor_accel"] {
        log.topic(topic, xyz);
        for sample in 0..4000 {
            log.floats(topic, 1_000_000 + sample * 500, &[0.0; 3]);
        }
    }
    let flight = read(&log).expect("a good log");
    assert!((flight.gyro.rate_hz() - 200.0).abs() < 1.0);
}

#[test]
fn the_part_that_flew_is_taken_and_others_by_their_number() {
    let mut log = Ulog::new();
    log.topic("vehicle_land_detected", "uint64_t timestamp;bool landed;");
    log.topic("sensor_combined", COMBINED);
    for (time, landed) in [
        (1_000_000, 1),
        (2_000_000, 0),
        (5_000_000, 1),
        (14_000_000, 0),
        (18_000_000, 1),
    ] {
        log.data("vehicle_land_detected", time, |data| data.push(landed));
    }
    for sample in 0..4000_u64 {
        let wave = (sample % 7) as f32 * 0.1;
        combined(
            &mut log,
            1_000_000 + sample * 5000,
            [wave, 0.0, 0.1],
            [0.0, wave, -9.8],
        );
    }
    let of = |part| {
        let reading = Reading {
            part,
            ..Reading::default()
        };
        Flight::of_bytes("log".to_owned(), &log.bytes, reading).map(|flight| {
            (
                flight.part.span.from_ns / 1_000_000,
                flight.duration_ns / 1_000_000,
            )
        })
    };
    assert_eq!(of(Part::Longest), Ok((13_000, 4000)));
    assert_eq!(of(Part::Number(1)), Ok((1000, 3000)));
    assert_eq!(of(Part::Between(Some(2.0), Some(4.5))), Ok((2000, 2500)));
    let fault = of(Part::Number(3)).expect_err("two flights");
    assert!(
        fault.reason.starts_with("--flight 3: it holds 2 flights"),
        "{fault:?}"
    );
    let fault = of(Part::Between(Some(30.0), None)).expect_err("behind the end");
    assert!(fault.reason.contains("it holds 0.0 to 20.0 s"), "{fault:?}");
}

#[test]
fn the_log_of_another_vehicle_is_named() {
    let mut log = level();
    log.topic(
        "vehicle_status",
        "uint64_t timestamp;uint8_t arming_state;uint8_t vehicle_type;",
    );
    log.data("vehicle_status", 2_000_000, |data| data.extend([2, 2]));
    let fault = read(&log)
        .map(|flight| flight.duration_ns)
        .expect_err("a plane");
    assert_eq!(
        fault.reason,
        "is the log of a fixed wing: only flights of multirotors are replayed"
    );
}

#[test]
fn a_log_without_gyroscope_or_accelerometer_is_refused() {
    let fault = read(&Ulog::new()).expect_err("nothing in it");
    assert!(fault.reason.starts_with("has no gyroscope: "), "{fault:?}");
    let xyz = "uint64_t timestamp;float x;float y;float z;";
    let log = filled(&[("sensor_gyro", xyz)], 401, 5000, |log, time| {
        log.floats("sensor_gyro", time, &[0.0; 3]);
    });
    let fault = read(&log).expect_err("no accelerometer");
    assert!(
        fault.reason.starts_with("has no accelerometer: "),
        "{fault:?}"
    );
    let slow = filled(&[("sensor_combined", COMBINED)], 5, 500_000, |log, time| {
        combined(log, time, [0.0; 3], [0.0; 3]);
    });
    let fault = read(&slow).expect_err("2 Hz");
    assert!(
        fault.reason.starts_with("has its gyroscope at 2.0 Hz only"),
        "{fault:?}"
    );
}

#[test]
fn spoilt_messages_are_skipped_where_they_are() {
    for (kind, payload) in [
        (b'A', &[0, 0][..]),
        (b'D', &[1]),
        (b'D', &[99, 0, 1, 2]),
        (b'D', &[0, 0, 1, 2]),
        (b'B', &[0; 40]),
        (b'F', b"sensor_combined"),
        (b'F', &[0xff, 0xfe]),
        (b'F', b"sensor_combined:float[3;"),
        (b'A', b"\0\0\0sensor_combined"),
    ] {
        let mut log = level();
        let place = format!("(first at byte {})", log.bytes.len());
        log.message(kind, payload);
        combined(&mut log, 3_005_000, [0.0; 3], [0.0, 0.0, -9.8]);
        let skipped = skipped(&log);
        assert!(
            skipped.starts_with("1 x ") && skipped.ends_with(&place),
            "{skipped}"
        );
    }
    // Messages that say nothing of a flight are not looked into.
    for kind in [b'P', b'I', b'M', b'L', b'S', b'O'] {
        let mut log = level();
        log.message(kind, &[0]);
        assert_eq!(skipped(&log), "");
    }
}

#[test]
fn unknown_topics_and_messages_are_passed_over() {
    let mut log = level();
    log.topic("mystery", "uint64_t timestamp;other[300] nested;");
    log.data("mystery", 0, |data| data.extend([1, 2, 3]));
    read(&log).expect("a good log");
}

#[test]
fn a_cut_before_appended_crash_data_is_no_fault() {
    let mut log = level();
    log.bytes.extend([100, 0, b'D', 0, 0]);
    let appended = log.bytes.len() as u64;
    log.bytes[16 + 3 + 8] = 1;
    log.bytes[16 + 3 + 16..16 + 3 + 24].copy_from_slice(&appended.to_le_bytes());
    combined(&mut log, 3_005_000, [7.0, 0.0, 0.0], [0.0; 3]);
    let flight = read(&log).expect("a good log");
    assert_eq!(flight.gyro.at(flight.duration_ns), Some([7.0, 0.0, 0.0]));
}

//! The MPU6050 against numbers worked out from its datasheet.

mod interrupt;
mod motion;

use proptest::prelude::*;

use super::registers::*;
use super::*;
use crate::testing::*;

/// Awake on the gyroscope clock, 98 Hz low-pass, 1 kHz, +-2000 deg/s, +-16 g.
const FLIGHT: [(u8, u8); 7] = [
    (PWR_MGMT_1, 0x01),
    (SMPLRT_DIV, 0),
    (CONFIG, 2),
    (GYRO_CONFIG, 0x18),
    (ACCEL_CONFIG, 0x18),
    (INT_PIN_CFG, 0x00),
    (INT_ENABLE, DATA_READY),
];

pub fn chip(source: Arc<dyn StimulusSource>, options: ChipOptions) -> Mpu6050 {
    let mut chip = Mpu6050::new(source, options);
    write_i2c(&mut chip, 0, &FLIGHT);
    chip
}

#[test]
fn after_power_on_it_sleeps_and_answers_its_identity() {
    let mut chip = Mpu6050::new(lively(), exact());
    assert_eq!(read_i2c(&mut chip, 0, WHO_AM_I, 1), [0x68]);
    assert_eq!(read_i2c(&mut chip, 0, PWR_MGMT_1, 2), [0x40, 0x00]);
    assert_eq!(chip.next_event(), u64::MAX);
    chip.advance(SECOND);
    assert_eq!(chip.samples(), 0);
}

#[test]
fn only_its_own_address_is_acknowledged() {
    let mut chip = Mpu6050::new(lively(), exact());
    assert!(!chip.start(0, 0x69, false));
    assert!(!chip.write(0, WHO_AM_I));
    assert_eq!(chip.read(0, true), 0xFF);
    assert!(chip.start(0, Mpu6050::ADDRESS, true));
}

#[test]
fn the_sample_rate_is_the_internal_rate_over_the_divider() {
    for (low_pass, divider, per_second) in [
        (2, 0, 1000),
        (2, 9, 100),
        (6, 255, 3),
        (0, 0, 8000),
        (0, 7, 1000),
    ] {
        let mut chip = chip(lively(), exact());
        write_i2c(&mut chip, 0, &[(CONFIG, low_pass), (SMPLRT_DIV, divider)]);
        chip.advance(SECOND);
        assert_eq!(
            chip.samples(),
            per_second,
            "DLPF {low_pass}, divider {divider}"
        );
    }
}

#[test]
fn the_oscillator_error_shifts_the_rate() {
    let options = ChipOptions {
        oscillator_error: Some(0.02),
        ..exact()
    };
    let mut fast = chip(lively(), options);
    fast.advance(10 * SECOND);
    assert_eq!(fast.samples(), 10_200);
}

#[test]
fn the_clock_source_decides_the_tolerance() {
    let samples = |seed, source| {
        let mut chip = Mpu6050::new(
            lively(),
            ChipOptions {
                seed,
                ..ChipOptions::default()
            },
        );
        write_i2c(&mut chip, 0, &[(CONFIG, 2), (PWR_MGMT_1, source)]);
        chip.advance(SECOND);
        chip.samples() as i64 - 1000
    };
    let relaxation: Vec<i64> = (0..30).map(|seed| samples(seed, 0)).collect();
    let gyro: Vec<i64> = (0..30).map(|seed| samples(seed, 1)).collect();
    assert!(
        relaxation.iter().all(|off| off.abs() <= 50),
        "{relaxation:?}"
    );
    assert!(
        relaxation.iter().any(|off| off.abs() > 25),
        "{relaxation:?}"
    );
    assert!(gyro.iter().all(|off| off.abs() <= 20), "{gyro:?}");
    assert_eq!(samples(0, 7), -1000, "CLKSEL 7 stops the clock");
}

#[test]
fn full_scale_ranges_have_the_datasheets_sensitivity() {
    let source: Arc<dyn StimulusSource> = Arc::new(|_| crate::Stimulus {
        gyro: [100.0_f64.to_radians(), -100.0_f64.to_radians(), 0.0],
        specific_force: [9.80665, -9.80665, 0.0],
        ..crate::Stimulus::default()
    });
    for (range, gyro, accel) in [
        (0, 13_100, 16_384),
        (1, 6_550, 8_192),
        (2, 3_280, 4_096),
        (3, 1_640, 2_048),
    ] {
        let mut chip = chip(Arc::clone(&source), exact());
        let bits = range << 3;
        write_i2c(&mut chip, 0, &[(GYRO_CONFIG, bits), (ACCEL_CONFIG, bits)]);
        let bytes = read_i2c(&mut chip, 100 * MS, ACCEL_XOUT_H, 14);
        assert_eq!(big(&bytes), [accel, -accel, 0]);
        assert_eq!(big(&bytes[8..]), [gyro, -gyro, 0]);
    }
}

#[test]
fn values_beyond_full_scale_clip() {
    let mut gyro = chip(rate_dps(|_| [3000.0, -3000.0, 0.0]), exact());
    let bytes = read_i2c(&mut gyro, 100 * MS, 0x43, 6);
    assert_eq!(big(&bytes), [i16::MAX, i16::MIN, 0]);
    let mut accel = chip(force_g(|_| [17.0, -17.0, 0.0]), exact());
    let bytes = read_i2c(&mut accel, 100 * MS, ACCEL_XOUT_H, 6);
    assert_eq!(big(&bytes), [i16::MAX, i16::MIN, 0]);
}

#[test]
fn the_temperature_register_follows_the_datasheets_formula() {
    // (25 - 36.53) * 340 = -3920.2
    let mut chip = chip(rate_dps(|_| [0.0; 3]), exact());
    let bytes = read_i2c(&mut chip, 10 * MS, 0x41, 2);
    assert_eq!(i16::from_be_bytes([bytes[0], bytes[1]]), -3920);
}

#[test]
fn the_low_pass_delays_a_ramp_by_the_datasheets_delay() {
    // 1000 deg/s per second: 16.4 counts per ms of delay.
    for (low_pass, delay_ms) in [(1, 1.9), (2, 2.8), (3, 4.8), (4, 8.3)] {
        let mut chip = chip(rate_dps(|t| [1000.0 * t, 0.0, 0.0]), exact());
        write_i2c(&mut chip, 0, &[(CONFIG, low_pass)]);
        let code = f64::from(big(&read_i2c(&mut chip, SECOND, 0x43, 6))[0]);
        let delay = 1000.0 - code / 16.4;
        assert!(
            (delay - delay_ms).abs() < 0.1,
            "DLPF {low_pass}: {delay} ms"
        );
    }
}

#[test]
fn the_low_pass_halves_the_power_at_its_bandwidth() {
    for (low_pass, hz) in [
        (1, 188.0),
        (2, 98.0),
        (3, 42.0),
        (4, 20.0),
        (5, 10.0),
        (6, 5.0),
    ] {
        let wave = move |t: f64| [1000.0 * (std::f64::consts::TAU * hz * t).sin(), 0.0, 0.0];
        let mut chip = chip(rate_dps(wave), exact());
        write_i2c(&mut chip, 0, &[(CONFIG, low_pass)]);
        let peak = (1000..3000)
            .map(|ms| big(&read_i2c(&mut chip, ms * MS, 0x43, 6))[0].unsigned_abs())
            .max();
        let gain = f64::from(peak.unwrap_or(0)) / 16_400.0;
        assert!((0.66..0.72).contains(&gain), "{hz} Hz: {gain}");
    }
}

#[test]
fn noise_has_the_datasheets_deviation() {
    let mut chip = chip(rate_dps(|_| [0.0; 3]), real(1));
    write_i2c(&mut chip, 0, &[(GYRO_CONFIG, 0), (ACCEL_CONFIG, 0)]);
    let mut gyro = Vec::new();
    let mut accel = Vec::new();
    for ms in 50..4000 {
        let bytes = read_i2c(&mut chip, ms * MS, ACCEL_XOUT_H, 14);
        accel.extend(big(&bytes).map(|code| f64::from(code) / 16_384.0));
        gyro.extend(big(&bytes[8..]).map(|code| f64::from(code) / 131.0));
    }
    let rms =
        |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    // PS-MPU-6000A 6.1: 0.05 deg/s rms at DLPF_CFG 2.
    assert!((rms(&gyro) - 0.05).abs() < 0.006, "gyro {}", rms(&gyro));
    // 400 ug/sqrt(Hz) through 94 Hz of second order: 400e-6 * sqrt(1.11 * 94).
    assert!(
        (rms(&accel) - 0.0041).abs() < 0.0005,
        "accel {}",
        rms(&accel)
    );
}

#[test]
fn a_burst_that_lasts_past_the_next_sample_stays_whole() {
    let mut chip = chip(rate_dps(|t| [1000.0 * t; 3]), exact());
    let whole = read_i2c(&mut chip, 100 * MS, ACCEL_XOUT_H, 14);
    chip.start(100 * MS, 0x68, false);
    chip.write(100 * MS, ACCEL_XOUT_H);
    chip.start(100 * MS, 0x68, true);
    let slow: Vec<u8> = (0..14)
        .map(|n| chip.read(100 * MS + n * MS, n == 13))
        .collect();
    assert_eq!(slow, whole);
    chip.stop(114 * MS);
    assert_ne!(read_i2c(&mut chip, 114 * MS, ACCEL_XOUT_H, 14), whole);
}

#[test]
fn the_held_copy_is_that_of_the_first_start_of_a_transaction() {
    let mut chip = chip(rate_dps(|t| [1000.0 * t; 3]), exact());
    let before = read_i2c(&mut chip, 100 * MS, 0x43, 6);
    chip.start(100 * MS + 999_000, 0x68, false);
    chip.write(101 * MS, 0x43);
    chip.start(101 * MS, 0x68, true);
    let held: Vec<u8> = (0..6).map(|n| chip.read(101 * MS, n == 5)).collect();
    assert_eq!(held, before);
}

#[test]
fn one_byte_more_than_the_master_wanted_does_no_harm() {
    let mut chip = chip(rate_dps(|t| [1000.0 * t; 3]), exact());
    for ms in 10..20 {
        let long = read_i2c(&mut chip, ms * MS, INT_STATUS, 16);
        assert_eq!(long[0], DATA_READY);
        assert_eq!(long[1..15], read_i2c(&mut chip, ms * MS, ACCEL_XOUT_H, 14));
    }
}

#[test]
fn read_only_registers_ignore_writes() {
    let mut chip = chip(lively(), exact());
    let addresses = (INT_STATUS..=MOT_DETECT_STATUS).chain([WHO_AM_I]);
    let before: Vec<u8> = addresses
        .clone()
        .map(|address| chip.register(address))
        .collect();
    for address in addresses.clone() {
        write_i2c(&mut chip, 0, &[(address, 0xAA)]);
    }
    assert_eq!(
        before,
        addresses
            .map(|address| chip.register(address))
            .collect::<Vec<_>>()
    );
}

#[test]
fn a_device_reset_brings_back_the_reset_values() {
    let mut chip = chip(lively(), exact());
    chip.advance(10 * MS);
    write_i2c(&mut chip, 10 * MS, &[(PWR_MGMT_1, 0x80)]);
    assert_eq!(read_i2c(&mut chip, 10 * MS, PWR_MGMT_1, 1), [0x40]);
    assert_eq!(read_i2c(&mut chip, 10 * MS, GYRO_CONFIG, 2), [0, 0]);
    assert_eq!(read_i2c(&mut chip, 10 * MS, ACCEL_XOUT_H, 14), [0; 14]);
    chip.advance(SECOND);
    assert_eq!(chip.samples(), 10);
}

#[test]
fn a_brown_out_in_flight_looks_like_power_on() {
    let mut chip = chip(lively(), exact());
    chip.brown_out(10 * MS);
    assert_eq!(chip.next_event(), u64::MAX);
    assert_eq!(chip.register(PWR_MGMT_1), 0x40);
    write_i2c(&mut chip, 20 * MS, &FLIGHT);
    assert_eq!(rising_edges(&mut chip, 22 * MS), [21 * MS, 22 * MS]);
}

#[test]
fn sleep_stops_the_samples_and_waking_starts_a_new_period() {
    let mut chip = chip(lively(), exact());
    write_i2c(&mut chip, 3 * MS / 2, &[(PWR_MGMT_1, 0x41)]);
    chip.advance(100 * MS);
    assert_eq!(chip.samples(), 1);
    write_i2c(&mut chip, 100 * MS + 500, &[(PWR_MGMT_1, 0x01)]);
    assert_eq!(rising_edges(&mut chip, 102 * MS), [101 * MS + 500]);
}

#[test]
fn standby_freezes_the_axes_it_names() {
    let mut chip = chip(rate_dps(|t| [1000.0 * t; 3]), exact());
    let before = big(&read_i2c(&mut chip, 100 * MS, 0x43, 6));
    write_i2c(&mut chip, 100 * MS, &[(PWR_MGMT_2, 0x04)]);
    let after = big(&read_i2c(&mut chip, 200 * MS, 0x43, 6));
    assert_eq!(after[0], before[0]);
    assert!(after[1] > before[1]);
}

#[test]
fn an_absent_gyro_answers_zeros_while_data_ready_goes_on() {
    let present = crate::Present {
        gyro: false,
        ..Default::default()
    };
    let mut chip = chip(lively(), ChipOptions { present, ..real(5) });
    chip.advance(SECOND);
    assert!(chip.samples() > 900);
    let bytes = read_i2c(&mut chip, SECOND, ACCEL_XOUT_H, 14);
    assert_eq!(big(&bytes[8..]), [0; 3]);
    assert_ne!(big(&bytes), [0; 3]);
}

proptest! {
    #[test]
    fn samples_do_not_depend_on_when_the_chip_is_asked(
        seed: u64,
        mut asked in prop::collection::vec(0..50 * MS, 0..60),
    ) {
        let mut lazy = chip(lively(), real(seed));
        let mut busy = chip(lively(), real(seed));
        asked.sort_unstable();
        for at in asked {
            read_i2c(&mut busy, at, ACCEL_XOUT_H, 14);
            busy.next_event();
        }
        for at in [50 * MS, 51 * MS, 60 * MS] {
            prop_assert_eq!(
                read_i2c(&mut lazy, at, ACCEL_XOUT_H, 14),
                read_i2c(&mut busy, at, ACCEL_XOUT_H, 14)
            );
        }
    }

    #[test]
    fn every_rate_within_range_is_quantised_to_the_nearest_code(dps in -1990.0..1990.0_f64) {
        let mut chip = chip(rate_dps(move |_| [dps, 0.0, 0.0]), exact());
        let code = big(&read_i2c(&mut chip, 20 * MS, 0x43, 6))[0];
        prop_assert!((f64::from(code) - dps * 16.4).abs() <= 0.501);
    }

    #[test]
    fn next_event_never_lies_in_the_past(times in prop::collection::vec(0..2 * MS, 1..50)) {
        let mut chip = chip(lively(), real(1));
        let mut now = 0;
        for step in times {
            now += step;
            chip.advance(now);
            prop_assert!(chip.next_event() > now);
        }
    }
}

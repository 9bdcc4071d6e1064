//! The accelerometer's high-pass filter, its resets and its routing.

use std::sync::Arc;

use super::super::accelerometer_registers::*;
use super::super::*;
use crate::testing::*;
use crate::{Chip, StimulusSource};

/// Generator 1 on high-passed data, latched on the pin, 100 Hz normal mode.
fn chip(source: Arc<dyn StimulusSource>, filter: u8, threshold: u8) -> Accelerometer {
    let mut chip = Accelerometer::new(source, exact());
    let values = [
        (CTRL_REG4_A, 0x91),
        (CTRL_REG2_A, filter),
        (CTRL_REG3_A, 0x40),
        (CTRL_REG5_A, 0x08),
        (INT1_CFG_A, 0x2A),
        (INT1_THS_A, threshold),
        (CTRL_REG1_A, 0x57),
    ];
    write_spi(&mut chip, 0, &values);
    chip
}

/// One g up, and half a g sideways from `from_s` on.
fn sideways(from_s: f64) -> Arc<dyn StimulusSource> {
    force_g(move |t| [if t >= from_s { 0.5 } else { 0.0 }, 0.0, 1.0])
}

/// Reads the reference and releases the latch, as firmware does after a run.
fn snap(chip: &mut Accelerometer, at_ns: u64) {
    read_accel(chip, at_ns, REFERENCE_A, 1);
    read_accel(chip, at_ns, INT1_SRC_A, 1);
}

fn codes(chip: &mut Accelerometer, at_ns: u64) -> [i16; 3] {
    little(&read_accel(chip, at_ns, OUT_X_L_A, 6))
}

#[test]
fn without_a_snap_gravity_trips_the_generator_after_power_up() {
    let mut chip = chip(sideways(9.0), 0x31, 10);
    assert_eq!(rising_edges(&mut chip, 100 * MS), [10 * MS]);
    assert_eq!(chip.register(INT1_SRC_A), 0x60);
}

#[test]
fn reading_the_reference_in_mode_0_makes_the_present_sample_zero() {
    let mut chip = chip(sideways(0.195), 0x31, 10);
    snap(&mut chip, 15 * MS);
    assert!(
        rising_edges(&mut chip, 190 * MS).is_empty(),
        "at rest nothing trips"
    );
    assert_eq!(rising_edges(&mut chip, 300 * MS), [200 * MS]);
    snap(&mut chip, 305 * MS);
    assert_eq!(
        rising_edges(&mut chip, SECOND),
        Vec::<u64>::new(),
        "the new posture is the zero"
    );
}

#[test]
fn with_the_lowest_corner_the_change_that_trips_is_the_one_since_the_snap() {
    // 0.2 Hz at 100 Hz: a threshold of 14 counts is 448 mg of change.
    for (threshold, trips) in [(14, true), (16, false)] {
        let mut chip = chip(sideways(0.195), 0x31, threshold);
        snap(&mut chip, 15 * MS);
        chip.advance(300 * MS);
        assert_eq!(chip.interrupt(), trips, "threshold {threshold}");
    }
}

#[test]
fn modes_1_2_and_3_are_not_reset_by_reading_the_reference() {
    for mode in [0x40, 0x80, 0xC0] {
        let mut chip = chip(sideways(9.0), mode | 0x39, 127);
        let before = codes(&mut chip, 15 * MS);
        assert!(before[2] > 6000, "gravity passes at first: {before:?}");
        read_accel(&mut chip, 15 * MS, REFERENCE_A, 1);
        let after = codes(&mut chip, 25 * MS);
        assert!(after[2] > 6000, "mode {mode:#04x}: {after:?}");
    }
}

#[test]
fn reference_mode_subtracts_the_register_from_every_axis() {
    // At 4 g a count of REFERENCE weighs 31 mg: 16 counts are 496 mg.
    let mut chip = chip(force_g(|_| [0.5, 0.5, 1.0]), 0x49, 10);
    write_spi(&mut chip, 0, &[(REFERENCE_A, 16)]);
    let [x, y, z] = codes(&mut chip, SECOND).map(|code| f64::from(code) / 64.0 * 7.82);
    assert!(x.abs() < 8.0 && y.abs() < 8.0, "{x} {y}");
    assert!((z - 504.0).abs() < 8.0, "{z}");
}

#[test]
fn mode_3_resets_itself_at_the_interrupt() {
    let mut chip = chip(sideways(0.195), 0xF1, 10);
    chip.advance(15 * MS);
    read_accel(&mut chip, 15 * MS, INT1_SRC_A, 1);
    assert_eq!(
        rising_edges(&mut chip, 190 * MS),
        Vec::<u64>::new(),
        "gravity tripped once, then was zero"
    );
    assert_eq!(rising_edges(&mut chip, 300 * MS), [200 * MS]);
    read_accel(&mut chip, 300 * MS, INT1_SRC_A, 1);
    assert!(rising_edges(&mut chip, SECOND).is_empty());
    assert_eq!(chip.triggers(), [2, 0]);
}

#[test]
fn filtered_data_reaches_the_outputs_only_with_fds() {
    let mut raw = chip(sideways(9.0), 0x31, 127);
    snap(&mut raw, 15 * MS);
    assert_eq!(codes(&mut raw, 100 * MS), [0, 0, 128 << 6]);
    let mut filtered = chip(sideways(9.0), 0x39, 127);
    snap(&mut filtered, 15 * MS);
    assert_eq!(codes(&mut filtered, 100 * MS), [0, 0, 0]);
}

#[test]
fn a_generator_without_its_filter_bit_sees_raw_data() {
    let mut chip = chip(sideways(9.0), 0x32, 10);
    snap(&mut chip, 15 * MS);
    assert_eq!(
        rising_edges(&mut chip, 100 * MS),
        [20 * MS],
        "gravity again"
    );
}

#[test]
fn a_step_decays_with_the_corner_of_every_rate_and_setting() {
    // AN4825: corners in Hz by HPCF; 7 is 400 Hz, 9 is 1344 Hz.
    let rows = [
        (2, 10.0, [0.2, 0.08, 0.04, 0.02]),
        (3, 25.0, [0.5, 0.2, 0.1, 0.05]),
        (4, 50.0, [1.0, 0.5, 0.2, 0.1]),
        (5, 100.0, [2.0, 1.0, 0.5, 0.2]),
        (6, 200.0, [4.0, 2.0, 1.0, 0.5]),
        (7, 400.0, [8.0, 4.0, 2.0, 1.0]),
        (9, 1344.0, [32.0, 16.0, 8.0, 4.0]),
    ];
    for (code, rate, corners) in rows {
        for (setting, corner) in corners.into_iter().enumerate() {
            let filter = 0x08 | u8::try_from(setting).unwrap_or(0) << 4;
            let mut chip = chip(force_g(|_| [1.5, 0.0, 0.0]), filter, 127);
            write_spi(&mut chip, 0, &[(CTRL_REG1_A, code << 4 | 0x07)]);
            // The first sample passes whole; n periods later it has decayed.
            let periods = 20.0;
            let at_ns = ((periods + 1.5) / rate * 1e9) as u64;
            let got = f64::from(codes(&mut chip, at_ns)[0]) / 64.0 * 0.00782;
            let expected = 1.5 * (-std::f64::consts::TAU * corner * periods / rate).exp();
            assert!(
                (got - expected).abs() < 0.01,
                "{rate} Hz {corner} Hz: {got} {expected}"
            );
        }
    }
}

#[test]
fn at_400_hz_and_1_hz_half_a_step_is_forgotten_within_a_tenth_of_a_second() {
    let mut chip = chip(force_g(|_| [1.0, 0.0, 0.0]), 0x38, 127);
    write_spi(&mut chip, 0, &[(CTRL_REG1_A, 0x77)]);
    let left = f64::from(codes(&mut chip, 104 * MS)[0]) / 64.0 * 0.00782;
    assert!((0.50..0.56).contains(&left), "{left}");
}

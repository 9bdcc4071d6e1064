//! The motion detector against PS-MPU-6000A section 8.3.

use super::super::registers::*;
use super::super::*;
use crate::testing::*;

/// Motion only: hold mode, 10 counts of 32 mg = 0.32 g, 3 ms, decrement 1.
const MOTION_HOLD: [(u8, u8); 7] = [
    (PWR_MGMT_1, 0x01),
    (CONFIG, 0),
    (ACCEL_CONFIG, 0x18 | 7),
    (MOT_THR, 10),
    (MOT_DUR, 3),
    (MOT_DETECT_CTRL, 0x01),
    (INT_ENABLE, MOTION),
];

/// At rest, then `step` in g from 100 ms on.
fn stepped(step: [f64; 3]) -> Arc<dyn StimulusSource> {
    force_g(move |t| {
        let moved = if t >= 0.1 { step } else { [0.0; 3] };
        [moved[0], moved[1], 1.0 + moved[2]]
    })
}

fn chip(source: Arc<dyn StimulusSource>, extra: &[(u8, u8)]) -> Mpu6050 {
    let mut chip = Mpu6050::new(source, exact());
    write_i2c(&mut chip, 0, &MOTION_HOLD);
    write_i2c(&mut chip, 0, extra);
    chip
}

#[test]
fn a_held_zero_detects_a_lasting_change_after_the_duration() {
    // 0.4 g passes 0.32 g in the second filtered sample at 101 ms; three counts.
    let mut chip = chip(stepped([0.0, 0.0, 0.4]), &[]);
    let edges = rising_edges(&mut chip, 300 * MS);
    assert_eq!(edges, [103 * MS], "{edges:?}");
    assert_eq!(read_i2c(&mut chip, 300 * MS, INT_STATUS, 1), [MOTION]);
}

#[test]
fn the_threshold_counts_32_mg_and_must_be_exceeded() {
    for code in [1_u8, 10, 50, 127, 255] {
        let threshold = f64::from(code) * 0.032;
        for (step, motions) in [(threshold - 0.001, 0), (threshold + 0.001, 1)] {
            let mut chip = chip(stepped([step, 0.0, 0.0]), &[(MOT_THR, code)]);
            chip.advance(300 * MS);
            assert_eq!(chip.motions(), motions, "code {code}, {step} g");
        }
    }
}

#[test]
fn the_weight_of_a_threshold_count_belongs_to_the_die() {
    let options = ChipOptions {
        motion_threshold_lsb_mg: 2.0,
        ..exact()
    };
    let mut chip = Mpu6050::new(stepped([0.03, 0.0, 0.0]), options);
    write_i2c(&mut chip, 0, &MOTION_HOLD);
    chip.advance(300 * MS);
    assert_eq!(chip.motions(), 1);
    assert!((chip.motion_threshold() - 0.02 * 9.80665).abs() < 1e-12);
}

#[test]
fn the_status_names_axis_and_sign_and_is_cleared_by_reading() {
    for (step, bits) in [
        ([-0.5, 0.0, 0.0], 0x80),
        ([0.5, 0.0, 0.0], 0x40),
        ([0.0, -0.5, 0.0], 0x20),
        ([0.0, 0.5, 0.0], 0x10),
        ([0.0, 0.0, -0.5], 0x08),
        ([0.5, 0.5, 0.5], 0x54),
    ] {
        let mut chip = chip(stepped(step), &[]);
        assert_eq!(read_i2c(&mut chip, 200 * MS, MOT_DETECT_STATUS, 1), [bits]);
        assert_eq!(read_i2c(&mut chip, 200 * MS, MOT_DETECT_STATUS, 1), [0]);
    }
}

#[test]
fn a_reset_filter_never_sees_motion() {
    let mut chip = chip(stepped([2.0, 2.0, 2.0]), &[(ACCEL_CONFIG, 0x18)]);
    chip.advance(SECOND);
    assert_eq!(chip.motions(), 0);
}

#[test]
fn the_high_pass_forgets_a_step_at_its_corner() {
    // A step of 1 g falls below 0.32 g after tau * ln(1/0.32) = tau * 1.139;
    // with one time constant 1/(2 pi f): 36, 72, 145, 288 ms.
    for (filter, hz) in [(1, 5.0), (2, 2.5), (3, 1.25), (4, 0.63)] {
        let lasts_ms = 1139.4 / (std::f64::consts::TAU * hz);
        for (duration, motions) in [(lasts_ms - 4.0, 1), (lasts_ms + 4.0, 0)] {
            let extra = [
                (ACCEL_CONFIG, 0x18 | filter),
                (MOT_DUR, duration.min(255.0) as u8),
            ];
            let motions = if duration > 255.0 { 1 } else { motions };
            // Two seconds at rest settle the filter on gravity first.
            let source = force_g(|t| [f64::from(u8::from(t >= 4.0)), 0.0, 0.0]);
            let mut chip = chip(source, &extra);
            chip.advance(6 * SECOND);
            assert_eq!(chip.motions(), motions, "{hz} Hz, {duration} ms");
        }
    }
}

/// Whether motion in `of_four` of every four milliseconds reaches a duration.
fn reaches(of_four: u32, duration: u8, control: u8) -> bool {
    let mut registers = Registers::at_reset();
    for (address, value) in MOTION_HOLD {
        registers.write(address, value);
    }
    registers.write(MOT_DUR, duration);
    registers.write(MOT_DETECT_CTRL, control);
    let setup = Setup::of(&registers);
    let mut detector = MotionDetector::default();
    (0..1000).any(|ms| {
        let moving = ms > 10 && ms % 4 < of_four;
        let accel = [if moving { 1.0 } else { 0.0 }, 0.0, 0.0];
        detector.step(accel, &setup, &registers, 0.32)
    })
}

#[test]
fn the_counter_falls_as_the_decrement_says() {
    // Up by 2, then down by 2 * decrement (0: to zero), per four milliseconds.
    for control in 0..=3 {
        assert!(!reaches(2, 4, control), "control {control}");
    }
    // Up by 3, then down by 0 (to zero), 1, 2, 4.
    let reached = [0, 1, 2, 3].map(|control| reaches(3, 8, control));
    assert_eq!(reached, [false, true, true, false]);
}

#[test]
fn detection_waits_for_the_accelerometer_to_start() {
    let moving = || force_g(|t| [f64::from(u8::from(t > 0.0015)), 0.0, 0.0]);
    let first = |control| {
        let mut chip = chip(moving(), &[(MOT_DUR, 1), (MOT_DETECT_CTRL, control)]);
        rising_edges(&mut chip, 50 * MS).first().copied()
    };
    assert_eq!(first(0x00), Some(5 * MS));
    assert_eq!(first(0x30), Some(8 * MS));
}

#[test]
fn motion_and_data_ready_share_the_pin_and_keep_apart_in_the_status() {
    let mut chip = chip(
        stepped([0.5, 0.0, 0.0]),
        &[(CONFIG, 1), (INT_ENABLE, MOTION | DATA_READY)],
    );
    chip.advance(99 * MS);
    assert_eq!(read_i2c(&mut chip, 99 * MS, INT_STATUS, 1), [DATA_READY]);
    chip.advance(120 * MS);
    assert_eq!(
        read_i2c(&mut chip, 120 * MS, INT_STATUS, 1),
        [MOTION | DATA_READY]
    );
}

#[test]
fn a_disabled_motion_interrupt_still_counts_in_the_status_register() {
    let mut chip = chip(stepped([0.5, 0.0, 0.0]), &[(INT_ENABLE, 0)]);
    chip.advance(200 * MS);
    assert_eq!((chip.motions(), chip.interrupts()), (1, 0));
    assert_eq!(chip.register(MOT_DETECT_STATUS), 0x40);
}

//! Threshold codes: exact inverses, rounded down, zero refused.

use proptest::prelude::*;
use reflex_drivers::{
    lsm303agr::{AccelFullScale, AccelThreshold, MagThreshold, ThresholdDuration},
    mpu6050::{MotionThreshold, NOMINAL_MOTION_STEP},
    quantity::{Gauss, MetersPerSecondSquared},
    threshold::ThresholdError,
};

const FULL_SCALES: [AccelFullScale; 4] = [
    AccelFullScale::G2,
    AccelFullScale::G4,
    AccelFullScale::G8,
    AccelFullScale::G16,
];

/// The next `f32` below.
fn just_below(value: f32) -> f32 {
    f32::from_bits(value.to_bits() - 1)
}

#[test]
fn every_accelerometer_code_is_the_exact_inverse_of_its_level() {
    for full_scale in FULL_SCALES {
        for code in 1..=127 {
            let threshold = AccelThreshold::from_code(code).unwrap();
            let level = threshold.level(full_scale);
            assert_eq!(AccelThreshold::round_down(level, full_scale), Ok(threshold));
            let below = MetersPerSecondSquared(just_below(level.0));
            let expected = AccelThreshold::from_code(code - 1);
            assert_eq!(AccelThreshold::round_down(below, full_scale), expected);
        }
    }
}

#[test]
fn every_magnetometer_code_is_the_exact_inverse_of_its_level() {
    for code in 1..=u16::MAX {
        let threshold = MagThreshold::from_code(code).unwrap();
        let level = threshold.level();
        assert_eq!(MagThreshold::round_down(level), Ok(threshold));
        let below = Gauss(just_below(level.0));
        assert_eq!(
            MagThreshold::round_down(below),
            MagThreshold::from_code(code - 1)
        );
    }
}

#[test]
fn every_motion_code_is_the_exact_inverse_of_its_level() {
    for step in [NOMINAL_MOTION_STEP, MetersPerSecondSquared(0.019_613_3)] {
        for code in 1..=u8::MAX {
            let threshold = MotionThreshold::from_code(code).unwrap();
            let level = threshold.level(step);
            assert_eq!(MotionThreshold::round_down(level, step), Ok(threshold));
            let below = MetersPerSecondSquared(just_below(level.0));
            let expected = MotionThreshold::from_code(code - 1);
            assert_eq!(MotionThreshold::round_down(below, step), expected);
        }
    }
}

#[test]
fn steps_are_those_of_the_datasheet() {
    for (full_scale, milli_g) in FULL_SCALES.into_iter().zip([16.0, 32.0, 62.0, 186.0]) {
        let step = full_scale.threshold_step().0;
        assert!((step / (milli_g * 9.806_65e-3) - 1.0).abs() < 1.0e-6);
    }
    assert_eq!(MagThreshold::from_code(2).unwrap().level(), Gauss(0.003));
}

#[test]
fn code_zero_is_refused_whatever_leads_to_it() {
    let refused = ThresholdError::BelowOneStep;
    assert_eq!(AccelThreshold::from_code(0), Err(refused));
    assert_eq!(MagThreshold::from_code(0), Err(refused));
    assert_eq!(MotionThreshold::from_code(0), Err(refused));
    for value in [
        0.0,
        -0.0,
        -1.0,
        f32::NEG_INFINITY,
        f32::MIN_POSITIVE,
        1.0e-4,
    ] {
        let acceleration = MetersPerSecondSquared(value);
        for full_scale in FULL_SCALES {
            assert_eq!(
                AccelThreshold::round_down(acceleration, full_scale),
                Err(refused)
            );
        }
        assert_eq!(MagThreshold::round_down(Gauss(value)), Err(refused));
        let motion = MotionThreshold::round_down(acceleration, NOMINAL_MOTION_STEP);
        assert_eq!(motion, Err(refused));
    }
}

#[test]
fn not_a_number_is_refused_and_large_values_end_at_the_largest_code() {
    let nan = MetersPerSecondSquared(f32::NAN);
    let refused = ThresholdError::NotANumber;
    assert_eq!(
        AccelThreshold::round_down(nan, AccelFullScale::G4),
        Err(refused)
    );
    assert_eq!(MagThreshold::round_down(Gauss(f32::NAN)), Err(refused));
    assert_eq!(
        MotionThreshold::round_down(nan, NOMINAL_MOTION_STEP),
        Err(refused)
    );
    for value in [1.0e6, f32::MAX, f32::INFINITY] {
        let acceleration = MetersPerSecondSquared(value);
        for full_scale in FULL_SCALES {
            let threshold = AccelThreshold::round_down(acceleration, full_scale);
            assert_eq!(threshold, Ok(AccelThreshold::MAX));
        }
        assert_eq!(
            MagThreshold::round_down(Gauss(value)),
            Ok(MagThreshold::MAX)
        );
        let motion = MotionThreshold::round_down(acceleration, NOMINAL_MOTION_STEP);
        assert_eq!(motion, Ok(MotionThreshold::MAX));
    }
}

#[test]
fn a_step_that_is_no_step_is_refused() {
    for step in [0.0, -1.0, f32::NAN, f32::INFINITY, 1.0e-40] {
        let result =
            MotionThreshold::round_down(MetersPerSecondSquared(1.0), MetersPerSecondSquared(step));
        assert_eq!(result, Err(ThresholdError::NotANumber));
    }
}

#[test]
fn codes_that_do_not_fit_the_register_are_refused() {
    assert_eq!(
        AccelThreshold::from_code(128),
        Err(ThresholdError::CodeTooLarge)
    );
    assert_eq!(
        ThresholdDuration::samples(127).map(ThresholdDuration::code),
        Some(127)
    );
    assert_eq!(ThresholdDuration::samples(128), None);
}

proptest! {
    #[test]
    fn an_accelerometer_threshold_is_never_above_its_value_and_less_than_a_step_below(
        value in 0.2_f32..400.0,
    ) {
        for full_scale in FULL_SCALES {
            match AccelThreshold::round_down(MetersPerSecondSquared(value), full_scale) {
                Ok(threshold) => {
                    prop_assert!(threshold.level(full_scale).0 <= value);
                    if let Ok(next) = AccelThreshold::from_code(threshold.code() + 1) {
                        prop_assert!(next.level(full_scale).0 > value);
                    }
                }
                Err(_) => prop_assert!(value < full_scale.threshold_step().0),
            }
        }
    }

    #[test]
    fn a_magnetometer_threshold_is_never_above_its_value_and_less_than_a_step_below(
        value in 0.0015_f32..120.0,
    ) {
        let threshold = MagThreshold::round_down(Gauss(value)).unwrap();
        prop_assert!(threshold.level().0 <= value);
        if let Some(code) = threshold.code().checked_add(1) {
            prop_assert!(MagThreshold::from_code(code).unwrap().level().0 > value);
        }
    }

    #[test]
    fn no_value_at_all_panics(value: f32, step: f32) {
        let acceleration = MetersPerSecondSquared(value);
        for full_scale in FULL_SCALES {
            let _ = AccelThreshold::round_down(acceleration, full_scale);
        }
        let _ = MagThreshold::round_down(Gauss(value));
        let _ = MotionThreshold::round_down(acceleration, MetersPerSecondSquared(step));
    }
}

//! The accelerometer die against numbers worked out from its datasheet.

use std::sync::Arc;

use proptest::prelude::*;

use super::super::accelerometer_registers::*;
use super::super::*;
use crate::testing::*;
use crate::{Chip, ChipOptions, OwnClock, Present, StimulusSource};

/// 100 Hz high resolution, +-4 g, block data update, three wires.
const FLIGHT: [(u8, u8); 2] = [(CTRL_REG4_A, 0x99), (CTRL_REG1_A, 0x57)];
/// Any axis above the threshold, latched, on INT_1_XL.
const ANY_HIGH: [(u8, u8); 3] = [(INT1_CFG_A, 0x2A), (CTRL_REG5_A, 0x08), (CTRL_REG3_A, 0x40)];

fn chip(
    source: Arc<dyn StimulusSource>,
    options: ChipOptions,
    extra: &[(u8, u8)],
) -> Accelerometer {
    let mut chip = Accelerometer::new(source, options);
    write_spi(&mut chip, 0, &FLIGHT);
    write_spi(&mut chip, 0, extra);
    chip
}

fn codes(chip: &mut Accelerometer, at_ns: u64) -> [i16; 3] {
    little(&read_accel(chip, at_ns, OUT_X_L_A, 6))
}

#[test]
fn registers_wake_with_the_datasheets_values() {
    let chip = Accelerometer::new(lively(), exact());
    for (address, value) in [
        (WHO_AM_I_A, 0x33),
        (TEMP_CFG_REG_A, 0x00),
        (CTRL_REG1_A, 0x07),
        (CTRL_REG2_A, 0x00),
        (CTRL_REG4_A, 0x00),
        (STATUS_REG_A, 0x00),
        (INT1_CFG_A, 0x00),
        (INT1_THS_A, 0x00),
        (0x3F, 0x00),
    ] {
        assert_eq!(chip.register(address), value, "{address:#04x}");
    }
}

#[test]
fn reserved_bits_and_read_only_registers_ignore_writes() {
    let mut chip = chip(lively(), exact(), &[]);
    for address in [
        WHO_AM_I_A,
        STATUS_REG_A,
        OUT_X_L_A,
        INT1_SRC_A,
        FIFO_SRC_REG_A,
        0x00,
    ] {
        let before = chip.register(address);
        write_spi(&mut chip, 0, &[(address, 0xA5)]);
        assert_eq!(chip.register(address), before, "{address:#04x}");
    }
    write_spi(&mut chip, 0, &[(INT1_THS_A, 0xFF), (CTRL_REG6_A, 0xFF)]);
    assert_eq!(chip.register(INT1_THS_A), 0x7F);
    assert_eq!(chip.register(CTRL_REG6_A), 0xFA);
}

#[test]
fn every_data_rate_code_gives_its_rate_in_every_mode() {
    const NORMAL: [u64; 16] = [0, 1, 10, 25, 50, 100, 200, 400, 0, 1344, 0, 0, 0, 0, 0, 0];
    const LOW: [u64; 16] = [
        0, 1, 10, 25, 50, 100, 200, 400, 1620, 5376, 0, 0, 0, 0, 0, 0,
    ];
    for (low_power, rates) in [(0x00, NORMAL), (0x08, LOW)] {
        for (code, rate) in rates.into_iter().enumerate() {
            let code = u8::try_from(code).unwrap_or(0);
            let mut chip = Accelerometer::new(lively(), exact());
            write_spi(&mut chip, 0, &[(CTRL_REG1_A, code << 4 | low_power | 0x07)]);
            chip.advance(SECOND);
            assert_eq!(chip.samples(), rate, "code {code}");
        }
    }
}

#[test]
fn high_resolution_starts_after_seven_periods_and_other_modes_after_one() {
    let mut fine = chip(lively(), exact(), &[]);
    assert_eq!(fine.next_event(), 70 * MS);
    fine.advance(70 * MS);
    assert_eq!((fine.samples(), fine.next_event()), (1, 80 * MS));
    let normal = chip(lively(), exact(), &[(CTRL_REG4_A, 0x91)]);
    assert_eq!(normal.next_event(), 10 * MS);
}

#[test]
fn rewriting_the_same_rate_does_not_disturb_the_clock() {
    let mut chip = chip(lively(), exact(), &[(CTRL_REG4_A, 0x91)]);
    write_spi(&mut chip, 7 * MS, &FLIGHT[1..]);
    assert_eq!(chip.next_event(), 10 * MS);
    write_spi(&mut chip, 7 * MS, &[(CTRL_REG1_A, 0x77)]);
    assert_eq!(chip.next_event(), 9 * MS + MS / 2);
}

#[test]
fn the_oscillator_error_is_the_options_or_drawn_within_five_per_cent() {
    let samples = |options| {
        let mut chip = chip(lively(), options, &[(CTRL_REG4_A, 0x91)]);
        chip.advance(10 * SECOND);
        chip.samples()
    };
    assert_eq!(
        samples(ChipOptions {
            oscillator_error: Some(-0.03),
            ..exact()
        }),
        970
    );
    let drawn: Vec<u64> = (0..20).map(|seed| samples(real(seed))).collect();
    assert!(drawn.iter().all(|n| (950..=1050).contains(n)), "{drawn:?}");
    assert!(drawn.iter().any(|n| n.abs_diff(1000) > 20), "{drawn:?}");
}

#[test]
fn half_a_g_reads_as_the_datasheets_sensitivity_says() {
    // 500 mg / mg per digit, rounded, left-justified by 4, 6 or 8 bits.
    const CODES: [[i16; 4]; 3] = [
        [510 << 4, 256 << 4, 128 << 4, 43 << 4],
        [128 << 6, 64 << 6, 32 << 6, 11 << 6],
        [32 << 8, 16 << 8, 8 << 8, 3 << 8],
    ];
    for (mode, row) in CODES.into_iter().enumerate() {
        for (scale, code) in row.into_iter().enumerate() {
            let high_resolution = u8::from(mode == 0) << 3;
            let low_power = u8::from(mode == 2) << 3;
            let scale_bits = u8::try_from(scale).unwrap_or(0) << 4;
            let extra = [
                (CTRL_REG4_A, 0x81 | scale_bits | high_resolution),
                (CTRL_REG1_A, 0x57 | low_power),
            ];
            let mut chip = chip(force_g(|_| [0.5, -0.5, 0.0]), exact(), &extra);
            assert_eq!(
                codes(&mut chip, SECOND),
                [code, -code, 0],
                "mode {mode} scale {scale}"
            );
        }
    }
}

#[test]
fn values_beyond_full_scale_clip() {
    let mut chip = chip(
        force_g(|_| [3.0, -3.0, 0.0]),
        exact(),
        &[(CTRL_REG4_A, 0x89)],
    );
    assert_eq!(codes(&mut chip, SECOND), [2047 << 4, -32768, 0]);
}

#[test]
fn a_disabled_axis_reads_zero() {
    let mut chip = chip(force_g(|_| [1.0; 3]), exact(), &[(CTRL_REG1_A, 0x55)]);
    let [x, y, z] = codes(&mut chip, SECOND);
    assert_eq!(y, 0);
    assert!(x > 0 && z > 0);
}

#[test]
fn high_resolution_has_a_ninth_of_the_rate_as_bandwidth() {
    let hz = 100.0 / 9.0;
    let wave = move |t: f64| [(std::f64::consts::TAU * hz * t).sin(), 0.0, 0.0];
    let mut chip = chip(force_g(wave), exact(), &[(CTRL_REG1_A, 0x57)]);
    let peak = (10..410)
        .map(|n| codes(&mut chip, n * 10 * MS)[0].unsigned_abs())
        .max();
    let gain = f64::from(peak.unwrap_or(0)) / 16.0 * 0.00195;
    assert!((0.68..0.72).contains(&gain), "{gain}");
}

#[test]
fn status_and_data_ready_pin_follow_the_data() {
    let mut chip = chip(lively(), exact(), &[(CTRL_REG3_A, 0x10)]);
    assert!(!chip.interrupt());
    assert_eq!(
        rising_edges(&mut chip, 80 * MS),
        [70 * MS],
        "it stays high until read"
    );
    assert_eq!(chip.register(STATUS_REG_A), 0xFF);
    codes(&mut chip, 81 * MS);
    assert!(!chip.interrupt());
    assert_eq!(read_accel(&mut chip, 81 * MS, STATUS_REG_A, 1), [0x00]);
    chip.advance(90 * MS);
    assert_eq!(chip.register(STATUS_REG_A), 0x0F);
}

#[test]
fn thresholds_trip_where_the_datasheet_says_over_all_codes() {
    let scales = [(16.0, 0.98), (32.0, 1.95), (62.0, 3.9), (186.0, 11.72)];
    for (scale, (count_mg, digit_mg)) in scales.into_iter().enumerate() {
        for code in 1..=127_u8 {
            let threshold = f64::from(code) * count_mg;
            let digits = (threshold / digit_mg).floor();
            let exact_hit = (digits * digit_mg - threshold).abs() < 1e-6;
            for (digits, trips) in [(digits, false), (digits + 1.0, true)] {
                if digits > 2047.0 || exact_hit && !trips {
                    continue;
                }
                let g = digits * digit_mg / 1000.0;
                let bits = 0x89 | u8::try_from(scale).unwrap_or(0) << 4;
                let mut chip = chip(force_g(move |_| [0.0, -g, 0.0]), exact(), &ANY_HIGH);
                write_spi(&mut chip, 0, &[(CTRL_REG4_A, bits), (INT1_THS_A, code)]);
                chip.advance(70 * MS);
                assert_eq!(chip.interrupt(), trips, "scale {scale} code {code} {g} g");
            }
        }
    }
}

#[test]
fn the_threshold_is_reported_in_si() {
    let chip = chip(lively(), exact(), &[(INT1_THS_A, 5), (INT2_THS_A, 10)]);
    let [first, second] = chip.thresholds();
    assert!((first - 0.160 * 9.80665).abs() < 1e-12);
    assert!((second - 0.320 * 9.80665).abs() < 1e-12);
}

#[test]
fn a_latched_interrupt_holds_the_pin_until_its_source_is_read() {
    let bump = force_g(|t| [f64::from(u8::from((0.195..0.215).contains(&t))), 0.0, 0.0]);
    let mut chip = chip(bump, exact(), &ANY_HIGH);
    write_spi(&mut chip, 0, &[(CTRL_REG4_A, 0x91), (INT1_THS_A, 10)]);
    assert_eq!(rising_edges(&mut chip, 500 * MS), [200 * MS]);
    assert!(chip.interrupt());
    assert_eq!(read_accel(&mut chip, 500 * MS, INT1_SRC_A, 1), [0x42]);
    assert!(!chip.interrupt());
    assert_eq!(read_accel(&mut chip, 500 * MS, INT1_SRC_A, 1), [0x00]);
    assert_eq!(chip.triggers(), [1, 0]);
}

#[test]
fn the_duration_counts_samples() {
    let step = || force_g(|t| [f64::from(u8::from(t > 0.195)), 0.0, 0.0]);
    for (duration, first_ms) in [(0, 200), (1, 210), (12, 320)] {
        let extra = [
            (CTRL_REG4_A, 0x91),
            (INT1_THS_A, 10),
            (INT1_DURATION_A, duration),
        ];
        let mut chip = chip(step(), exact(), &ANY_HIGH);
        write_spi(&mut chip, 0, &extra);
        assert_eq!(rising_edges(&mut chip, 500 * MS), [first_ms * MS]);
    }
}

#[test]
fn both_generators_reach_both_pins_with_either_polarity() {
    for (pin_1, pin_2, generator) in [(0x40, 0x40, 0), (0x20, 0x20, 1)] {
        let base = [INT1_CFG_A, INT2_CFG_A][generator];
        let extra = [
            (base, 0x2A),
            (base + 2, 10),
            (CTRL_REG3_A, pin_1),
            (CTRL_REG6_A, pin_2),
        ];
        let mut chip = chip(force_g(|_| [1.0, 0.0, 0.0]), exact(), &extra);
        assert!(!chip.interrupt() && !chip.interrupt_2());
        chip.advance(70 * MS);
        assert!(chip.interrupt() && chip.interrupt_2());
        write_spi(&mut chip, 70 * MS, &[(CTRL_REG6_A, pin_2 | 0x02)]);
        assert!(!chip.interrupt() && !chip.interrupt_2());
    }
}

#[test]
fn temperature_counts_from_25_degrees_in_the_modes_resolution() {
    let warm: Arc<dyn StimulusSource> = Arc::new(|_| crate::Stimulus {
        temperature_c: 35.0,
        ..crate::Stimulus::default()
    });
    for (low_power, code) in [(0x00, 40_i16 << 6), (0x08, 10 << 8)] {
        let extra = [(TEMP_CFG_REG_A, 0xC0), (CTRL_REG1_A, 0x57 | low_power)];
        let mut chip = chip(Arc::clone(&warm), exact(), &extra);
        chip.advance(75 * MS);
        assert_ne!(chip.register(STATUS_REG_AUX_A) & 0x04, 0);
        let bytes = read_accel(&mut chip, 75 * MS, OUT_TEMP_L_A, 2);
        assert_eq!(i16::from_le_bytes([bytes[0], bytes[1]]), code);
        assert_eq!(chip.register(STATUS_REG_AUX_A), 0x00);
    }
}

#[test]
fn boot_clears_itself_and_keeps_the_users_registers() {
    let mut chip = chip(lively(), exact(), &[]);
    write_spi(&mut chip, MS, &[(CTRL_REG5_A, 0x88)]);
    assert_eq!(read_accel(&mut chip, 5 * MS, CTRL_REG5_A, 1), [0x88]);
    assert_eq!(read_accel(&mut chip, 6 * MS, CTRL_REG5_A, 1), [0x08]);
    assert_eq!(chip.register(CTRL_REG1_A), 0x57);
}

#[test]
fn noise_has_the_elements_density_over_the_bandwidth() {
    let mut chip = chip(
        force_g(|_| [0.0; 3]),
        real(3),
        &[(CTRL_REG4_A, 0x89), (CTRL_REG1_A, 0x77)],
    );
    let values: Vec<f64> = (10..2000)
        .flat_map(|n| codes(&mut chip, n * 3 * MS))
        .map(|code| f64::from(code) / 16.0 * 0.98)
        .collect();
    let rms = (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    // 0.22 mg * sqrt(400 / 9), and the rounding of a digit: 0.98 / sqrt(12).
    let expected = (1.467_f64.powi(2) + 0.283_f64.powi(2)).sqrt();
    assert!((rms - expected).abs() < 0.08, "{rms}");
}

#[test]
fn an_absent_accelerometer_answers_zeros_while_data_ready_goes_on() {
    let present = Present {
        accelerometer: false,
        ..Present::default()
    };
    let mut chip = chip(lively(), ChipOptions { present, ..real(5) }, &[]);
    assert_eq!(codes(&mut chip, SECOND), [0; 3]);
    assert!(chip.samples() > 80);
    assert_eq!(read_accel(&mut chip, SECOND, WHO_AM_I_A, 1), [0x33]);
}

proptest! {
    #[test]
    fn samples_do_not_depend_on_when_the_chip_is_asked(
        seed: u64,
        mut asked in prop::collection::vec(0..500 * MS, 0..60),
    ) {
        let mut lazy = chip(lively(), real(seed), &[]);
        let mut busy = chip(lively(), real(seed), &[]);
        asked.sort_unstable();
        for at in asked {
            codes(&mut busy, at);
        }
        for at in [500 * MS, 511 * MS, 600 * MS] {
            prop_assert_eq!(codes(&mut lazy, at), codes(&mut busy, at));
        }
    }

    #[test]
    fn every_force_within_range_is_rounded_to_the_nearest_digit(g in -3.98..3.98_f64) {
        let mut chip = chip(force_g(move |_| [g, 0.0, 0.0]), exact(), &[]);
        let digits = f64::from(codes(&mut chip, 100 * MS)[0]) / 16.0;
        prop_assert!((digits - g / 0.00195).abs() <= 0.501 || digits == 2047.0 || digits == -2048.0);
    }
}

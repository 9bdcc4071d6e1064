//! The magnetometer die against numbers worked out from its datasheet.

use std::sync::Arc;

use proptest::prelude::*;

use super::super::magnetometer_registers::*;
use super::super::*;
use crate::testing::*;
use crate::{Chip, ChipOptions, OwnClock, Present, Stimulus, StimulusSource};

/// 100 Hz continuous, block data update.
const FLIGHT: [(u8, u8); 2] = [(CFG_REG_C_M, 0x10), (CFG_REG_A_M, 0x0C)];
/// The pin shows a latched, active-high interrupt of any axis, on differences.
const CHANGE: [(u8, u8); 3] = [
    (CFG_REG_C_M, 0x50),
    (CFG_REG_B_M, 0x08),
    (INT_CTRL_REG_M, 0xE7),
];

/// As [`FLIGHT`], with temperature compensation and offset cancellation.
const CORRECTED: [(u8, u8); 2] = [(CFG_REG_A_M, 0x8C), (CFG_REG_B_M, 0x02)];

fn chip(source: Arc<dyn StimulusSource>, options: ChipOptions, extra: &[(u8, u8)]) -> Magnetometer {
    let mut chip = Magnetometer::new(source, options);
    write_spi(&mut chip, 0, &FLIGHT);
    write_spi(&mut chip, 0, extra);
    chip
}

fn codes(chip: &mut Magnetometer, at_ns: u64) -> [i16; 3] {
    little(&read_mag(chip, at_ns, OUTX_L_REG_M, 6))
}

fn write_offsets(chip: &mut Magnetometer, at_ns: u64, offsets: [i16; 3]) {
    let mut mosi = vec![OFFSET_X_REG_L_M];
    mosi.extend(offsets.iter().flat_map(|offset| offset.to_le_bytes()));
    spi(chip, at_ns, &mosi);
}

/// Reads INT_SOURCE_REG_M, releasing the latch.
fn release(chip: &mut Magnetometer, at_ns: u64) -> u8 {
    read_mag(chip, at_ns, INT_SOURCE_REG_M, 1)[0]
}

/// 0.3 gauss on X (200 counts), and 0.15 gauss (100 counts) more from 100 ms.
fn stepped() -> Arc<dyn StimulusSource> {
    field_gauss(|t| [if t >= 0.0995 { 0.45 } else { 0.3 }, 0.0, 0.0])
}

#[test]
fn registers_wake_with_the_datasheets_values() {
    let chip = Magnetometer::new(lively(), exact());
    for (address, value) in [
        (WHO_AM_I_M, 0x40),
        (CFG_REG_A_M, 0x03),
        (CFG_REG_B_M, 0x00),
        (CFG_REG_C_M, 0x00),
        (INT_CTRL_REG_M, 0xE0),
        (INT_THS_L_REG_M, 0x00),
        (STATUS_REG_M, 0x00),
    ] {
        assert_eq!(chip.register(address), value, "{address:#04x}");
    }
    assert_eq!(chip.next_event(), u64::MAX);
    assert!(!chip.interrupt());
}

#[test]
fn every_data_rate_code_gives_its_rate() {
    for (code, rate) in [(0, 10), (1, 20), (2, 50), (3, 100)] {
        let mut chip = chip(
            lively(),
            exact(),
            &[(CFG_REG_A_M, 0x03), (CFG_REG_A_M, code << 2)],
        );
        chip.advance(SECOND);
        assert_eq!(chip.samples(), rate);
    }
}

#[test]
fn idle_stops_and_single_measures_once_and_falls_idle() {
    let mut chip = chip(lively(), exact(), &[(CFG_REG_A_M, 0x03)]);
    chip.advance(SECOND);
    assert_eq!(chip.samples(), 0);
    write_spi(&mut chip, SECOND, &[(CFG_REG_A_M, 0x01)]);
    assert_eq!(chip.next_event(), SECOND + 9_400_000);
    chip.advance(2 * SECOND);
    assert_eq!((chip.samples(), chip.register(CFG_REG_A_M)), (1, 0x03));
    write_spi(&mut chip, 2 * SECOND, &[(CFG_REG_A_M, 0x11)]);
    assert_eq!(chip.next_event(), 2 * SECOND + 6_400_000);
}

#[test]
fn a_count_is_one_and_a_half_milligauss() {
    let mut chip = chip(field_gauss(|_| [0.3, -0.45, 1.5e-3]), exact(), &[]);
    assert_eq!(codes(&mut chip, SECOND), [200, -300, 1]);
}

#[test]
fn a_field_beyond_the_range_clips_and_is_flagged_until_read() {
    let mut chip = chip(field_gauss(|_| [60.0, -60.0, 0.0]), exact(), &[]);
    assert_eq!(codes(&mut chip, SECOND), [i16::MAX, i16::MIN, 0]);
    assert_ne!(
        read_mag(&mut chip, SECOND, INT_SOURCE_REG_M, 1)[0] & 0x02,
        0
    );
    assert_eq!(
        read_mag(&mut chip, SECOND, INT_SOURCE_REG_M, 1)[0] & 0x02,
        0
    );
}

#[test]
fn offsets_are_subtracted_from_the_output() {
    let mut chip = chip(field_gauss(|_| [0.3, 0.3, 0.3]), exact(), &[]);
    write_offsets(&mut chip, 0, [150, 200, -100]);
    assert_eq!(codes(&mut chip, SECOND), [50, 0, 300]);
    assert!((chip.offsets()[0] - 0.225).abs() < 1e-12);
}

#[test]
fn written_with_a_sample_the_offsets_make_an_exact_detector_of_change() {
    let mut chip = chip(stepped(), exact(), &CHANGE);
    write_spi(&mut chip, 0, &[(INT_THS_L_REG_M, 99)]);
    let sample = codes(&mut chip, 15 * MS);
    write_offsets(&mut chip, 15 * MS, sample);
    read_mag(&mut chip, 15 * MS, INT_SOURCE_REG_M, 1);
    assert_eq!(rising_edges(&mut chip, SECOND), [100 * MS]);
    assert_eq!(read_mag(&mut chip, SECOND, INT_SOURCE_REG_M, 1), [0x81]);
    assert_eq!(
        chip.triggers(),
        2,
        "the field itself, before the offsets, then the change"
    );
}

#[test]
fn without_int_on_data_off_the_field_itself_is_compared() {
    let mut chip = chip(stepped(), exact(), &CHANGE);
    write_offsets(&mut chip, 0, [200, 0, 0]);
    write_spi(&mut chip, 0, &[(CFG_REG_B_M, 0x00), (INT_THS_L_REG_M, 150)]);
    assert_eq!(rising_edges(&mut chip, SECOND), [10 * MS]);
}

#[test]
fn the_threshold_must_be_exceeded_over_all_codes() {
    let mut chip = chip(field_gauss(|_| [0.0; 3]), exact(), &CHANGE);
    let mut at = 0;
    for code in 0..i16::MAX {
        for (difference, trips) in [(code, false), (code + 1, true), (-code - 1, true)] {
            write_offsets(&mut chip, at, [-difference, 0, 0]);
            let [low, high] = code.to_le_bytes();
            spi(&mut chip, at, &[INT_THS_L_REG_M, low, high]);
            at += 10 * MS;
            chip.advance(at);
            assert_eq!(
                chip.interrupt(),
                trips,
                "code {code}, difference {difference}"
            );
            release(&mut chip, at);
        }
    }
}

#[test]
fn the_source_names_axis_and_sign_of_enabled_axes_only() {
    for (field, enabled, source) in [
        ([1.0, 0.0, 0.0], 0xE0, 0x81),
        ([0.0, 1.0, 0.0], 0xE0, 0x41),
        ([0.0, 0.0, 1.0], 0xE0, 0x21),
        ([-1.0, 0.0, 0.0], 0xE0, 0x11),
        ([0.0, -1.0, 0.0], 0xE0, 0x09),
        ([0.0, 0.0, -1.0], 0xE0, 0x05),
        ([1.0, -1.0, 1.0], 0x60, 0x29),
        ([1.0, 0.0, 0.0], 0x60, 0x00),
    ] {
        let extra = [(INT_CTRL_REG_M, enabled | 0x05), (INT_THS_L_REG_M, 100)];
        let mut chip = chip(field_gauss(move |_| field), exact(), &extra);
        assert_eq!(read_mag(&mut chip, SECOND, INT_SOURCE_REG_M, 1), [source]);
    }
}

#[test]
fn unlatched_the_interrupt_ends_with_the_condition_and_latched_with_the_read() {
    let bump = || {
        field_gauss(|t| {
            [
                if (0.095..0.125).contains(&t) {
                    1.0
                } else {
                    0.0
                },
                0.0,
                0.0,
            ]
        })
    };
    let extra = [(CFG_REG_C_M, 0x50), (INT_THS_L_REG_M, 100)];
    let mut pulsed = chip(bump(), exact(), &extra);
    write_spi(&mut pulsed, 0, &[(INT_CTRL_REG_M, 0xE5)]);
    pulsed.advance(125 * MS);
    assert!(pulsed.interrupt());
    pulsed.advance(130 * MS);
    assert!(!pulsed.interrupt());
    let mut latched = chip(bump(), exact(), &extra);
    write_spi(&mut latched, 0, &[(INT_CTRL_REG_M, 0xE7)]);
    latched.advance(SECOND);
    assert!(latched.interrupt());
    release(&mut latched, SECOND);
    assert!(!latched.interrupt());
}

#[test]
fn polarity_turns_the_interrupt_bit_and_the_pin() {
    let extra = [
        (CFG_REG_C_M, 0x50),
        (INT_CTRL_REG_M, 0xE1),
        (INT_THS_L_REG_M, 100),
    ];
    let mut chip = chip(stepped(), exact(), &extra);
    assert!(chip.interrupt(), "active low: high while nothing happens");
    chip.advance(10 * MS);
    assert!(!chip.interrupt());
    assert_eq!(chip.register(INT_SOURCE_REG_M), 0x80);
}

#[test]
fn the_pin_stays_low_until_a_signal_is_routed_to_it() {
    let extra = [(INT_CTRL_REG_M, 0xE5), (INT_THS_L_REG_M, 1)];
    let mut chip = chip(stepped(), exact(), &extra);
    chip.advance(50 * MS);
    assert!(!chip.interrupt());
    write_spi(&mut chip, 50 * MS, &[(CFG_REG_C_M, 0x50)]);
    assert!(chip.interrupt());
}

#[test]
fn data_ready_on_the_pin_lasts_until_the_data_is_read() {
    let mut chip = chip(lively(), exact(), &[(CFG_REG_C_M, 0x11)]);
    assert_eq!(rising_edges(&mut chip, 15 * MS), [10 * MS]);
    assert_eq!(read_mag(&mut chip, 15 * MS, STATUS_REG_M, 1), [0x0F]);
    codes(&mut chip, 15 * MS);
    assert!(!chip.interrupt());
}

#[test]
fn the_high_byte_comes_first_in_big_endian() {
    let mut chip = chip(
        field_gauss(|_| [0.9, 0.0, 0.0]),
        exact(),
        &[(CFG_REG_C_M, 0x18)],
    );
    assert_eq!(read_mag(&mut chip, SECOND, OUTX_L_REG_M, 2), [0x02, 0x58]);
}

#[test]
fn the_low_pass_halves_the_bandwidth() {
    let mut chip = chip(stepped(), exact(), &[(CFG_REG_B_M, 0x01)]);
    codes(&mut chip, 95 * MS);
    // A corner of a quarter of the rate leaves exp(-pi/2) = 21 % after one step.
    let x = codes(&mut chip, 105 * MS)[0];
    assert_eq!(x, 200 + 79);
}

#[test]
fn a_soft_reset_brings_back_the_reset_values() {
    let mut chip = chip(lively(), exact(), &CHANGE);
    write_spi(&mut chip, 50 * MS, &[(CFG_REG_A_M, 0x20)]);
    assert_eq!(
        read_mag(&mut chip, 50 * MS, CFG_REG_A_M, 4),
        [0x03, 0x00, 0x00, 0xE0]
    );
    chip.advance(SECOND);
    assert_eq!(chip.samples(), 5);
    write_spi(&mut chip, SECOND, &[(CFG_REG_A_M, 0x4C)]);
    assert_eq!(chip.register(CFG_REG_A_M), 0x0C, "REBOOT clears itself");
}

#[test]
fn a_brown_out_forgets_offsets_and_thresholds() {
    let mut chip = chip(lively(), exact(), &CHANGE);
    write_offsets(&mut chip, 0, [1, 2, 3]);
    chip.brown_out(50 * MS);
    assert_eq!(chip.offsets(), [0.0; 3]);
    assert_eq!((chip.next_event(), chip.rate_hz()), (u64::MAX, None));
}

#[test]
fn noise_is_three_milligauss() {
    let mut chip = chip(field_gauss(|_| [0.0; 3]), real(2), &CORRECTED);
    let values: Vec<f64> = (2..2000)
        .flat_map(|n| codes(&mut chip, n * 11 * MS))
        .map(|code| f64::from(code) * 1.5)
        .collect();
    let rms = (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    // With the rounding of a count: sqrt(3^2 + 1.5^2 / 12).
    assert!((rms - 3.03).abs() < 0.1, "{rms}");
}

#[test]
fn an_absent_magnetometer_answers_zeros_while_data_ready_goes_on() {
    let present = Present {
        magnetometer: false,
        ..Present::default()
    };
    let mut chip = chip(lively(), ChipOptions { present, ..real(5) }, &[]);
    assert_eq!(codes(&mut chip, SECOND), [0; 3]);
    assert!(chip.samples() > 90);
    assert_eq!(read_mag(&mut chip, SECOND, WHO_AM_I_M, 1), [0x40]);
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
    fn output_plus_offset_is_the_field(gauss in -20.0..20.0_f64, offset in -5000..5000_i16) {
        let mut chip = chip(field_gauss(move |_| [gauss, 0.0, 0.0]), exact(), &[]);
        write_offsets(&mut chip, 0, [offset, 0, 0]);
        let count = f64::from(codes(&mut chip, 50 * MS)[0]) + f64::from(offset);
        prop_assert!((count * 1.5e-3 - gauss).abs() <= 0.76e-3);
    }
}

/// Mean of 200 samples in no field at a temperature, in milligauss.
fn own(celsius: f64, extra: &[(u8, u8)]) -> [f64; 3] {
    let source = Arc::new(move |_| Stimulus {
        temperature_c: celsius,
        ..Stimulus::default()
    });
    let mut chip = chip(source, real(2), extra);
    let mut sum = [0.0; 3];
    for n in 2..202 {
        for (sum, code) in sum.iter_mut().zip(codes(&mut chip, n * 11 * MS)) {
            *sum += f64::from(code) * 1.5 / 200.0;
        }
    }
    sum
}

#[test]
fn an_offset_shows_unless_it_is_cancelled_and_a_drift_unless_it_is_compensated() {
    let largest = |axes: [f64; 3]| axes.into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let [cancelled, compensated] = [(CFG_REG_B_M, 0x02), (CFG_REG_A_M, 0x8C)];
    let drift = |extra: &[(u8, u8)]| {
        let [cold, hot] = [25.0, 85.0].map(|celsius| own(celsius, extra));
        largest([0, 1, 2].map(|axis| hot[axis] - cold[axis]))
    };
    assert!(largest(own(85.0, &CORRECTED)) < 1.0);
    assert!((10.0..60.0).contains(&largest(own(25.0, &[compensated]))));
    // At most 0.3 mG for each of 60 degrees.
    assert!((3.0..18.5).contains(&drift(&[cancelled])));
    assert!(drift(&[compensated]) < 1.0);
}

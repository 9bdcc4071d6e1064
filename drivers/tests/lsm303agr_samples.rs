//! Samples of the LSM303AGR's accelerometer: bytes, counts, SI, corners.

mod common;

use common::{on_bus, reads};
use proptest::prelude::*;
use reflex_drivers::lsm303agr::{
    AccelCounts, AccelDataRate, AccelFullScale, Accelerometer, HighPassCorner,
};

#[test]
fn a_sample_is_one_burst_of_six_bytes_low_byte_first() {
    on_bus(
        &[reads(0xE8, &[0x10, 0x00, 0xF0, 0xFF, 0x00, 0x80])],
        |bus| {
            assert_eq!(
                Accelerometer::new(bus).read_sample(),
                Ok(AccelCounts([16, -16, i16::MIN]))
            );
        },
    );
}

#[test]
fn counts_become_specific_force_with_the_datasheets_sensitivity() {
    // 1 g at +-4 g is 1000 / 1.95 = 512.8 digits of 16 counts.
    let [x, y, z] = AccelCounts([8205, -8205, 0]).specific_force(AccelFullScale::G4);
    assert!((x.0 - 9.806_65).abs() < 1.0e-3 && x.0 == -y.0 && z.0 == 0.0);
    let full = AccelCounts([i16::MAX; 3]);
    for (full_scale, g) in [(AccelFullScale::G2, 2.0), (AccelFullScale::G8, 8.0)] {
        let [x, ..] = full.specific_force(full_scale);
        assert!((x.0 / (g * 9.806_65) - 1.0).abs() < 0.01);
    }
    // The 16 g scale really spans 24 g: 11.72 mg for each of 2048 digits.
    let [x, ..] = full.specific_force(AccelFullScale::G16);
    assert!((x.0 / (24.0 * 9.806_65) - 1.0).abs() < 0.01);
}

#[test]
fn corners_are_shares_of_the_data_rate() {
    let at_400 = |corner: HighPassCorner| corner.frequency(AccelDataRate::Hz400).0;
    assert_eq!(at_400(HighPassCorner::Fiftieth), 8.0);
    assert_eq!(at_400(HighPassCorner::Hundredth), 4.0);
    assert_eq!(at_400(HighPassCorner::TwoHundredth), 2.0);
    assert_eq!(at_400(HighPassCorner::FourHundredth), 1.0);
    assert_eq!(
        HighPassCorner::FourHundredth
            .frequency(AccelDataRate::Hz100)
            .0,
        0.25
    );
}

proptest! {
    #[test]
    fn any_six_bytes_decode_to_their_counts(x: i16, y: i16, z: i16) {
        let bytes = [x, y, z].map(i16::to_le_bytes).concat();
        on_bus(&[reads(0xE8, &bytes)], |bus| {
            assert_eq!(Accelerometer::new(bus).read_sample(), Ok(AccelCounts([x, y, z])));
        });
    }
}

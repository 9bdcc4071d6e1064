//! The MPU6050's burst: every decoding, scale and end of range.

use proptest::prelude::*;
use reflex_drivers::mpu6050::{AccelRange, BURST_LENGTH, GyroRange, ImuBurst, InterruptStatus};

proptest! {
    #[test]
    fn any_burst_decodes_to_its_counts(
        status: u8,
        accel: [i16; 3],
        temperature: i16,
        gyro: [i16; 3],
    ) {
        let words = [accel.as_slice(), &[temperature], &gyro].concat();
        let mut bytes = [status; BURST_LENGTH];
        for (pair, word) in bytes[1..].chunks_exact_mut(2).zip(words) {
            pair.copy_from_slice(&word.to_be_bytes());
        }
        let expected =
            ImuBurst { interrupt_status: InterruptStatus(status), accel, temperature, gyro };
        prop_assert_eq!(ImuBurst::from_bytes(&bytes), expected);
    }

    #[test]
    fn counts_scale_to_si_by_the_datasheets_sensitivities(count: i16) {
        let burst = ImuBurst { accel: [count; 3], gyro: [count; 3], ..ImuBurst::default() };
        let ranges = [
            (GyroRange::Dps250, 131.0, AccelRange::G2, 16384.0),
            (GyroRange::Dps500, 65.5, AccelRange::G4, 8192.0),
            (GyroRange::Dps1000, 32.8, AccelRange::G8, 4096.0),
            (GyroRange::Dps2000, 16.4, AccelRange::G16, 2048.0),
        ];
        for (gyro_range, per_degree, accel_range, per_g) in ranges {
            let rate = (f64::from(count) / per_degree).to_radians();
            let force = f64::from(count) / per_g * 9.806_65;
            for axis in burst.angular_rate(gyro_range) {
                prop_assert!((f64::from(axis.0) - rate).abs() <= rate.abs() * 1.0e-6);
            }
            for axis in burst.specific_force(accel_range) {
                prop_assert!((f64::from(axis.0) - force).abs() <= force.abs() * 1.0e-6);
            }
        }
    }
}

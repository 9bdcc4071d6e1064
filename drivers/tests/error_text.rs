//! Errors say chip, register, values and the way out in one line.

use embedded_hal::i2c::ErrorKind;
use reflex_drivers::{Chip, Error, threshold::ThresholdError};

#[test]
fn a_mismatch_names_chip_register_and_both_values() {
    let error: Error<ErrorKind> = Error::ReadBack {
        chip: Chip::Lsm303agrAccelerometer,
        register: 0x32,
        wrote: 0x05,
        read: 0x00,
    };
    assert_eq!(
        error.to_string(),
        "LSM303AGR accelerometer: register 0x32 (INT1_THS_A) holds 0x00, expected 0x05: \
         configure the chip again"
    );
}

#[test]
fn another_chip_and_a_bus_error_say_what_to_check() {
    let error: Error<ErrorKind> = Error::WrongIdentity {
        chip: Chip::Mpu6050,
        expected: 0x68,
        found: 0x70,
    };
    assert_eq!(
        error.to_string(),
        "MPU6050: WHO_AM_I is 0x70, expected 0x68: check wiring and part"
    );
    let error = Error::Bus(ErrorKind::ArbitrationLoss);
    assert_eq!(
        error.to_string(),
        "bus error ArbitrationLoss: recover the bus, then retry"
    );
}

#[test]
fn registers_have_their_datasheets_names() {
    assert_eq!(
        Chip::Lsm303agrMagnetometer.register_name(0x65),
        "INT_THS_L_REG_M"
    );
    assert_eq!(Chip::Mpu6050.register_name(0x1C), "ACCEL_CONFIG");
    assert_eq!(Chip::Mpu6050.register_name(0x00), "?");
    assert_eq!(Chip::Lsm303agrMagnetometer.name(), "LSM303AGR magnetometer");
}

#[test]
fn threshold_errors_are_one_line_each() {
    let errors = [
        ThresholdError::BelowOneStep,
        ThresholdError::NotANumber,
        ThresholdError::CodeTooLarge,
    ];
    for error in errors {
        let text = error.to_string();
        assert!(text.starts_with("threshold") && !text.contains('\n'));
    }
}

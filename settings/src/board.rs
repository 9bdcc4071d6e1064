//! The constants of `config/boards/NAME.toml`: what may vary on one wiring.

use crate::range::{above, one_of, within};
use crate::setting::{Kind, Limit, Setting};

const fn rate(key: &'static str, rates: &'static [f64]) -> Setting {
    Setting::of(["sensors", key], Kind::Count(one_of(rates)), "Hz")
}

const fn cutoff(key: &'static str) -> Setting {
    Setting::of(["filters", key], Kind::Number(within(5.0, 450.0)), "Hz")
        .limited(Limit::BelowHalfTheImuRate)
}

/// Everything of a board's file that is no run-time setting.
pub const BOARD: &[Setting] = &[
    // Those whose periods are whole milliseconds.
    rate("imu_rate_hz", &[1000.0, 500.0, 250.0, 200.0, 125.0, 100.0])
        .default("1000")
        .named("IMU_RATE")
        .meaning("Rate of the MPU6050."),
    rate(
        "chip_accel_rate_hz",
        &[400.0, 200.0, 100.0, 50.0, 25.0, 10.0],
    )
    .default("100")
    .named("CHIP_ACCEL_RATE")
    .meaning("Rate of the LSM303AGR's accelerometer."),
    rate("chip_mag_rate_hz", &[100.0, 50.0, 20.0, 10.0])
        .default("100")
        .named("CHIP_MAG_RATE")
        .meaning("Rate of the LSM303AGR's magnetometer."),
    cutoff("gyro_cutoff_hz")
        .default("80")
        .named("GYRO_CUTOFF")
        .meaning("Corner of the gyro's low-pass filter."),
    cutoff("accel_cutoff_hz")
        .default("30")
        .named("ACCEL_CUTOFF")
        .meaning("Corner of the accelerometer's low-pass filter."),
    Setting::of(
        ["calibration", "length_s"],
        Kind::Span(within(0.1, 10.0)),
        "s",
    )
    .default("0.5")
    .named("CALIBRATION_LENGTH")
    .meaning("Time over which the gyro's bias is averaged at rest."),
    Setting::of(
        ["calibration", "still_gyro_rad_s"],
        Kind::Number(above(0.0, 1.0)),
        "rad/s",
    )
    .default("0.05")
    .named("STILL_GYRO")
    .meaning("Largest deviation from the mean at rest."),
    Setting::of(
        ["link", "baud"],
        Kind::Count(one_of(&[
            57_600.0, 115_200.0, 230_400.0, 460_800.0, 921_600.0,
        ])),
        "baud",
    )
    .default("460800")
    .named("LINK_BAUD")
    .meaning("Bits per second of the link."),
    Setting::of(
        ["link", "setpoint_timeout_s"],
        Kind::Span(within(0.1, 10.0)),
        "s",
    )
    .default("1")
    .named("SETPOINT_TIMEOUT")
    .meaning("Time without a setpoint after which it is lost."),
];

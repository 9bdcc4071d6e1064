//! The constants of `config/boards/NAME.toml`: what may vary on one wiring.

use crate::choices::Mounting;
use crate::inputs::{Input, Rate};
use crate::range::{above, one_of, within};
use crate::setting::{Kind, Limit, Setting};

const fn rate(rate: &Rate) -> Setting {
    Setting::of(
        ["sensors", rate.key],
        Kind::Count(one_of(rate.allowed)),
        "Hz",
    )
    .default(rate.default)
    .named(rate.name)
    .meaning(rate.meaning)
}

/// The rate of the sensor behind each input.
static OF_SENSED: [Setting; Input::SENSED.len()] = {
    let mut all = [BOARD[0]; Input::SENSED.len()];
    let mut place = 0;
    while place < all.len() {
        all[place] = match Input::SENSED[place].declaration().rate {
            Some(declared) => rate(declared),
            None => panic!("a sensor has a rate"),
        };
        place += 1;
    }
    all
};

/// The rates of sensors in the order of their inputs; one that delivers two is there once.
pub fn rates() -> impl Iterator<Item = &'static Setting> {
    let rates = OF_SENSED.iter().enumerate();
    rates.filter_map(|(place, rate)| (!OF_SENSED[..place].contains(rate)).then_some(rate))
}

const fn cutoff(key: &'static str) -> Setting {
    Setting::of(["filters", key], Kind::Number(within(5.0, 450.0)), "Hz")
        .limited(Limit::BelowHalfTheImuRate)
}

const fn mounting(key: &'static str) -> Setting {
    Setting::of(["mounting", key], Kind::word::<Mounting>(), "").default("none")
}

const fn battery(key: &'static str, kind: Kind, unit: &'static str) -> Setting {
    Setting::of(["battery", key], kind, unit)
}

/// Everything of a board's file that is no run-time setting and no rate of a sensor.
pub const BOARD: &[Setting] = &[
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
    mounting("imu")
        .named("IMU_MOUNTING")
        .meaning("How the inertial sensor lies in the drone."),
    mounting("chip")
        .named("CHIP_MOUNTING")
        .meaning("How the chip with accelerometer and magnetometer lies in the drone."),
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
    Setting::of(
        ["link", "pilot_timeout_s"],
        Kind::Span(within(1.0, 60.0)),
        "s",
    )
    .default("5")
    .named("PILOT_TIMEOUT")
    .meaning("Time without a frame of the pilot after which another may command."),
    Setting::of(
        ["link", "largest_distance_m"],
        Kind::Number(within(10.0, 50_000.0)),
        "m",
    )
    .default("10000")
    .named("LARGEST_DISTANCE")
    .meaning("Largest distance along an axis of a position or a goal from the local origin."),
    Setting::of(
        ["link", "place_jump_m"],
        Kind::Number(within(0.2, 100.0)),
        "m",
    )
    .default("3")
    .named("PLACE_JUMP")
    .meaning("Distance of a position from where motion leads above which it has jumped."),
    Setting::of(["link", "wired"], Kind::Flag, "")
        .default("true")
        .named("LINK_WIRED")
        .meaning("Whether the link is a cable: a signing key is taken from nothing else."),
    battery("volts_per_volt", Kind::Number(within(0.0, 100.0)), "V")
        .default("10.1")
        .named("BATTERY_VOLTS_PER_VOLT")
        .meaning("Voltage of the battery for each volt at its pin; 0 where it is not measured."),
    battery("amps_per_volt", Kind::Number(within(0.0, 1000.0)), "A")
        .default("17")
        .named("BATTERY_AMPS_PER_VOLT")
        .meaning("Current of the battery for each volt at its pin; 0 where it is not measured."),
    battery("smoothing_s", Kind::Span(within(0.1, 30.0)), "s")
        .default("2")
        .named("BATTERY_SMOOTHING")
        .meaning("Time constant over which voltage and current are smoothed."),
    battery("cells", Kind::Count(within(0.0, 12.0)), "")
        .default("0")
        .named("BATTERY_CELLS")
        .meaning("Cells in series; 0 where they are counted as the battery is connected."),
    battery("full_v", Kind::Number(within(4.2, 4.5)), "V")
        .default("4.3")
        .named("BATTERY_FULL_V")
        .meaning("Voltage that no cell passes: cells are counted by it."),
    battery("low_v", Kind::Number(within(2.0, 4.2)), "V")
        .default("3.5")
        .named("BATTERY_LOW_V")
        .meaning("Voltage of a cell below which the battery is low."),
    battery("critical_v", Kind::Number(within(2.0, 4.2)), "V")
        .default("3.3")
        .named("BATTERY_CRITICAL_V")
        .meaning("Voltage of a cell below which the battery is nearly empty."),
    battery("collapsed_v", Kind::Number(within(2.0, 4.2)), "V")
        .default("3")
        .named("BATTERY_COLLAPSED_V")
        .meaning("Voltage of a cell that is too low for any load."),
    battery("margin_v", Kind::Number(within(0.0, 0.5)), "V")
        .default("0.1")
        .named("BATTERY_MARGIN_V")
        .meaning("Voltage of a cell above a limit at which the battery counts as recovered."),
    battery("least_v", Kind::Number(within(1.0, 60.0)), "V")
        .default("5")
        .named("BATTERY_LEAST_V")
        .meaning("Voltage below which no battery is connected."),
];

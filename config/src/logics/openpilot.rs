//! The gains of `logics/openpilot.toml`.

use super::{above, axes, number, within};
use crate::logic::Gain;

const SHARE: &str = "share of full authority";

/// Their order is that of the file.
pub(crate) const GAINS: &[Gain] = &[
    number(["estimate", "accel_kp"], within(0.0, 10.0), "1/s")
        .named("ACCEL_KP")
        .meaning("How fast the attitude follows the accelerometer"),
    number(["estimate", "accel_ki"], within(0.0, 0.1), "1/s2")
        .named("ACCEL_KI")
        .meaning("How fast the gyroscope's bias follows the accelerometer"),
    number(["estimate", "mag_kp"], within(0.0, 10.0), "1/s")
        .named("MAG_KP")
        .meaning("How fast the heading follows the magnetometer"),
    number(["estimate", "yaw_bias_rate"], within(0.0, 0.1), "1/s")
        .named("YAW_BIAS_RATE")
        .meaning("How fast the mean yaw rate is taken for a bias"),
    number(["estimate", "bias_limit_rad_s"], within(0.0, 1.0), "rad/s")
        .named("BIAS_LIMIT")
        .meaning("Most that the gyroscope's bias comes to"),
    axes(["attitude", "kp"], within(0.0, 30.0), "1/s")
        .meaning("Body rate asked for per radian of error")
        .grows(1),
    axes(["attitude", "ki"], within(0.0, 30.0), "1/s2")
        .meaning("Body rate asked for per integrated error")
        .grows(2),
    axes(
        ["attitude", "integral_limit_rad_s"],
        within(0.0, 10.0),
        "rad/s",
    )
    .named("ATTITUDE_INTEGRAL_LIMIT")
    .meaning("Most that the attitude loop's integral holds"),
    axes(
        ["attitude", "maximum_rate_rad_s"],
        above(0.0, 35.0),
        "rad/s",
    )
    .named("MAXIMUM_RATE")
    .meaning("Most that the attitude loop asks for"),
    axes(["attitude", "manual_rate_rad_s"], above(0.0, 35.0), "rad/s")
        .named("MANUAL_RATE")
        .meaning("Most of a setpoint's own rates that is flown"),
    axes(
        ["rate", "kp"],
        within(0.0, 2.0),
        "share of full authority per rad/s",
    )
    .meaning("Torque asked for per error of the rate")
    .grows(1),
    axes(
        ["rate", "ki"],
        within(0.0, 5.0),
        "share of full authority per rad",
    )
    .meaning("Torque asked for per integrated error of the rate")
    .grows(2),
    axes(
        ["rate", "kd"],
        within(0.0, 0.1),
        "share of full authority per rad/s2",
    )
    .meaning("Torque taken back per measured angular acceleration")
    .grows(1),
    number(["rate", "d_cutoff_hz"], within(1.0, 200.0), "Hz")
        .named("RATE_D_CUTOFF")
        .meaning("Corner of the derivative's low-pass filter"),
    number(["rate", "integral_limit"], within(0.0, 1.0), SHARE)
        .meaning("Most that the rate loop's integral holds"),
    number(["rate", "output_limit"], above(0.0, 1.0), SHARE)
        .named("OUTPUT_LIMIT")
        .meaning("Most that an axis asks for"),
    number(["position", "p"], within(0.0, 10.0), "1/s")
        .meaning("Horizontal velocity asked for per metre of error"),
    number(["position", "speed_limit_m_s"], above(0.0, 50.0), "m/s")
        .named("SPEED_LIMIT")
        .meaning("Most horizontal velocity asked for"),
    number(["position", "velocity_kp"], within(0.0, 1.0), "rad per m/s")
        .named("VELOCITY_KP")
        .meaning("Lean per error of the horizontal velocity"),
    number(["position", "velocity_ki"], within(0.0, 1.0), "rad per m")
        .named("VELOCITY_KI")
        .meaning("Lean per integrated error of the horizontal velocity"),
    number(
        ["position", "velocity_kd"],
        within(0.0, 1.0),
        "rad per m/s2",
    )
    .named("VELOCITY_KD")
    .meaning("Lean taken back per horizontal acceleration"),
    number(["position", "integral_limit_rad"], within(0.0, 1.0), "rad")
        .named("LEAN_INTEGRAL_LIMIT")
        .meaning("Most lean that the integral holds"),
    number(
        ["position", "velocity_feedforward"],
        within(0.0, 1.0),
        "rad per m/s",
    )
    .named("VELOCITY_FEEDFORWARD")
    .meaning("Lean per horizontal velocity asked for"),
    number(["position", "maximum_lean_rad"], above(0.0, 1.0), "rad")
        .named("MAXIMUM_LEAN")
        .meaning("Most that roll and pitch each lean"),
    number(["altitude", "p"], within(0.0, 10.0), "1/s")
        .meaning("Vertical velocity asked for per metre of error"),
    number(["altitude", "speed_limit_m_s"], above(0.0, 20.0), "m/s")
        .named("CLIMB_LIMIT")
        .meaning("Most vertical velocity asked for, up or down"),
    number(
        ["altitude", "velocity_kp"],
        within(0.0, 5.0),
        "thrust per m/s",
    )
    .named("CLIMB_KP")
    .meaning("Thrust per error of the vertical velocity"),
    number(
        ["altitude", "velocity_ki"],
        within(0.0, 5.0),
        "thrust per m",
    )
    .named("CLIMB_KI")
    .meaning("Thrust per integrated error of the vertical velocity"),
    number(
        ["altitude", "velocity_kd"],
        within(0.0, 1.0),
        "thrust per m/s2",
    )
    .named("CLIMB_KD")
    .meaning("Thrust taken back per vertical acceleration"),
    number(["altitude", "velocity_beta"], within(0.0, 1.0), "share")
        .named("CLIMB_BETA")
        .meaning("How much of the vertical velocity asked for CLIMB_KP sees"),
    number(["altitude", "thrust_minimum"], within(0.0, 0.5), "thrust")
        .named("THRUST_MINIMUM")
        .meaning("Least thrust in flight"),
    number(["altitude", "thrust_neutral"], within(0.0, 1.0), "thrust")
        .named("THRUST_NEUTRAL")
        .meaning("Thrust that hovering is taken to need at first"),
    number(["altitude", "thrust_maximum"], within(0.5, 1.0), "thrust")
        .named("THRUST_MAXIMUM")
        .meaning("Most thrust that the altitude loop asks for"),
];

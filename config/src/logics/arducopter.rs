//! The gains of `logics/arducopter.toml`.

use super::{above, axes, number, within};
use crate::logic::Gain;

pub(crate) const GAINS: &[Gain] = &[
    number(["estimate", "tilt_p"], within(0.0, 1.0), "1/s")
        .meaning("How fast the tilt follows the accelerometer"),
    number(["estimate", "tilt_i"], within(0.0, 0.1), "1/s2")
        .meaning("How fast the gyroscope's drift is learned from the tilt"),
    number(["estimate", "heading_p"], within(0.0, 1.0), "1/s")
        .meaning("How fast the heading follows the magnetometer"),
    number(["estimate", "heading_i"], within(0.0, 0.1), "1/s2")
        .meaning("How fast the gyroscope's drift is learned from the heading"),
    number(
        ["estimate", "drift_limit_rad_s2"],
        within(0.0, 0.01),
        "rad/s2",
    )
    .named("DRIFT_LIMIT")
    .meaning("How fast the learned drift may change"),
    axes(["angle", "p"], above(0.0, 12.0), "1/s")
        .meaning("Body rate asked for per radian of a small error")
        .grows(1),
    axes(["angle", "acceleration_rad_s2"], above(0.0, 40.0), "rad/s2")
        .named("ANGLE_ACCELERATION")
        .meaning("Deceleration by which a larger error may be approached")
        .grows(2),
    number(["angle", "yaw_error_limit_rad"], above(0.0, 3.0), "rad")
        .named("YAW_ERROR_LIMIT")
        .meaning("Most of a yaw error that is corrected at once"),
    axes(
        ["rate", "p"],
        within(0.0, 1.0),
        "share of full authority per rad/s",
    )
    .meaning("Torque asked for per error of the rate")
    .grows(1),
    axes(
        ["rate", "i"],
        within(0.0, 2.0),
        "share of full authority per rad",
    )
    .meaning("Torque asked for per integrated error of the rate")
    .grows(2),
    axes(
        ["rate", "d"],
        within(0.0, 0.05),
        "share of full authority per rad/s2",
    )
    .meaning("Torque asked for per derivative of the rate's error")
    .grows(1),
    number(
        ["rate", "integral_limit"],
        within(0.0, 0.5),
        "share of full authority",
    )
    .named("RATE_INTEGRAL_LIMIT")
    .meaning("Most that an integral of the rate loop holds"),
    number(["rate", "d_cutoff_hz"], within(1.0, 200.0), "Hz")
        .named("RATE_D_CUTOFF")
        .meaning("Corner of the derivative's low-pass filter"),
    number(["rate", "yaw_error_cutoff_hz"], within(0.5, 50.0), "Hz")
        .named("YAW_ERROR_CUTOFF")
        .meaning("Corner of the low-pass filter of the yaw rate's error"),
    number(["position", "p"], above(0.0, 4.0), "1/s")
        .meaning("Velocity asked for per metre of a small horizontal error"),
    number(["position", "acceleration_m_s2"], above(0.0, 10.0), "m/s2")
        .named("POSITION_ACCELERATION")
        .meaning("Deceleration by which a larger horizontal error may be approached"),
    number(["position", "speed_m_s"], above(0.0, 20.0), "m/s")
        .named("POSITION_SPEED")
        .meaning("Most that a horizontal error asks for"),
    number(["velocity", "p"], within(0.0, 10.0), "1/s")
        .meaning("Acceleration asked for per horizontal error of the velocity"),
    number(["velocity", "i"], within(0.0, 5.0), "1/s2")
        .meaning("Acceleration asked for per integrated error of the velocity"),
    number(["velocity", "d"], within(0.0, 1.0), "m/s2 per m/s2")
        .meaning("Acceleration asked for per derivative of the velocity's error"),
    number(
        ["velocity", "integral_limit_m_s2"],
        within(0.0, 20.0),
        "m/s2",
    )
    .named("VELOCITY_INTEGRAL_LIMIT")
    .meaning("Most that the integral of the velocity loop holds"),
    number(["velocity", "cutoff_hz"], within(0.5, 50.0), "Hz")
        .named("VELOCITY_CUTOFF")
        .meaning("Corner of the low-pass filters of the velocity's error and its derivative"),
    number(["velocity", "lean_limit_rad"], above(0.0, 1.2), "rad")
        .named("LEAN_LIMIT")
        .meaning("Most that position control leans"),
    number(["altitude", "p"], above(0.0, 4.0), "1/s")
        .meaning("Climb rate asked for per metre of a small error of the altitude"),
    number(["altitude", "acceleration_m_s2"], above(0.0, 10.0), "m/s2")
        .named("ALTITUDE_ACCELERATION")
        .meaning("Deceleration by which a larger error of the altitude may be approached"),
    number(["altitude", "climb_m_s"], above(0.0, 10.0), "m/s")
        .named("CLIMB_SPEED")
        .meaning("Most that an error of the altitude asks for upwards"),
    number(["altitude", "descent_m_s"], above(0.0, 5.0), "m/s")
        .named("DESCENT_SPEED")
        .meaning("Most that an error of the altitude asks for downwards"),
    number(["altitude", "climb_p"], within(0.0, 10.0), "1/s")
        .named("CLIMB_P")
        .meaning("Vertical acceleration asked for per error of the climb rate"),
    number(
        ["altitude", "throttle_p"],
        within(0.0, 0.5),
        "share of thrust per m/s2",
    )
    .named("THROTTLE_P")
    .meaning("Thrust asked for per error of the vertical acceleration"),
    number(
        ["altitude", "throttle_i"],
        within(0.0, 1.0),
        "share of thrust per m/s",
    )
    .named("THROTTLE_I")
    .meaning("Thrust asked for per integrated error of the vertical acceleration"),
    number(
        ["altitude", "throttle_integral_limit"],
        within(0.0, 1.0),
        "share of thrust",
    )
    .named("THROTTLE_INTEGRAL_LIMIT")
    .meaning("Most that the integral of the thrust holds"),
    number(["altitude", "error_cutoff_hz"], within(1.0, 100.0), "Hz")
        .named("LIFT_ERROR_CUTOFF")
        .meaning("Corner of the low-pass filter of the vertical acceleration's error"),
    number(["altitude", "throttle_cutoff_hz"], within(0.5, 50.0), "Hz")
        .named("THROTTLE_CUTOFF")
        .meaning("Corner of the low-pass filter of the thrust"),
    number(
        ["thrust", "hover"],
        within(0.125, 0.6875),
        "share of thrust",
    )
    .named("HOVER")
    .meaning("Thrust that the learning of hover begins with"),
    number(["thrust", "hover_learning_s"], within(1.0, 100.0), "s")
        .named("HOVER_LEARNING")
        .meaning("Time constant of the learned thrust in hover"),
    number(
        ["thrust", "attitude_priority"],
        within(0.0, 1.0),
        "share of hover",
    )
    .named("ATTITUDE_PRIORITY")
    .meaning("How far thrust may be raised towards hover to keep the attitude"),
    number(
        ["thrust", "yaw_headroom"],
        within(0.0, 0.5),
        "share of full scale",
    )
    .named("YAW_HEADROOM")
    .meaning("Part of every motor's range that yaw may have before roll and pitch"),
];

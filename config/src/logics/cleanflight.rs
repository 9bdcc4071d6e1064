//! The gains of `logics/cleanflight.toml`.

use super::{above, axes, number, within};
use crate::logic::Gain;

const AUTHORITY: &str = "share of full authority";
const THRUST: &str = "share of full thrust";

pub(crate) const GAINS: &[Gain] = &[
    number(["estimate", "dcm_kp"], within(0.0, 10.0), "1/s")
        .meaning("How fast the attitude follows accelerometer and magnetometer"),
    number(["estimate", "dcm_ki"], within(0.0, 1.0), "1/s2")
        .meaning("How fast a bias of the gyroscope is learned"),
    number(
        ["estimate", "fast_factor"],
        within(1.0, 20.0),
        "times dcm_kp",
    )
    .meaning("The correction while the drone stands, just started"),
    number(["estimate", "fast_s"], within(0.0, 60.0), "s")
        .named("ESTIMATE_FAST")
        .meaning("How long the faster correction may hold"),
    number(["estimate", "spin_limit_rad_s"], within(0.0, 35.0), "rad/s")
        .named("ESTIMATE_SPIN_LIMIT")
        .meaning("The rate above which no bias is learned"),
    number(
        ["estimate", "horizontal_field"],
        above(0.0, 1.0),
        "share of the field",
    )
    .meaning("How much of Earth's field is horizontal"),
    number(["level", "p"], within(0.0, 30.0), "1/s")
        .meaning("Body rate asked for per radian of roll or pitch that is missing")
        .grows(1),
    number(["level", "max_lean_rad"], above(0.0, 1.5), "rad")
        .named("LEVEL_MAX_LEAN")
        .meaning("The farthest lean that may be asked for"),
    number(["level", "heading_p"], within(0.0, 10.0), "1/s")
        .meaning("Yaw rate asked for per radian of heading that is missing")
        .grows(1),
    axes(
        ["rate", "p"],
        within(0.0, 2.0),
        "share of full authority per rad/s",
    )
    .meaning("Torque asked for per error of the rate")
    .grows(1),
    axes(
        ["rate", "i"],
        within(0.0, 5.0),
        "share of full authority per rad",
    )
    .meaning("Torque asked for per integrated error of the rate")
    .grows(2),
    axes(
        ["rate", "d"],
        within(0.0, 0.1),
        "share of full authority per rad/s2",
    )
    .meaning("Torque taken back per measured angular acceleration")
    .grows(1),
    number(["rate", "d_cutoff_hz"], within(1.0, 200.0), "Hz")
        .named("RATE_D_CUTOFF")
        .meaning("Corner of the derivative's low-pass filter"),
    number(["rate", "integral_limit"], within(0.0, 1.0), AUTHORITY)
        .meaning("Most that the integral holds"),
    number(["rate", "d_limit"], within(0.0, 1.0), AUTHORITY)
        .meaning("Most that the derivative gives"),
    number(["rate", "yaw_p_limit"], within(0.0, 1.0), AUTHORITY)
        .meaning("Most that yaw's proportional term gives"),
    number(["rate", "yaw_jump_limit"], within(0.0, 1.0), AUTHORITY)
        .meaning("Most that yaw gives where no yaw rate is asked for"),
    number(
        ["rate", "yaw_jump_slope"],
        within(0.0, 2.0),
        "share of full authority per rad/s",
    )
    .meaning("What the desired yaw rate adds to that"),
    number(["tpa", "attenuation"], within(0.0, 1.0), "share")
        .meaning("What is taken from roll and pitch at full thrust"),
    number(["tpa", "breakpoint"], within(0.0, 1.0), THRUST).meaning("Where that begins"),
    number(["altitude", "p"], within(0.0, 5.0), "1/s")
        .meaning("Climb rate asked for per metre that is missing"),
    number(["altitude", "error_limit_m"], above(0.0, 100.0), "m")
        .named("ALTITUDE_ERROR_LIMIT")
        .meaning("The largest error that counts"),
    number(["altitude", "deadband_m"], within(0.0, 1.0), "m")
        .named("ALTITUDE_DEADBAND")
        .meaning("The smallest error that counts"),
    number(["altitude", "climb_limit_m_s"], above(0.0, 10.0), "m/s")
        .named("ALTITUDE_CLIMB_LIMIT")
        .meaning("The fastest climb and descent asked for"),
    number(
        ["altitude", "velocity_p"],
        within(0.0, 2.0),
        "share of full thrust per m/s",
    )
    .meaning("Thrust per error of the climb rate"),
    number(
        ["altitude", "velocity_i"],
        within(0.0, 1.0),
        "share of full thrust per m",
    )
    .meaning("Thrust per integrated error of the climb rate"),
    number(
        ["altitude", "velocity_d"],
        within(0.0, 0.1),
        "share of full thrust per m/s2",
    )
    .meaning("Thrust taken back per upward acceleration"),
    number(["altitude", "p_limit"], within(0.0, 1.0), THRUST)
        .meaning("Most that the proportional term gives"),
    number(["altitude", "integral_limit"], within(0.0, 1.0), THRUST)
        .meaning("Most that the integral holds"),
    number(["altitude", "d_limit"], within(0.0, 1.0), THRUST)
        .meaning("Most that the derivative gives"),
    number(["altitude", "accel_cutoff_hz"], within(0.5, 50.0), "Hz")
        .named("ALTITUDE_ACCEL_CUTOFF")
        .meaning("Corner of the vertical acceleration's low-pass filter"),
    number(["altitude", "hover_thrust"], within(0.0, 1.0), THRUST)
        .meaning("Thrust taken for hovering where the setpoint's is too low"),
    number(["altitude", "low_thrust"], within(0.0, 0.5), THRUST)
        .meaning("Below it thrust counts as none"),
    number(["position", "p"], within(0.0, 5.0), "1/s")
        .meaning("Speed asked for per metre that is missing"),
    number(["position", "speed_limit_m_s"], above(0.0, 10.0), "m/s")
        .named("POSITION_SPEED_LIMIT")
        .meaning("The highest speed asked for"),
    number(["position", "velocity_p"], within(0.0, 1.0), "rad per m/s")
        .meaning("Lean per error of the speed"),
    number(["position", "velocity_i"], within(0.0, 1.0), "rad/m")
        .meaning("Lean per integrated error of speed and position"),
    number(["position", "velocity_d"], within(0.0, 1.0), "rad per m/s")
        .meaning("Lean against the speed"),
    number(["position", "d_least_speed_m_s"], within(0.0, 5.0), "m/s")
        .named("POSITION_D_LEAST_SPEED")
        .meaning("The speed below which nothing is leaned against"),
    number(["position", "integral_limit_rad"], within(0.0, 1.0), "rad")
        .named("POSITION_INTEGRAL_LIMIT")
        .meaning("Most that the integral holds and the derivative gives"),
    number(["position", "lean_limit_rad"], above(0.0, 1.0), "rad")
        .named("POSITION_LEAN_LIMIT")
        .meaning("The farthest lean that the hold asks for"),
    number(["position", "slew_rad_s"], above(0.0, 20.0), "rad/s")
        .named("POSITION_SLEW")
        .meaning("How fast that lean may change"),
];

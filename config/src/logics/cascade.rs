//! The gains of `logics/cascade.toml`.

use super::{above, axes, number, within};
use crate::logic::Gain;

pub(crate) const GAINS: &[Gain] = &[
    number(["estimate", "accel_correction"], within(0.0, 10.0), "1/s")
        .named("ACCEL_CORRECTION")
        .meaning("How fast the attitude follows the accelerometer"),
    number(["estimate", "heading_correction"], within(0.0, 10.0), "1/s")
        .named("HEADING_CORRECTION")
        .meaning("How fast the heading follows the magnetometer"),
    axes(["attitude", "p"], within(0.0, 30.0), "1/s")
        .meaning("Body rate asked for per radian of error")
        .grows(1),
    axes(["attitude", "rate_limit_rad_s"], above(0.0, 35.0), "rad/s")
        .named("ATTITUDE_RATE_LIMIT")
        .meaning("Most that the attitude loop asks for"),
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
    number(
        ["rate", "integral_limit"],
        within(0.0, 1.0),
        "share of full authority",
    )
    .named("INTEGRAL_LIMIT")
    .meaning("Most that the integral holds"),
];

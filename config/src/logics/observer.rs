//! The gains of `logics/observer.toml`.

use super::{axes, number, within};
use crate::logic::Gain;

pub(crate) const GAINS: &[Gain] = &[
    axes(
        ["rate", "p"],
        within(0.0, 2.0),
        "share of full authority per rad/s",
    )
    .meaning("Torque asked for per error of the rate")
    .grows(1),
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
    axes(
        ["observer", "effectiveness"],
        within(1.0, 5000.0),
        "rad/s2 per share of full authority",
    )
    .named("EFFECTIVENESS")
    .meaning("Angular acceleration that the motors give"),
    number(["observer", "lag_s"], within(0.001, 1.0), "s")
        .named("LAG")
        .meaning("Lag from a demand to a measured rate"),
    number(["observer", "bandwidth"], within(0.01, 50.0), "1/s")
        .named("OBSERVER_BANDWIDTH")
        .meaning("How fast the estimate follows what disturbs")
        .grows(1),
    number(
        ["observer", "limit"],
        within(0.0, 1.0),
        "share of full authority",
    )
    .named("CANCELLED_LIMIT")
    .meaning("Most that is cancelled"),
];

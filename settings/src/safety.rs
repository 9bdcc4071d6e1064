//! The constants of `config/safety.toml`: arming, and the end of a flight.

use crate::range::{above, within};
use crate::setting::{Kind, Setting};

const fn span(section: &'static str, key: &'static str, low: f64, high: f64) -> Setting {
    Setting::of([section, key], Kind::Span(within(low, high)), "s")
}

const fn number(
    section: &'static str,
    key: &'static str,
    [low, high]: [f64; 2],
    unit: &'static str,
) -> Setting {
    Setting::of([section, key], Kind::Number(above(low, high)), unit)
}

/// Everything of `safety.toml`.
pub const SAFETY: &[Setting] = &[
    number("arming", "most_thrust", [0.0, 0.3], "")
        .default("0.05")
        .named("ARMING_THRUST")
        .meaning("Most thrust that a setpoint may ask for where motors are armed."),
    number("arming", "most_tilt_deg", [0.0, 60.0], "deg")
        .default("25")
        .named("ARMING_TILT")
        .meaning("Most tilt at which motors are armed."),
    number("arming", "most_rate_rad_s", [0.0, 1.0], "rad/s")
        .default("0.1")
        .named("ARMING_RATE")
        .meaning("Fastest turn at which motors are armed."),
    number("arming", "gravity_error_m_s2", [0.0, 5.0], "m/s2")
        .default("1")
        .named("ARMING_GRAVITY_ERROR")
        .meaning(
            "Most by which the specific force may differ from gravity where motors are armed.",
        ),
    number("motor_test", "most_share", [0.0, 0.5], "")
        .default("0.15")
        .named("MOTOR_TEST_SHARE")
        .meaning("Largest command of a motor that is tested, as a share of full scale."),
    span("motor_test", "longest_s", 0.1, 10.0)
        .default("3")
        .named("MOTOR_TEST_TIME")
        .meaning("Longest time for which a motor is tested."),
    number("ground", "idle_thrust", [0.0, 0.5], "")
        .default("0.15")
        .named("IDLE_THRUST")
        .meaning("Collective thrust above which the drone may be in the air."),
    span("ground", "longest_s", 1.0, 600.0)
        .default("10")
        .named("LONGEST_ON_GROUND")
        .meaning("Time armed on the ground after which motors are disarmed."),
    number("ground", "lifting_thrust", [0.0, 1.0], "")
        .default("0.25")
        .named("LIFTING_THRUST")
        .meaning("Collective thrust with which most drones begin to climb."),
    span("ground", "lifting_s", 0.0, 10.0)
        .default("0.5")
        .named("LIFTING_TIME")
        .meaning("Time of that thrust after which the drone flies."),
    number("ground", "lifted_m_s", [0.0, 10.0], "m/s")
        .default("0.5")
        .named("LIFTED_SPEED")
        .meaning("Upward speed, by the push that is felt, that shows a take-off."),
    number("ground", "rest_rate_rad_s", [0.0, 5.0], "rad/s")
        .default("0.3")
        .named("REST_RATE")
        .meaning("Fastest turn of a drone at rest."),
    number("ground", "rest_force_m_s2", [0.0, 5.0], "m/s2")
        .default("2")
        .named("REST_FORCE")
        .meaning("Most by which the specific force differs from gravity at rest."),
    span("ground", "landed_s", 0.2, 10.0)
        .default("1")
        .named("LANDED_TIME")
        .meaning("Time at rest, at no more than idle thrust, that shows a landing."),
    span("pilot_silent", "wait_s", 0.0, 60.0)
        .default("3")
        .named("WAITING_TIME")
        .meaning("Time level, or at the last goal, before a drone without a pilot descends."),
    number("pilot_silent", "descent_thrust", [0.0, 1.0], "")
        .default("0.9")
        .named("DESCENT_THRUST")
        .meaning("Thrust of a descent by neither place nor accelerometer, as a share of the mean."),
    number("pilot_silent", "descent_m_s", [0.0, 5.0], "m/s")
        .default("1")
        .named("DESCENT_SPEED")
        .meaning("Speed of a descent."),
    span("pilot_silent", "descent_s", 0.0, 120.0)
        .default("60")
        .named("DESCENT_TIME")
        .meaning("Time of a descent without a place, after which motors are cut."),
    span("blind", "cut_s", 0.0, 5.0)
        .default("0.5")
        .named("BLIND_TIME")
        .meaning("Time without the gyroscope in the air after which motors are cut."),
    Setting::of(["motor_lost", "fewest"], Kind::Count(within(1.0, 8.0)), "")
        .default("5")
        .named("FEWEST_TO_FLY")
        .meaning("Fewest motors that a drone is flown with once one is lost."),
    number("upset", "tilt_deg", [0.0, 180.0], "deg")
        .default("60")
        .named("UPSET_TILT")
        .meaning("Tilt from level, at rest, or from what is asked for, that is an upset."),
    span("upset", "after_s", 0.1, 10.0)
        .default("1")
        .named("UPSET_TIME")
        .meaning("Time of an upset after which motors are cut."),
    Setting::of(["battery", "descend_when_empty"], Kind::Flag, "")
        .default("true")
        .named("DESCEND_WHEN_EMPTY")
        .meaning("Whether the drone comes down by itself once the battery is nearly empty."),
    Setting::of(
        ["commands", "not_finite"],
        Kind::Count(within(1.0, 1000.0)),
        "",
    )
    .default("3")
    .named("NOT_FINITE_LIMIT")
    .meaning("Commands in a row that are no numbers, after which motors are cut."),
];

//! The constants of `config/reactive.toml`: how control learns when to run.

use crate::inputs::Input;
use crate::range::{above, within};
use crate::setting::{Kind, Limit, Setting};

/// A time in s.
const fn span(section: &'static str, key: &'static str, low: f64, high: f64) -> Setting {
    Setting::of([section, key], Kind::Span(within(low, high)), "s")
}

const fn count(section: &'static str, key: &'static str, low: f64, high: f64) -> Setting {
    Setting::of([section, key], Kind::Count(within(low, high)), "")
}

const fn number(section: &'static str, key: &'static str, low: f64, high: f64) -> Setting {
    Setting::of([section, key], Kind::Number(within(low, high)), "")
}

/// One step of this many in a full scale.
const fn step(section: &'static str, key: &'static str) -> Setting {
    let kind = Kind::Step {
        share: above(0.0, 0.5),
        steps: within(2.0, 65_535.0),
    };
    Setting::of([section, key], kind, "")
}

/// What moves an amount above 0.
const fn move_of(key: &'static str, most: f64, unit: &'static str) -> Setting {
    Setting::of(["setpoint", key], Kind::Number(above(0.0, most)), unit)
}

/// Everything of `reactive.toml` that is no run-time setting and belongs to no input.
pub const REACTIVE: &[Setting] = &[
    span("warm_up", "shortest_s", 0.0, 30.0)
        .limited(Limit::LongestWarmUp)
        .default("3")
        .named("SHORTEST_WARM_UP")
        .meaning("The least that an automatic warm-up lasts."),
    Setting::of(["warm_up", "longest_s"], Kind::Span(above(0.0, 30.0)), "s")
        .default("30")
        .named("LONGEST_WARM_UP")
        .meaning("The most that any warm-up lasts, `T_boot`."),
    count("warm_up", "labels_of_each_class", 1.0, 10_000.0)
        .default("30")
        .named("LABELS_OF_EACH_CLASS")
        .meaning("Labels of each class that a model needs."),
    Setting::of(
        ["warm_up", "stable_change"],
        Kind::Number(above(0.0, 1.0)),
        "",
    )
    .default("0.1")
    .named("STABLE_CHANGE")
    .meaning("How far from `P_run` a refit may see the old threshold while it counts as stable."),
    span("learning", "forgetting_s", 1.0, 3600.0)
        .default("20")
        .named("FORGETTING")
        .meaning("Time constant with which old labels are forgotten."),
    span("learning", "refit_interval_s", 0.05, 60.0)
        .default("0.5")
        .named("REFIT_INTERVAL")
        .meaning("Time between refits."),
    number("learning", "refit_news_share", 0.0, 1.0)
        .default("0.1")
        .named("REFIT_NEWS")
        .meaning("Weight of new labels that is worth a refit, as a share of those before."),
    span("learning", "longest_refit_interval_s", 0.05, 600.0)
        .default("5")
        .named("LONGEST_REFIT_INTERVAL")
        .meaning("After this long a model is refitted, whatever is new."),
    number("learning", "exploration_share", 0.0, 0.1)
        .default("0.00048828125")
        .named("EXPLORATION_SHARE")
        .meaning("Probability of an exploration run in a hyperperiod."),
    number("learning", "exploration_weight_cap", 1.0, 256.0)
        .default("16")
        .named("EXPLORATION_WEIGHT_CAP")
        .meaning("Most that one exploration label weighs."),
    span("fallback", "window_s", 1.0, 60.0)
        .default("10")
        .named("JUDGED_WINDOW")
        .meaning("Length of the window in which runs are judged."),
    count("fallback", "fewest_runs", 10.0, 10_000.0)
        .default("100")
        .named("JUDGED_RUNS")
        .meaning("Runs that a share is judged by."),
    number("fallback", "false_positive_excess", 0.0, 1.0)
        .default("0.25")
        .named("FALSE_POSITIVE_EXCESS")
        .meaning("Share of false positives beyond `1 - P_run` that ends reactive control."),
    number("fallback", "missed_excess", 0.0, 1.0)
        .default("0.25")
        .named("MISSED_EXCESS")
        .meaning("Share of failsafe runs beyond `P_run` whose change was missed that ends it."),
    count("fallback", "late_runs", 1.0, 10_000.0)
        .default("10")
        .named("LATE_RUNS")
        .meaning("Runs in a window that may begin a hyperperiod late."),
    Setting::of(
        ["fallback", "aerobatics_rad_s"],
        Kind::Number(above(0.0, 40.0)),
        "rad/s",
    )
    .default("30")
    .named("AEROBATICS")
    .meaning("Setpoints that turn faster than this end reactive control."),
    span("fallback", "longest_s", 1.0, 600.0)
        .default("60")
        .named("LONGEST_FALLBACK")
        .meaning(
            "Upper limit of the minimum duration of a fallback, which doubles with every one that \
         follows soon on another.",
        ),
    move_of("angle_quantum_rad", 1.0, "rad")
        .default("0.02")
        .named("SETPOINT_ANGLE_QUANTUM")
        .meaning("Move of an attitude setpoint that forces a run."),
    move_of("rate_quantum_rad_s", 10.0, "rad/s")
        .default("0.05")
        .named("SETPOINT_RATE_QUANTUM")
        .meaning("Move of a body rate setpoint that forces a run."),
    move_of("position_quantum_m", 10.0, "m")
        .default("0.05")
        .named("SETPOINT_POSITION_QUANTUM")
        .meaning("Move of a place to fly to that forces a run."),
    step("setpoint", "thrust_steps")
        .default("255")
        .named("SETPOINT_THRUST_QUANTUM")
        .meaning("Move of a thrust setpoint that forces a run, as a share."),
];

/// What every input has in its own table of `[inputs]`.
pub const INPUT: &[Setting] = &[
    Setting::of(["", "gates"], Kind::Flag, "")
        .named("gates")
        .meaning("Its period enters the hyperperiod, which waits for its sample."),
    Setting::of(["", "triggers"], Kind::Flag, "")
        .named("triggers")
        .meaning("Its model may ask for a run."),
    change("smallest_change")
        .named("smallest")
        .meaning("Lower end of the bins in which its changes are counted, in its unit."),
    change("largest_change")
        .named("largest")
        .meaning("Upper end of the bins in which its changes are counted, in its unit."),
];

const fn change(key: &'static str) -> Setting {
    Setting::of(["", key], Kind::Number(above(0.0, 1000.0)), "")
}

/// Those of [`INPUT`] that an input has: only a sensor can gate.
pub fn of_input(input: Input) -> impl Iterator<Item = &'static Setting> {
    let sensed = Input::SENSED.contains(&input);
    INPUT
        .iter()
        .filter(move |setting| sensed || setting.name != "gates")
}

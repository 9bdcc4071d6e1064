//! `reactive.toml` as documented constants.

use super::{Constant, Value, duration, float, literal, micros, one_step, value};
use crate::{
    Board, DerivedInput, Fallback, Feedback, Input, MotorProtocol, Pairs, Policy, Reactive,
    Reference, WarmUpLength,
};

pub(super) fn runs(reactive: &Reactive, board: &Board) -> Vec<Constant> {
    let period = 1.0 / reactive.runs.periodic_rate_hz;
    let hyperperiod = reactive.hyperperiod_us(board);
    vec![
        (
            "SETTINGS",
            settings(reactive, board),
            "Settings that hold where no valid block brings others.",
        ),
        (
            "PERIODIC_PERIOD",
            duration(period),
            "Time between runs of the periodic policy where no rate is chosen.",
        ),
        (
            "HYPERPERIOD",
            value("Duration", format!("micros({hyperperiod})")),
            "Nominal least common multiple of the gating inputs' periods.",
        ),
        (
            "SHORTEST_WARM_UP",
            duration(reactive.warm_up.shortest_s),
            "The least that an automatic warm-up lasts.",
        ),
        (
            "LONGEST_WARM_UP",
            duration(reactive.warm_up.longest_s),
            "The most that any warm-up lasts, `T_boot`.",
        ),
    ]
}

fn settings(reactive: &Reactive, board: &Board) -> Value {
    let runs = &reactive.runs;
    let policy = match runs.policy {
        Policy::Reactive => "Policy::Reactive".to_owned(),
        Policy::Periodic => format!("Policy::Periodic({})", micros(1.0 / runs.periodic_rate_hz)),
    };
    let reference = match runs.reference {
        Reference::PreviousSample => "PreviousSample",
        Reference::LastRun => "LastRun",
    };
    let warm_up = match reactive.warm_up.length {
        WarmUpLength::Automatic => "Automatic".to_owned(),
        WarmUpLength::Seconds(seconds) => format!("Fixed({})", micros(seconds)),
    };
    let motors = match board.motors.protocol {
        MotorProtocol::OneShot125 => "OneShot125",
        MotorProtocol::Pwm => "Pwm",
    };
    let pairs = match reactive.warm_up.pairs {
        Pairs::FirstCrossings => "FirstCrossings",
        Pairs::WeightedLags => "WeightedLags",
        Pairs::Published => "Published",
    };
    let feedback = match reactive.learning.feedback {
        Feedback::Every => "Every",
        Feedback::Published => "Published",
    };
    let triggers = reactive.inputs.triggers();
    let text = format!(
        "Settings {{ policy: {policy}, reference: Reference::{reference}, p_run: {}, \
         warm_up: WarmUp::{warm_up}, warm_up_period: {}, failsafe: {}, quantum: {}, \
         motors: MotorProtocol::{motors}, \
         triggers: Inputs::from_bits({triggers:#b}), pairs: Pairs::{pairs}, \
         feedback: Feedback::{feedback}, seed: {} }}",
        literal(runs.p_run),
        micros(1.0 / reactive.warm_up.rate_hz),
        micros(runs.failsafe_s),
        one_step(runs.quantum_steps).text,
        reactive.learning.exploration_seed,
    );
    value("Settings", text)
}

pub(super) fn learning(reactive: &Reactive) -> Vec<Constant> {
    let (warm_up, learning) = (&reactive.warm_up, &reactive.learning);
    vec![
        (
            "LABELS_OF_EACH_CLASS",
            value("u32", warm_up.labels_of_each_class),
            "Labels of each class that a model needs.",
        ),
        (
            "STABLE_CHANGE",
            float(warm_up.stable_change),
            "How far from `P_run` a refit may see the old threshold while it counts as stable.",
        ),
        (
            "FORGETTING",
            duration(learning.forgetting_s),
            "Time constant with which old labels are forgotten.",
        ),
        (
            "REFIT_INTERVAL",
            duration(learning.refit_interval_s),
            "Time between refits.",
        ),
        (
            "EXPLORATION_SHARE",
            float(learning.exploration_share),
            "Probability of an exploration run in a hyperperiod.",
        ),
        (
            "EXPLORATION_WEIGHT_CAP",
            float(learning.exploration_weight_cap),
            "Most that one exploration label weighs.",
        ),
    ]
}

pub(super) fn fallback(fallback: &Fallback) -> Vec<Constant> {
    vec![
        (
            "JUDGED_WINDOW",
            duration(fallback.window_s),
            "Length of the window in which runs are judged.",
        ),
        (
            "JUDGED_RUNS",
            value("u32", fallback.fewest_runs),
            "Runs that a share is judged by.",
        ),
        (
            "FALSE_POSITIVE_EXCESS",
            float(fallback.false_positive_excess),
            "Share of false positives beyond `1 - P_run` that ends reactive control.",
        ),
        (
            "MISSED_EXCESS",
            float(fallback.missed_excess),
            "Share of failsafe runs beyond `P_run` whose change was missed that ends it.",
        ),
        (
            "LATE_RUNS",
            value("u32", fallback.late_runs),
            "Runs in a window that may begin a hyperperiod late.",
        ),
        (
            "AEROBATICS",
            float(fallback.aerobatics_rad_s),
            "Setpoints that turn faster than this, rad/s, end reactive control.",
        ),
        (
            "LONGEST_FALLBACK",
            duration(fallback.longest_s),
            "The longest that a fallback lasts at least.",
        ),
    ]
}

pub(super) fn inputs(reactive: &Reactive, board: &Board) -> Vec<Constant> {
    let [gyro, accel, chip_accel, chip_mag] = reactive.inputs.with_rates(board);
    let inputs = &reactive.inputs;
    let setpoint = &reactive.setpoint;
    vec![
        ("GYRO", input(gyro), "The MPU6050's gyro; changes in rad/s."),
        (
            "ACCEL",
            input(accel),
            "The MPU6050's accelerometer; changes in m/s2.",
        ),
        (
            "CHIP_ACCEL",
            input(chip_accel),
            "The LSM303AGR's accelerometer; changes in m/s2.",
        ),
        (
            "CHIP_MAG",
            input(chip_mag),
            "The LSM303AGR's magnetometer; changes in gauss.",
        ),
        (
            "TURNED",
            derived(&inputs.turned),
            "The angle turned since the last run; changes in rad.",
        ),
        (
            "COMMAND",
            derived(&inputs.command),
            "The change of the motor command that a run would make; changes in quanta.",
        ),
        (
            "SETPOINT_ANGLE_QUANTUM",
            float(setpoint.angle_quantum_rad),
            "Move of an attitude setpoint that forces a run, in rad.",
        ),
        (
            "SETPOINT_RATE_QUANTUM",
            float(setpoint.rate_quantum_rad_s),
            "Move of a body rate setpoint that forces a run, in rad/s.",
        ),
        (
            "SETPOINT_POSITION_QUANTUM",
            float(setpoint.position_quantum_m),
            "Move of a place to fly to that forces a run, in m.",
        ),
        (
            "SETPOINT_THRUST_QUANTUM",
            one_step(setpoint.thrust_steps),
            "Move of a thrust setpoint that forces a run, as a share.",
        ),
    ]
}

fn input((_, input, rate): (&str, &Input, u32)) -> Value {
    let text = format!(
        "SensorInput {{ period: micros({}), gates: {}, changes: {} }}",
        1_000_000 / rate,
        input.gates,
        changes(input.smallest_change, input.largest_change),
    );
    value("SensorInput", text)
}

fn derived(input: &DerivedInput) -> Value {
    value(
        "Changes",
        changes(input.smallest_change, input.largest_change),
    )
}

fn changes(smallest: f64, largest: f64) -> String {
    let (smallest, largest) = (literal(smallest), literal(largest));
    format!("Changes {{ smallest: {smallest}, largest: {largest} }}")
}

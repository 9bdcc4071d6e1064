//! `load.toml`: what both policies take of the processor, with every control logic.
//!
//! `REFLEX_BLESS=1 cargo test -p hil-tests --profile hil --ignore-rust-version the_table_of_loads`
//! measures every logic and rewrites the table; without the variable the configured one must take
//! what the table says. `cargo hil test` holds reactive control with each logic against it too.

use std::collections::BTreeMap;

use clap::ValueEnum;

use super::*;
use crate::logics::LogicName;
use crate::scoring::{Busy, Cost, LOADS, LoadTable, LogicCosts};
use crate::toolchain;
use reflex::config::SETTINGS;
use reflex::sensors::Input;

const HEAD: &str = "\
# Instructions that a policy takes of the processor: of a hyperperiod without a run, and of a run beside
# it, with everything around them. For loads of native replays, and of periodic control in all replays.
# Measured on the emulated board over the flight that comes with the crates; a test keeps it so and
# rewrites it with REFLEX_BLESS=1: `hil-tests/src/replay/emulated/tests/load.rs`.

";

/// Seconds of the flight: long enough that what is rare makes no difference.
const LENGTH_S: f64 = 20.0;

/// Share by which a load may differ from the table's.
const MOST_OFF: f64 = 0.02;

/// What a replay took.
fn busy(logic: LogicName, settings: Settings) -> Busy {
    let options = ReplayOptions {
        gains: logic.into(),
        ..seconds(LENGTH_S, settings)
    };
    let Report { run, score, .. } = fly(&options);
    let length_s = score.duration_s - score.warm_up_s;
    Busy {
        samples_hz: score.hyperperiods as f64 / length_s,
        runs_hz: score.section.control.runs as f64 / length_s,
        share: run.cpu.and_then(|cpu| cpu.busy_fraction).expect("a load"),
    }
}

/// Reactive control that runs this many times as rarely as the default, or as often.
fn reactive(quanta: f32) -> Settings {
    Settings {
        quantum: quanta * SETTINGS.quantum,
        ..SETTINGS
    }
}

fn periodic(hertz: u64) -> Settings {
    Settings {
        policy: Policy::Periodic,
        period: micros(1_000_000 / hertz),
        ..SETTINGS
    }
}

fn measured(logic: LogicName) -> LogicCosts {
    let cost = |settings: [Settings; 2]| {
        let [one, other] = settings.map(|settings| busy(logic, settings));
        let cost = Cost::between(LOADS.core_hz, one, other).expect("more runs are more work");
        Cost {
            sample: cost.sample.round(),
            run: cost.run.round(),
        }
    };
    let costs = cost([reactive(2.0), reactive(0.25)]);
    LogicCosts {
        reactive: costs,
        periodic: cost([periodic(50), periodic(400)]),
        foresight: foresight(logic, &costs).round(),
    }
}

/// What a sample takes more where the command is foreseen exactly, at each.
fn foresight(logic: LogicName, reactive: &Cost) -> f64 {
    let triggers = SETTINGS.triggers.with(Input::Command);
    let busy = busy(
        logic,
        Settings {
            triggers,
            ..SETTINGS
        },
    );
    let predicted = reactive.load(LOADS.core_hz, busy.samples_hz, busy.runs_hz);
    (busy.share - predicted) * LOADS.core_hz / busy.samples_hz
}

#[test]
fn the_table_of_loads_is_what_the_board_shows() {
    if std::env::var_os("REFLEX_BLESS").is_some_and(|flag| flag == "1") {
        let logics = LogicName::value_variants().iter();
        let logics = logics.map(|logic| (logic.word().to_owned(), measured(*logic)));
        let table = LoadTable {
            core_hz: LOADS.core_hz,
            logics: logics.collect::<BTreeMap<_, _>>(),
        };
        let text = toml::to_string(&table).expect("TOML");
        let file = toolchain::root().join("hil-tests/load.toml");
        std::fs::write(file, format!("{HEAD}{text}")).expect("load.toml is writable");
        return;
    }
    let logic = LogicName::configured();
    let costs = LOADS.logics[logic.word()];
    for (cost, settings) in [
        (costs.reactive, reactive(1.0)),
        (costs.periodic, periodic(100)),
    ] {
        let busy = busy(logic, settings);
        let by_table = cost.load(LOADS.core_hz, busy.samples_hz, busy.runs_hz);
        assert!(
            (by_table / busy.share - 1.0).abs() < MOST_OFF,
            "load.toml says {by_table:.5} of {busy:?}: look at it, then REFLEX_BLESS=1"
        );
    }
}

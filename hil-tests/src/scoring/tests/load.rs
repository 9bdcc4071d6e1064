//! Periodic control at equal load: its rate, and what it says where no rate fits.

use super::super::periodic::{EqualLoad, Flown};
use super::super::{Cost, LoadRules, Reach};
use super::*;

/// A flight of 10 s at 1 kHz.
fn flight() -> FlightSteps {
    let mut flight = after_warm_up(0.5);
    for index in 0..10_000 {
        end(&mut flight, 0.5 + (index % 7) as f32 / 256.0, None);
    }
    flight
}

/// At equal load with a policy of so many runs, 300 instructions a sample and 100 a run.
fn equal_load(runs: u64, sample: f64, busy: Option<f64>) -> EqualLoad {
    let flight = flight();
    let rules = rules();
    let load = LoadRules {
        core_hz: 1e6,
        policy: Cost { sample, run: 100.0 },
        periodic: Cost {
            sample: 200.0,
            run: 400.0,
        },
        foresight: 0.0,
        busy,
    };
    let fly = |clock| fly(&flight, clock);
    let mut periodic = Flown {
        flight: &flight,
        rules: &rules,
        fly,
    };
    periodic.equal_load(runs, &load).expect("a scored flight")
}

#[test]
fn periodic_control_runs_as_often_as_takes_the_policys_load() {
    // 300 at 1 kHz and 100 at 100 Hz are 31 % of a million; less 20 % that is 275 runs of 400.
    let found = equal_load(1000, 300.0, None);
    assert_eq!(
        (found.policy_load_by_table, found.reach),
        (0.31, Reach::Within)
    );
    assert!(found.periodic.runs.abs_diff(2750) <= 5, "{found:?}");
    assert!((found.load_by_table - 0.31).abs() < 1e-3);
}

#[test]
fn a_measured_load_counts_before_the_tables() {
    let found = equal_load(1000, 300.0, Some(0.36));
    assert_eq!(found.policy_load_measured, Some(0.36));
    assert_eq!(found.policy_load_by_table, 0.31);
    assert_eq!(found.policy_load(), 0.36);
    assert!(found.periodic.runs.abs_diff(4000) <= 5, "{found:?}");
}

#[test]
fn a_load_that_no_rate_takes_is_set_beside_the_nearest_and_said() {
    let above = equal_load(1000, 900.0, None);
    assert_eq!(above.reach, Reach::AboveHighest);
    assert_eq!(above.periodic.rate_hz, Some(1000.0));
    assert!(above.load_by_table < above.policy_load());
    let below = equal_load(1000, 100.0, None);
    assert_eq!(below.reach, Reach::BelowLowest);
    assert!(below.load_by_table > below.policy_load());
}

#[test]
fn nothing_is_flown_where_nobody_measured_or_nothing_is_scored() {
    assert_eq!(scored(&flight()).periodic_equal_load, None);
    let empty = FlightSteps::new(0, all(0.5));
    let rules = rules();
    let mut periodic = Flown {
        flight: &empty,
        rules: &rules,
        fly: |_| panic!("flown"),
    };
    let cost = Cost {
        sample: 1.0,
        run: 1.0,
    };
    let load = LoadRules {
        core_hz: 1e6,
        policy: cost,
        periodic: cost,
        foresight: 0.0,
        busy: None,
    };
    assert_eq!(periodic.equal_load(0, &load), None);
}

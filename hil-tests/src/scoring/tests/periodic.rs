//! Periodic control at equal runs: even spacing, and the search for the rate.

use super::super::periodic::{periodic_equal, periodic_ideal};
use super::*;

fn ramp(hyperperiods: u64) -> Flight {
    let mut flight = after_warm_up(0.0);
    for index in 1..=hyperperiods {
        end(&mut flight, index as f32 / 1024.0, None);
    }
    flight
}

#[test]
fn the_ideal_form_spaces_its_runs_evenly_and_ends_on_one() {
    let flight = ramp(8);
    // Runs at the 4th and 8th: 1, 2, 3, 0, 1, 2, 3, 0 steps behind.
    let two = periodic_ideal(&flight.scored(), 1.0 / 1024.0, 2);
    assert_eq!((two.runs, two.rate_hz), (2, Some(2.0 / 0.008)));
    let mean_square: f64 = 2.0 * (1.0 + 4.0 + 9.0) / 8.0;
    assert!((two.rms_deviation_quanta.unwrap() - mean_square.sqrt()).abs() < 1e-9);
    assert_eq!(two.stale_fraction, Some(0.75));
    // Three in eight: at the 3rd, 6th and 8th.
    let three = periodic_ideal(&flight.scored(), 1.0 / 1024.0, 3);
    let mean_square: f64 = (1.0 + 4.0 + 1.0 + 4.0 + 1.0) / 8.0;
    assert!((three.rms_deviation_quanta.unwrap() - mean_square.sqrt()).abs() < 1e-9);
}

#[test]
fn the_ideal_form_without_a_run_keeps_the_warm_ups_command() {
    let none = periodic_ideal(&ramp(2).scored(), 1.0 / 1024.0, 0);
    assert_eq!((none.runs, none.stale_fraction), (0, Some(1.0)));
}

#[test]
fn a_rate_is_found_that_gives_as_many_runs() {
    let flight = ramp(10_000);
    for target in [10, 123, 1000, 3333, 6000, 9999, 10_000] {
        let found = periodic_equal(&flight, &rules(), target, |rate_hz| fly(&flight, rate_hz));
        assert!(
            found.runs.abs_diff(target) <= target / 500,
            "{} runs for {target}",
            found.runs
        );
    }
}

#[test]
fn a_policy_that_runs_off_its_rate_is_met_by_another_rate() {
    // Failsafe and setpoint runs add to the clock's; a busy board takes some away.
    let flight = ramp(10_000);
    for (factor, target) in [(0.7, 3000), (1.4, 3000), (0.7, 150), (1.4, 150)] {
        let off = |rate_hz: f64| fly(&flight, rate_hz * factor);
        let found = periodic_equal(&flight, &rules(), target, off);
        assert!(
            found.runs.abs_diff(target) <= target / 500,
            "{} runs for {target}",
            found.runs
        );
    }
}

#[test]
fn a_rate_beyond_the_policys_range_is_not_tried() {
    let flight = ramp(1000);
    let rules = Rules {
        periodic_hz: 50.0..=200.0,
        ..rules()
    };
    for (target, nearest) in [(1, 50), (900, 200)] {
        let found = periodic_equal(&flight, &rules, target, |rate_hz| {
            assert!((50.0..=200.0).contains(&rate_hz), "{rate_hz} Hz tried");
            fly(&flight, rate_hz)
        });
        assert!(found.runs.abs_diff(nearest) <= 1, "{} runs", found.runs);
    }
}

#[test]
fn where_no_rate_matches_the_nearest_runs_are_reported() {
    // A clock that loses its phase reaches only whole fractions of 1000 Hz.
    let flight = ramp(1000);
    let coarse = |rate_hz: f64| fly(&flight, 1000.0 / (1000.0 / rate_hz).ceil());
    let found = periodic_equal(&flight, &rules(), 700, coarse);
    assert!(found.runs.abs_diff(500) <= 1, "{} runs", found.runs);
}

#[test]
fn its_own_command_is_scored_and_only_after_warm_up() {
    let mut flight = after_warm_up(0.0);
    end(&mut flight, 0.5, run(Reason::Trigger, 0.5));
    end(&mut flight, 0.5, run(Reason::Trigger, 0.5));
    let held = |command: f32, runs| Held {
        command: all(command),
        runs,
    };
    let found = periodic_equal(&flight, &rules(), 2, |_| {
        vec![held(1.0, 5), held(0.25, 1), held(0.5, 1)]
    });
    assert_eq!((found.runs, found.stale_fraction), (2, Some(0.5)));
    assert_eq!(found.rms_deviation_quanta, Some(0.5_f64.sqrt()));
}

#[test]
fn nothing_is_flown_where_nothing_is_scored() {
    let flight = Flight::new(0, all(0.0));
    let found = periodic_equal(&flight, &rules(), 5, |_| panic!("flown"));
    assert_eq!((found.runs, found.rate_hz), (0, None));
}

//! Periodic control: even spacing, the search for the rate, mean over phases.

use super::super::periodic::{Flown, PHASES, Periodic, ideal, periodic_ideal};
use super::*;

fn ramp(hyperperiods: u64) -> FlightSteps {
    let mut flight = after_warm_up(0.0);
    for index in 1..=hyperperiods {
        end(&mut flight, index as f32 / 1024.0, None);
    }
    flight
}

fn periodic_equal(
    flight: &FlightSteps,
    rules: &Rules,
    target: u64,
    fly: impl FnMut(Clock) -> Vec<Held>,
) -> Periodic {
    Flown { flight, rules, fly }.equal_runs(target)
}

#[test]
fn the_ideal_form_spaces_its_runs_evenly_and_ends_on_one() {
    let flight = ramp(8);
    // Runs at the 4th and 8th: 1, 2, 3, 0, 1, 2, 3, 0 steps behind.
    let two = ideal(&flight.scored(), 1.0 / 1024.0, 2, 1.0);
    assert_eq!((two.runs, two.rate_hz), (2, Some(2.0 / 0.008)));
    let mean_square: f64 = 2.0 * (1.0 + 4.0 + 9.0) / 8.0;
    let two = two.deviation;
    assert!((two.rms_deviation_quanta.unwrap() - mean_square.sqrt()).abs() < 1e-9);
    assert_eq!(two.stale_fraction, Some(0.75));
    assert_eq!(two.largest_deviation_quanta, Some(3.0));
    // Three in eight: at the 3rd, 6th and 8th.
    let three = ideal(&flight.scored(), 1.0 / 1024.0, 3, 1.0).deviation;
    let mean_square: f64 = (1.0 + 4.0 + 1.0 + 4.0 + 1.0) / 8.0;
    assert!((three.rms_deviation_quanta.unwrap() - mean_square.sqrt()).abs() < 1e-9);
}

#[test]
fn a_phase_of_the_ideal_form_moves_its_first_run() {
    let flight = ramp(8);
    // Runs at the 2nd and 6th: 1, 0, 1, 2, 3, 0, 1, 2 steps behind.
    let half = ideal(&flight.scored(), 1.0 / 1024.0, 2, 0.5);
    let mean_square: f64 = (1.0 + 1.0 + 4.0 + 9.0 + 1.0 + 4.0) / 8.0;
    assert_eq!(half.runs, 2);
    assert!((half.deviation.rms_deviation_quanta.unwrap() - mean_square.sqrt()).abs() < 1e-9);
}

/// A swing with as many hyperperiods a turn, 24, as periodic control has between 200 runs.
fn swing(shifted: u64) -> FlightSteps {
    let mut flight = after_warm_up(0.5);
    for index in shifted..shifted + 200 * 24 {
        let angle = std::f32::consts::TAU * (index % 24) as f32 / 24.0;
        end(&mut flight, 0.5 + 0.2 * angle.sin().powi(3), None);
    }
    flight
}

/// The largest over the least deviation of periodic control, wherever in a swing a flight begins.
fn spread(fly: impl Fn(&FlightSteps, Clock) -> Vec<Held>) -> f64 {
    let all = (0..24).map(|shifted| {
        let flight = swing(shifted);
        let found = periodic_equal(&flight, &rules(), 200, |clock| fly(&flight, clock));
        found.deviation.rms_deviation_quanta.expect("a deviation")
    });
    let all: Vec<f64> = all.collect();
    let [least, most] = [f64::min, f64::max].map(|of| all.iter().copied().reduce(of));
    most.expect("some") / least.expect("some")
}

#[test]
fn the_mean_over_phases_does_not_depend_on_where_in_a_swing_the_flight_began() {
    let with_phases = spread(fly);
    assert!(with_phases < 1.02, "{with_phases}");
    let with_one = spread(|flight, clock| {
        fly(
            flight,
            Clock {
                phase: 1.0,
                ..clock
            },
        )
    });
    assert!(with_one > 1.3, "{with_one}");
}

#[test]
fn every_phase_is_flown_once_at_the_rate_that_was_found() {
    let flight = ramp(10_000);
    let mut flown = Vec::new();
    let found = periodic_equal(&flight, &rules(), 500, |clock| {
        flown.push(clock);
        fly(&flight, clock)
    });
    let at_found = flown
        .iter()
        .filter(|clock| Some(clock.rate_hz) == found.rate_hz);
    let mut phases: Vec<f64> = at_found
        .map(|clock| clock.phase * f64::from(PHASES))
        .collect();
    phases.sort_by(f64::total_cmp);
    let each: Vec<f64> = (1..=PHASES).map(f64::from).collect();
    assert_eq!(phases, each);
}

#[test]
fn the_ideal_form_without_a_run_keeps_the_warm_ups_command() {
    let none = periodic_ideal(&ramp(2).scored(), 1.0 / 1024.0, 0);
    assert_eq!((none.runs, none.deviation.stale_fraction), (0, Some(1.0)));
}

#[test]
fn a_rate_is_found_that_gives_as_many_runs() {
    let flight = ramp(10_000);
    for target in [10, 123, 1000, 3333, 6000, 9999, 10_000] {
        let found = periodic_equal(&flight, &rules(), target, |clock| fly(&flight, clock));
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
        let off = |clock: Clock| {
            fly(
                &flight,
                Clock {
                    rate_hz: clock.rate_hz * factor,
                    ..clock
                },
            )
        };
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
        let found = periodic_equal(&flight, &rules, target, |clock| {
            assert!((50.0..=200.0).contains(&clock.rate_hz), "{clock:?} tried");
            fly(&flight, clock)
        });
        assert!(found.runs.abs_diff(nearest) <= 1, "{} runs", found.runs);
    }
}

#[test]
fn where_no_rate_matches_the_nearest_runs_are_reported() {
    // A clock that loses its phase reaches only whole fractions of 1000 Hz.
    let flight = ramp(1000);
    let coarse = |clock: Clock| {
        let rate_hz = 1000.0 / (1000.0 / clock.rate_hz).ceil();
        fly(&flight, Clock { rate_hz, ..clock })
    };
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
    assert_eq!((found.runs, found.deviation.stale_fraction), (2, Some(0.5)));
    let rms = found.deviation.rms_deviation_quanta.expect("a deviation");
    assert!((rms - 0.5_f64.sqrt()).abs() < 1e-12, "{rms}");
}

#[test]
fn nothing_is_flown_where_nothing_is_scored() {
    let flight = FlightSteps::new(0, all(0.0));
    let found = periodic_equal(&flight, &rules(), 5, |_| panic!("flown"));
    assert_eq!((found.runs, found.rate_hz), (0, None));
}

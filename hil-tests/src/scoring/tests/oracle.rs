//! The greedy rules: when they run, and which bound gives how many runs.

use super::super::oracle::{Bound, Track};
use super::*;

/// A flight of which only the reference matters, one hyperperiod a millisecond.
fn reference(commands: &[f32]) -> FlightSteps {
    let mut flight = after_warm_up(0.5);
    for share in commands {
        end(&mut flight, *share, None);
    }
    flight
}

fn track(flight: &FlightSteps, failsafe_us: u64) -> Track {
    let rules = Rules {
        failsafe_us,
        ..rules()
    };
    Track::new(&flight.scored(), &rules)
}

fn held_within(flight: &FlightSteps, failsafe_us: u64, bound: Bound) -> (u64, Vec<f32>) {
    let mut held = Vec::new();
    let runs = track(flight, failsafe_us).hold(bound, |_, command, _| held.push(command[0]));
    (runs, held)
}

fn held(flight: &FlightSteps, failsafe_us: u64, dead_band: f32) -> (u64, Vec<f32>) {
    held_within(flight, failsafe_us, Bound::DeadBand(dead_band))
}

#[test]
fn it_runs_exactly_when_the_reference_left_the_dead_band_of_what_is_held() {
    let flight = reference(&[0.625, 0.75, 0.875, 0.625, 0.5, 0.5]);
    let (runs, held) = held(&flight, 100_000, QUANTUM);
    // 0.75 is a quantum above the warm-up's 0.5; 0.5 is a quantum below 0.75.
    assert_eq!(held, [0.5, 0.75, 0.75, 0.75, 0.5, 0.5]);
    assert_eq!(runs, 2);
    let found = track(&flight, 100_000).oracle();
    assert_eq!((found.runs, found.deviation.stale_fraction), (2, Some(0.0)));
    // Half a quantum away in three of six hyperperiods.
    let expected = (3.0 * 0.25 / 6.0_f64).sqrt();
    assert!((found.deviation.rms_deviation_quanta.unwrap() - expected).abs() < 1e-9);
}

#[test]
fn it_runs_at_least_every_failsafe_interval() {
    // Too small a ramp to leave the dead-band; hyperperiods end at 2, 3, 4, 5, 6 and 7 ms.
    let steps = [0.501, 0.502, 0.503, 0.504, 0.505, 0.506];
    let flight = reference(&steps);
    let held = |failsafe_us| held(&flight, failsafe_us, QUANTUM).1;
    // The warm-up ran at 1 ms, so 3, 5 and 7 ms are the latest.
    assert_eq!(held(2000), [0.5, 0.502, 0.502, 0.504, 0.504, 0.506]);
    // Where no hyperperiod falls on the deadline, the last one before it is taken.
    assert_eq!(held(2999), [0.5, 0.502, 0.502, 0.504, 0.504, 0.504]);
    assert_eq!(held(3000), [0.5, 0.5, 0.503, 0.503, 0.503, 0.506]);
    // A deadline of the flight's last hyperperiod is kept, one after it is not.
    assert_eq!(held(6000), [0.5, 0.5, 0.5, 0.5, 0.5, 0.506]);
    assert_eq!(held(6001), [0.5; 6]);
}

#[test]
fn a_gap_longer_than_the_failsafe_interval_costs_a_run_on_each_side() {
    let mut flight = after_warm_up(0.5);
    for at_us in [2000, 3000, 50_000, 51_000] {
        flight.end_hyperperiod(at_us, all(0.5), None);
    }
    assert_eq!(held(&flight, 10_000, QUANTUM).0, 2);
}

#[test]
fn without_a_dead_band_it_is_the_reference() {
    let commands = [0.5, 0.5, 0.25, 0.75];
    let (runs, held) = held(&reference(&commands), 100_000, 0.0);
    assert_eq!((runs, held.as_slice()), (4, commands.as_slice()));
}

#[test]
fn a_dead_band_is_found_for_every_number_of_runs_that_has_one() {
    // From 32/64 up by 1, 2, 3, 4, 5 and 6.
    let commands = [33.0, 35.0, 38.0, 42.0, 47.0, 53.0_f32].map(|share| share / 64.0);
    let flight = reference(&commands);
    let track = track(&flight, 100_000);
    // Runs, and above which and up to which dead-band, in 64ths, there are so many.
    let cases = [
        (5, 1.0, 3.0),
        (4, 3.0, 4.0),
        (3, 4.0, 6.0),
        (2, 6.0, 10.0),
        (1, 10.0, 21.0),
    ];
    for (target, above, up_to) in cases {
        let found = track.oracle_equal(target);
        let dead_band = found.dead_band_quanta * f64::from(QUANTUM) * 64.0;
        assert_eq!(found.runs, target);
        assert!(
            dead_band > above && dead_band <= up_to,
            "{dead_band} for {target}"
        );
    }
}

#[test]
fn runs_out_of_reach_are_answered_with_the_nearest_that_are() {
    let flight = reference(&[0.25, 0.75, 0.25, 0.75]);
    let free = track(&flight, 100_000);
    // More runs than hyperperiods: every hyperperiod.
    let all_of_them = free.oracle_equal(9);
    assert_eq!((all_of_them.runs, all_of_them.dead_band_quanta), (4, 0.0));
    assert_eq!(all_of_them.deviation.rms_deviation_quanta, Some(0.0));
    // 4 runs with a dead-band up to a quantum, none with a wider one; of two as near, fewer.
    let runs = |target| free.oracle_equal(target).runs;
    assert_eq!([3, 2, 1].map(runs), [4, 0, 0]);
    // Fewer than the failsafe's own: only those, here one at 4 ms.
    assert_eq!(track(&flight, 3000).oracle_equal(0).runs, 1);
}

#[test]
fn the_deviation_at_equal_runs_stays_in_configured_quanta() {
    // With one run, at 0.75, the oracle is two quanta off once.
    let flight = reference(&[0.5, 0.5, 0.5, 1.0]);
    let one = track(&flight, 100_000).oracle_equal(1);
    assert_eq!(
        (one.runs, one.deviation.rms_deviation_quanta),
        (1, Some(0.0))
    );
    let none = track(&flight, 100_000).oracle_equal(0);
    // Two quanta in one of four hyperperiods.
    assert_eq!(
        (none.runs, none.deviation.rms_deviation_quanta),
        (0, Some(1.0))
    );
    assert_eq!(none.deviation.stale_fraction, Some(0.25));
}

/// Shares of full scale for one millisecond each, weighted as thrust is: a budget.
fn owed(shares: f32) -> Bound {
    Bound::Budget(0.3 * shares * 1e-3)
}

#[test]
fn the_impulse_rule_adds_up_what_every_hyperperiod_owes_until_it_passes_the_budget() {
    // Off by an eighth: a drift far below a quantum.
    let drift = reference(&[0.625; 6]);
    let (runs, held) = held_within(&drift, 100_000, owed(0.3));
    // An eighth, two, three: above 0.3 at the third hyperperiod, and nothing is owed from then on.
    assert_eq!(held, [0.5, 0.5, 0.625, 0.625, 0.625, 0.625]);
    assert_eq!(runs, 1);
}

#[test]
fn vibration_about_what_is_held_owes_nothing_in_the_long_run() {
    let shaken: Vec<f32> = (0..50).flat_map(|_| [0.75, 0.25]).collect();
    let flight = reference(&shaken);
    assert_eq!(held_within(&flight, 1_000_000, owed(0.3)).0, 0);
    // The dead-band follows every swing.
    assert_eq!(held(&flight, 1_000_000, QUANTUM).0, 100);
}

#[test]
fn a_run_forgets_what_was_owed() {
    let flight = reference(&[1.0, 0.5, 0.5, 0.5]);
    let (runs, held) = held_within(&flight, 100_000, owed(0.6));
    // Half is owed, then nothing more; at 0.5 again nothing is off.
    assert_eq!((runs, held), (0, vec![0.5; 4]));
    let (runs, held) = held_within(&flight, 100_000, owed(0.4));
    // Half passes it: held is 1, half of which is owed the other way at once.
    assert_eq!((runs, held), (2, vec![1.0, 0.5, 0.5, 0.5]));
}

#[test]
fn a_budget_is_found_for_every_number_of_runs_that_has_one() {
    let ramp: Vec<f32> = (1..=60).map(|step| 0.5 + step as f32 / 256.0).collect();
    let flight = reference(&ramp);
    let track = track(&flight, 1_000_000);
    for target in [1, 2, 3, 5, 10, 20, 30, 60] {
        let found = track.impulse_equal(target);
        assert_eq!(found.runs, target);
        let again = track.impulse((found.budget_quanta_ms * 1e-3) as f32 * QUANTUM);
        assert!(again.runs.abs_diff(target) <= 1, "{again:?}");
    }
}

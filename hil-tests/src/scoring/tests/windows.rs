//! Where a window begins and ends, and what belongs to it.

use super::super::WINDOW_US;
use super::*;

#[test]
fn windows_start_at_the_warm_ups_end_and_the_last_is_shorter() {
    let mut flight = FlightSteps::new(1_000_000, all(0.0));
    flight.end_hyperperiod(2_000_000, all(0.5), run(Reason::WarmUp, 0.5));
    flight.end_warm_up(2_000_000);
    // Ends at 12 s belongs to the first window, one at 13 s to the second.
    for at_us in [7_000_000, 12_000_000, 13_000_000, 16_000_000] {
        flight.end_hyperperiod(at_us, all(0.5), run(Reason::Trigger, 0.5));
    }
    let windows = scored(&flight).windows;
    let times: Vec<_> = windows
        .iter()
        .map(|window| (window.start_s, window.length_s, window.hyperperiods))
        .collect();
    assert_eq!(times, [(1.0, 10.0, 2), (11.0, 4.0, 2)]);
    let rates: Vec<_> = windows
        .iter()
        .map(|window| window.section.control.rate_hz)
        .collect();
    assert_eq!(rates, [Some(0.2), Some(0.5)]);
}

#[test]
fn a_window_within_a_gap_is_there_with_nothing_in_it() {
    let mut flight = after_warm_up(0.5);
    end(&mut flight, 0.5, None);
    flight.end_hyperperiod(1000 + 2 * WINDOW_US + 1, all(0.5), None);
    let windows = scored(&flight).windows;
    let counts: Vec<_> = windows.iter().map(|window| window.hyperperiods).collect();
    assert_eq!(counts, [1, 0, 1]);
    let empty = &windows[1].section;
    assert_eq!(empty.actuators.deviation.stale_fraction, None);
    assert_eq!((empty.control.runs, empty.control.rate_hz), (0, Some(0.0)));
}

#[test]
fn a_miss_that_began_in_one_window_is_not_counted_again_in_the_next() {
    let mut flight = after_warm_up(0.25);
    flight.end_hyperperiod(WINDOW_US, all(0.75), None);
    flight.end_hyperperiod(WINDOW_US + 2000, all(0.75), None);
    let windows = scored(&flight).windows;
    let misses: Vec<_> = windows
        .iter()
        .map(|window| &window.section.decisions)
        .map(|decisions| (decisions.false_negative, decisions.still_missed))
        .collect();
    assert_eq!(misses, [(1, 0), (0, 1)]);
}

#[test]
fn what_is_left_out_is_neither_counted_nor_timed() {
    let gap = 2500..10_500;
    let mut flight = after_warm_up(0.0).leaving_out(Vec::from([gap]));
    end(&mut flight, 0.0, None);
    assert!(!flight.leaves_out(2000) && flight.leaves_out(2500) && !flight.leaves_out(10_500));
    // A run in between: what it wrote is held behind.
    flight.hold(all(0.5));
    flight.end_hyperperiod(11_000, all(0.5), run(Reason::Trigger, 0.75));
    let last = flight.steps().last().expect("a step");
    assert_eq!((last.before, last.held), (all(0.5), all(0.5)));
    let score = scored(&flight);
    assert_eq!((score.hyperperiods, score.section.control.runs), (2, 1));
    // Ten milliseconds, of which eight are left out.
    let rate_hz = score.section.control.rate_hz.expect("of 2 ms");
    assert!((rate_hz - 500.0).abs() < 1e-6, "{rate_hz}");
}

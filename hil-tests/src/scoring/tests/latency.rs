//! Percentiles and their split by reason.

use super::super::{LatencySample, Quantiles, latencies};
use super::*;

#[test]
fn percentiles_are_values_that_occurred_by_nearest_rank() {
    let of_ten = Quantiles::of((1..=10).rev().map(f64::from)).unwrap();
    assert_eq!((of_ten.p50, of_ten.p99, of_ten.max), (5.0, 10.0, 10.0));
    let of_two_hundred = Quantiles::of((1..=200).map(f64::from)).unwrap();
    assert_eq!((of_two_hundred.p50, of_two_hundred.p99), (100.0, 198.0));
    assert_eq!((of_two_hundred.max, of_two_hundred.count), (200.0, 200));
    let of_one = Quantiles::of([7.5]).unwrap();
    assert_eq!((of_one.p50, of_one.p99, of_one.max), (7.5, 7.5, 7.5));
}

#[test]
fn values_that_are_no_numbers_are_left_out() {
    assert_eq!(Quantiles::of([]), None);
    assert_eq!(Quantiles::of([f64::NAN, f64::INFINITY]), None);
    assert_eq!(Quantiles::of([f64::NAN, 2.0]).unwrap().count, 1);
}

#[test]
fn latencies_are_split_by_reason_and_start_after_warm_up() {
    let flight = after_warm_up(0.5);
    let sample = |at_us, reason, micros| LatencySample {
        at_us,
        reason,
        micros,
    };
    let found = latencies(
        &flight,
        &[
            sample(1000, Reason::Trigger, 9000.0),
            sample(1001, Reason::Trigger, 500.0),
            sample(3000, Reason::Trigger, 510.0),
            sample(4000, Reason::Failsafe, 40.0),
        ],
    );
    let trigger = found.trigger.unwrap();
    assert_eq!((trigger.count, trigger.p50, trigger.max), (2, 500.0, 510.0));
    assert_eq!(found.failsafe.unwrap().p99, 40.0);
    assert_eq!((found.setpoint, found.warm_up), (None, None));
}

#[test]
fn a_flight_still_in_warm_up_has_no_latencies() {
    let sample = LatencySample {
        at_us: 1,
        reason: Reason::WarmUp,
        micros: 1.0,
    };
    assert_eq!(
        latencies(&FlightSteps::new(0, all(0.0)), &[sample]).warm_up,
        None
    );
}

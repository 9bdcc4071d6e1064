//! Deviation as it is held and as motors feel it, largest and RMS.

use super::super::{Deviation, Section};
use super::*;
use proptest::prelude::*;

fn of(flight: &FlightSteps) -> Deviation {
    scored(flight).section.actuators.deviation
}

#[test]
fn the_largest_is_that_of_one_motor_in_one_hyperperiod() {
    let mut flight = after_warm_up(0.5);
    end(&mut flight, 0.625, None);
    flight.end_hyperperiod(3000, first(1.0, 0.5), None);
    end(&mut flight, 0.5, None);
    assert_eq!(of(&flight).largest_deviation_quanta, Some(2.0));
}

#[test]
fn what_is_felt_of_a_hyperperiod_begins_with_the_next() {
    let mut flight = after_warm_up(0.5);
    end(&mut flight, 0.75, None);
    assert_eq!(of(&flight).largest_felt_quanta, Some(0.0));
    end(&mut flight, 0.75, None);
    // A quantum for a millisecond, behind a lag of 27 ms.
    let felt = of(&flight).largest_felt_quanta.expect("a deviation");
    assert!(
        (felt - (1.0 - (-1.0 / 27.0_f64).exp())).abs() < 1e-9,
        "{felt}"
    );
}

#[test]
fn what_the_warm_up_held_is_felt_behind_it() {
    let mut flight = FlightSteps::new(0, all(0.5));
    flight.end_hyperperiod(1000, all(0.75), run(Reason::WarmUp, 0.5));
    flight.end_warm_up(1000);
    end(&mut flight, 0.75, run(Reason::Trigger, 0.75));
    let found = of(&flight);
    assert_eq!(found.largest_deviation_quanta, Some(0.0));
    assert!(found.largest_felt_quanta > Some(0.9), "{found:?}");
}

#[test]
fn a_command_that_is_not_a_number_has_no_felt_deviation_either() {
    let mut flight = after_warm_up(0.5);
    end(&mut flight, f32::NAN, None);
    end(&mut flight, 0.5, None);
    let found = of(&flight);
    let numbers = [
        found.largest_deviation_quanta,
        found.rms_felt_quanta,
        found.largest_felt_quanta,
    ];
    assert_eq!(numbers, [None; 3]);
}

proptest! {
    #[test]
    fn a_constant_deviation_is_felt_as_it_is(
        off in 0.01..0.4_f32, lengths_us in prop::collection::vec(1..5_000_000_u64, 1..50)
    ) {
        let mut flight = FlightSteps::new(0, all(0.5));
        flight.end_hyperperiod(1000, all(0.5 + off), run(Reason::WarmUp, 0.5));
        flight.end_warm_up(1000);
        for length_us in lengths_us {
            flight.end_hyperperiod(flight.last_us() + length_us, all(0.5 + off), None);
        }
        let found = of(&flight);
        let expected = f64::from(0.5 + off - 0.5) / f64::from(QUANTUM);
        for number in [
            found.rms_deviation_quanta,
            found.largest_deviation_quanta,
            found.rms_felt_quanta,
            found.largest_felt_quanta,
        ] {
            prop_assert!((number.expect("a deviation") - expected).abs() < 1e-9, "{:?}", found);
        }
    }

    #[test]
    fn the_largest_is_never_below_the_rms_and_nothing_is_felt_beyond_the_largest(
        shares in prop::collection::vec(0.0..1.0_f32, 1..100)
    ) {
        let mut flight = after_warm_up(0.5);
        for share in shares {
            end(&mut flight, share, None);
        }
        let section: Section = scored(&flight).section;
        let found = section.actuators.deviation;
        prop_assert!(found.largest_deviation_quanta >= found.rms_deviation_quanta);
        prop_assert!(found.largest_felt_quanta >= found.rms_felt_quanta);
        prop_assert!(found.largest_felt_quanta <= found.largest_deviation_quanta);
    }
}

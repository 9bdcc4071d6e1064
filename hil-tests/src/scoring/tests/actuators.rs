//! Staleness, RMS deviation and saturation of small flights worked out by hand.

use super::super::section::Actuators;
use super::*;

fn actuators(flight: &FlightSteps) -> Actuators {
    scored(flight).section.actuators
}

fn close(found: Option<f64>, expected: f64) {
    let found = found.expect("a value");
    assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
}

#[test]
fn stale_is_what_is_held_after_the_run() {
    let mut flight = after_warm_up(0.25);
    end(&mut flight, 0.5, run(Reason::Trigger, 0.5)); // fresh: the run cured it
    end(&mut flight, 0.75, None); // stale
    end(&mut flight, 0.625, None); // half a quantum: fresh
    end(&mut flight, 0.5, run(Reason::Trigger, 0.25)); // stale: the run went astray
    let found = actuators(&flight);
    assert_eq!(found.deviation.stale_fraction, Some(0.5));
    // With the reference's commands at the runs only the second was.
    assert_eq!(found.stale_from_trigger, Some(0.25));
    assert_eq!(found.stale_from_state, Some(0.25));
}

#[test]
fn rms_is_over_hyperperiods_and_motors_in_quanta() {
    let mut flight = after_warm_up(0.5);
    // One motor two quanta away in one of four hyperperiods.
    flight.end_hyperperiod(2000, first(1.0, 0.5), None);
    for _ in 0..3 {
        end(&mut flight, 0.5, None);
    }
    let mean_square = 4.0 / (4.0 * GEOMETRY.count() as f64);
    close(
        actuators(&flight).deviation.rms_deviation_quanta,
        mean_square.sqrt(),
    );
    // Every motor one quantum away in every hyperperiod.
    let mut flight = after_warm_up(0.5);
    end(&mut flight, 0.75, None);
    end(&mut flight, 0.25, None);
    close(actuators(&flight).deviation.rms_deviation_quanta, 1.0);
}

#[test]
fn an_early_run_takes_the_references_command_of_the_hyperperiod_before() {
    let mut flight = after_warm_up(0.25);
    end(&mut flight, 0.375, None);
    // The own state says 0.75; the reference, when the run came, said 0.375.
    flight.run_early(run(Reason::Failsafe, 0.75).unwrap());
    end(&mut flight, 0.75, None);
    let found = actuators(&flight);
    assert_eq!(found.deviation.stale_fraction, Some(0.0));
    assert_eq!(found.stale_from_trigger, Some(0.5));
    // 0.125 then 0.375 of full scale: half a quantum, one and a half.
    close(
        found.rms_from_trigger_quanta,
        ((0.25 + 2.25) / 2.0_f64).sqrt(),
    );
}

#[test]
fn what_the_trigger_held_before_scoring_is_what_the_warm_up_left() {
    // The warm-up's reference strays from its command: only the state is to blame.
    let mut flight = FlightSteps::new(0, all(0.0));
    flight.end_hyperperiod(1000, all(0.75), run(Reason::WarmUp, 0.25));
    flight.end_warm_up(1000);
    end(&mut flight, 0.75, None);
    let found = actuators(&flight);
    assert_eq!(found.deviation.stale_fraction, Some(1.0));
    assert_eq!(found.stale_from_trigger, Some(0.0));
    assert_eq!(found.stale_from_state, Some(1.0));
}

#[test]
fn saturation_is_the_references_and_one_motor_at_either_limit_is_enough() {
    let mut flight = after_warm_up(0.5);
    for (index, command) in [first(1.0, 0.5), first(0.0, 0.5), all(0.5), all(0.999)]
        .into_iter()
        .enumerate()
    {
        let at_us = 2000 + 1000 * index as u64;
        // What was applied sits at a limit always, and does not count.
        flight.end_hyperperiod(at_us, command, run(Reason::Failsafe, 1.0));
    }
    assert_eq!(actuators(&flight).saturated_fraction, Some(0.5));
    assert!(!scored(&flight).scored);
    let narrow = Rules {
        limits: 0.1..=0.9,
        ..rules()
    };
    let narrow = score(&flight, &narrow, |clock| fly(&flight, clock));
    assert_eq!(narrow.section.actuators.saturated_fraction, Some(0.75));
}

#[test]
fn a_fifth_of_saturated_hyperperiods_is_still_scored_and_more_is_not() {
    let flight_of = |saturated: u64, whole: u64| {
        let mut flight = after_warm_up(0.5);
        for index in 0..whole {
            let share = if index < saturated { 1.0 } else { 0.5 };
            end(&mut flight, share, None);
        }
        scored(&flight).scored
    };
    assert!(flight_of(20, 100));
    assert!(!flight_of(21, 100));
}

#[test]
fn a_command_that_is_not_a_number_is_stale_and_has_no_rms() {
    let mut flight = after_warm_up(0.5);
    end(&mut flight, f32::NAN, None);
    let found = actuators(&flight);
    assert_eq!(found.deviation.stale_fraction, Some(1.0));
    assert_eq!(found.deviation.rms_deviation_quanta, None);
}

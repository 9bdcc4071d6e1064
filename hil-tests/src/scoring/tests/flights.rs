//! What a flight derives from its runs, and flights with nothing to score.

use super::*;

#[test]
fn a_step_knows_what_was_held_before_at_and_after_its_decision() {
    let mut flight = FlightSteps::new(500, all(0.125));
    flight.run_early(run(Reason::Failsafe, 0.25).unwrap());
    flight.run_early(run(Reason::Setpoint, 0.375).unwrap());
    flight.end_hyperperiod(1500, all(0.5), run(Reason::Trigger, 0.5));
    flight.end_hyperperiod(2500, all(0.75), None);
    let [one, two] = flight.steps() else {
        panic!("two hyperperiods ended");
    };
    assert_eq!(
        (one.before, one.held, one.applied),
        (all(0.125), all(0.375), all(0.5))
    );
    assert_eq!(
        one.runs().map(|run| run.reason).collect::<Vec<_>>(),
        [Reason::Failsafe, Reason::Setpoint, Reason::Trigger]
    );
    assert_eq!(
        (two.before, two.held, two.applied),
        (all(0.5), all(0.5), all(0.5))
    );
    assert_eq!(two.runs().count(), 0);
}

#[test]
fn the_hyperperiod_that_ends_with_the_warm_up_is_not_scored() {
    let mut flight = FlightSteps::new(1000, all(0.0));
    for at_us in [2000, 3000, 4000, 5000] {
        flight.end_hyperperiod(at_us, all(0.5), run(Reason::WarmUp, 0.5));
    }
    flight.end_warm_up(3000);
    flight.end_warm_up(4000);
    let score = scored(&flight);
    assert_eq!(score.hyperperiods, 2);
    assert_eq!((score.duration_s, score.warm_up_s), (0.004, 0.002));
    assert_eq!(
        (
            score.warm_up.ended,
            score.warm_up.hyperperiods,
            score.warm_up.runs
        ),
        (true, 2, 2)
    );
}

#[test]
fn a_flight_that_never_leaves_warm_up_has_no_shares() {
    let mut flight = FlightSteps::new(0, all(0.0));
    for _ in 0..5 {
        end(&mut flight, 0.5, run(Reason::WarmUp, 0.5));
    }
    let score = scored(&flight);
    assert!(!score.scored && !score.warm_up.ended);
    assert_eq!((score.duration_s, score.warm_up_s), (0.005, 0.005));
    assert_eq!((score.hyperperiods, score.warm_up.runs), (0, 5));
    let control = &score.section.control;
    assert_eq!((control.runs, control.rate_hz), (0, None));
    let actuators = &score.section.actuators;
    assert_eq!(actuators.deviation.stale_fraction, None);
    assert_eq!(actuators.deviation.rms_deviation_quanta, None);
    assert_eq!(actuators.saturated_fraction, None);
    assert_eq!(
        (
            score.oracle.runs,
            score.oracle.deviation.rms_deviation_quanta
        ),
        (0, None)
    );
    assert_eq!(score.periodic_equal, Default::default());
    assert!(score.windows.is_empty());
}

#[test]
fn an_empty_flight_is_scored_as_nothing() {
    let score = scored(&FlightSteps::new(7, all(0.0)));
    assert_eq!(
        (score.duration_s, score.hyperperiods, score.scored),
        (0.0, 0, false)
    );
}

#[test]
fn runs_after_the_last_hyperperiod_are_not_counted() {
    let mut flight = after_warm_up(0.5);
    end(&mut flight, 0.5, None);
    flight.run_early(run(Reason::Failsafe, 0.5).unwrap());
    assert_eq!(scored(&flight).section.control.runs, 0);
}

#[test]
fn runs_are_counted_by_reason_and_exploration_is_left_out_of_the_rate() {
    let mut flight = after_warm_up(0.5);
    flight.run_early(run(Reason::Failsafe, 0.5).unwrap());
    end(&mut flight, 0.5, run(Reason::Trigger, 0.5));
    end(&mut flight, 0.5, run(Reason::Exploration, 0.5));
    end(&mut flight, 0.5, run(Reason::Setpoint, 0.5));
    end(&mut flight, 0.5, None);
    let control = scored(&flight).section.control;
    assert_eq!(control.runs, 4);
    let counts = control.by_reason.named().map(|(_, count)| *count);
    assert_eq!(counts, [0, 1, 1, 1, 1, 0, 0, 0]);
    // Three runs without exploration in 4 ms.
    assert_eq!(control.rate_hz, Some(3.0 / 0.004));
}

//! Decisions of small flights, one rule of the bookkeeping at a time.

use super::super::section::Decisions;
use super::*;

fn decisions(flight: &FlightSteps) -> Decisions {
    scored(flight).section.decisions
}

/// A run of another reason that a trigger had asked for too.
fn asked(reason: Reason, share: f32) -> Option<Run> {
    run(reason, share).map(|run| Run { asked: true, ..run })
}

#[test]
fn the_four_kinds_of_decision() {
    let mut flight = after_warm_up(0.5);
    // Asked, and the reference is a quantum above what is held.
    end(&mut flight, 0.75, run(Reason::Trigger, 0.75));
    // Asked, and nothing has changed.
    end(&mut flight, 0.75, run(Reason::Trigger, 0.75));
    // Not asked, and the reference is a quantum below.
    end(&mut flight, 0.5, None);
    // Asked at last.
    end(&mut flight, 0.5, run(Reason::Trigger, 0.5));
    // Not asked, nothing changed.
    end(&mut flight, 0.5, None);
    assert_eq!(
        decisions(&flight),
        Decisions {
            true_positive: 2,
            false_positive: 1,
            false_negative: 1,
            true_negative: 1,
            ..Decisions::default()
        }
    );
}

#[test]
fn a_change_of_just_under_a_quantum_is_none_and_one_motor_is_enough() {
    let below = f32::from_bits(0.75_f32.to_bits() - 1);
    let mut flight = after_warm_up(0.5);
    end(&mut flight, below, run(Reason::Trigger, 0.5));
    assert_eq!(decisions(&flight).false_positive, 1);
    flight.end_hyperperiod(3000, first(0.25, 0.5), run(Reason::Trigger, 0.5));
    assert_eq!(decisions(&flight).true_positive, 1);
}

#[test]
fn truth_is_measured_before_the_decision_takes_effect() {
    // The run brings the command to the reference; the decision was right all the same.
    let mut flight = after_warm_up(0.25);
    end(&mut flight, 0.75, run(Reason::Trigger, 0.75));
    assert_eq!(decisions(&flight).true_positive, 1);
}

#[test]
fn an_early_run_comes_before_the_decision() {
    let mut flight = after_warm_up(0.25);
    flight.run_early(run(Reason::Failsafe, 0.75).unwrap());
    end(&mut flight, 0.75, run(Reason::Trigger, 0.75));
    assert_eq!(decisions(&flight).false_positive, 1);
}

#[test]
fn a_missed_change_counts_once_until_the_next_run() {
    let mut flight = after_warm_up(0.25);
    end(&mut flight, 0.5, None); // missed
    end(&mut flight, 0.75, None); // still
    end(&mut flight, 0.25, None); // gone for now
    end(&mut flight, 0.5, None); // the same miss
    flight.run_early(run(Reason::Failsafe, 0.25).unwrap());
    end(&mut flight, 0.5, None); // a new one: something ran since
    assert_eq!(
        decisions(&flight),
        Decisions {
            false_negative: 2,
            true_negative: 1,
            still_missed: 2,
            ..Decisions::default()
        }
    );
}

#[test]
fn hyperperiods_that_no_model_decided_are_outside() {
    let mut flight = after_warm_up(0.25);
    for reason in [
        Reason::WarmUp,
        Reason::Periodic,
        Reason::Fallback,
        Reason::Ground,
        Reason::Exploration,
        Reason::Setpoint,
    ] {
        end(&mut flight, 0.75, run(reason, 0.25));
    }
    let outside = Decisions {
        outside: 6,
        ..Decisions::default()
    };
    assert_eq!(decisions(&flight), outside);
}

#[test]
fn a_triggers_call_counts_beside_another_reason_but_not_beside_the_clock() {
    let mut flight = after_warm_up(0.25);
    end(&mut flight, 0.75, asked(Reason::Setpoint, 0.25));
    end(&mut flight, 0.75, asked(Reason::Exploration, 0.25));
    end(&mut flight, 0.25, asked(Reason::Failsafe, 0.25));
    end(&mut flight, 0.75, asked(Reason::Fallback, 0.25));
    let found = decisions(&flight);
    assert_eq!((found.true_positive, found.false_positive), (2, 1));
    assert_eq!(found.outside, 1);
}

#[test]
fn a_failsafe_run_leaves_the_decision_to_the_models() {
    let mut flight = after_warm_up(0.25);
    end(&mut flight, 0.5, run(Reason::Failsafe, 0.5));
    end(&mut flight, 0.5, run(Reason::Failsafe, 0.5));
    assert_eq!(
        decisions(&flight),
        Decisions {
            false_negative: 1,
            true_negative: 1,
            failsafe_changed: 1,
            ..Decisions::default()
        }
    );
}

#[test]
fn failsafe_changed_compares_the_command_before_and_after_that_run() {
    let mut flight = after_warm_up(0.25);
    // Two early runs: the setpoint moved the command, the failsafe run did not.
    flight.run_early(run(Reason::Setpoint, 0.75).unwrap());
    flight.run_early(run(Reason::Failsafe, 0.75).unwrap());
    end(&mut flight, 0.75, None);
    assert_eq!(decisions(&flight).failsafe_changed, 0);
    // The reference does not matter, only what the run did.
    flight.run_early(run(Reason::Failsafe, 0.5).unwrap());
    end(&mut flight, 0.75, None);
    assert_eq!(decisions(&flight).failsafe_changed, 1);
    // Other reasons never count.
    flight.run_early(run(Reason::Setpoint, 0.75).unwrap());
    end(&mut flight, 0.75, run(Reason::Exploration, 0.25));
    assert_eq!(decisions(&flight).failsafe_changed, 1);
}

#[test]
fn a_failsafe_run_that_a_trigger_had_called_for_is_none_of_the_models_misses() {
    let mut flight = after_warm_up(0.25);
    end(&mut flight, 0.75, asked(Reason::Failsafe, 0.75));
    flight.run_early(asked(Reason::Failsafe, 0.25).unwrap());
    end(&mut flight, 0.25, None);
    assert_eq!(decisions(&flight).failsafe_changed, 0);
}

//! What holds for every flight, on random ones.

use super::super::oracle::{Bound, Track};
use super::super::periodic::periodic_ideal;
use super::super::{Section, differs};
use super::*;
use proptest::prelude::*;

const REASONS: [Reason; 8] = [
    Reason::WarmUp,
    Reason::Trigger,
    Reason::Failsafe,
    Reason::Setpoint,
    Reason::Exploration,
    Reason::Periodic,
    Reason::Fallback,
    Reason::Ground,
];

/// One hyperperiod's ingredients: its length, where the reference moves, and the reason,
/// trigger's call and error of an early and of a last run.
type Ingredients = (u64, [f32; 4], Maybe, Maybe);
type Maybe = Option<(usize, bool, f32)>;

fn maybe_run(chance: f64) -> impl Strategy<Value = Maybe> {
    prop::option::weighted(chance, (0..REASONS.len(), any::<bool>(), -0.02..0.02_f32))
}

fn hyperperiod() -> impl Strategy<Value = Ingredients> {
    (
        prop_oneof![9 => 970..1030_u64, 1 => 1030..4_000_000_u64],
        prop::array::uniform4(-0.01..0.01_f32),
        maybe_run(0.05),
        maybe_run(0.3),
    )
}

fn build(warm_up: usize, hyperperiods: &[Ingredients]) -> FlightSteps {
    let mut flight = FlightSteps::new(0, all(0.5));
    let mut reference = all(0.5);
    for (index, (length_us, moves, early, last)) in hyperperiods.iter().enumerate() {
        let to_run = |(reason, asked, error): (usize, bool, f32), command: Command| Run {
            reason: REASONS[reason],
            asked,
            expected: None,
            repaid: None,
            command: command.map(|share| share + error),
        };
        if let Some(early) = early {
            flight.run_early(to_run(*early, reference));
        }
        for (share, by) in reference.iter_mut().zip(moves.iter().cycle()) {
            *share = reflex::math::between(*share + by, 0.0, 1.0);
        }
        let run = last.map(|last| to_run(last, reference));
        flight.end_hyperperiod(flight.last_us() + length_us, reference, run);
        if index + 1 == warm_up {
            flight.end_warm_up(flight.last_us());
        }
    }
    flight
}

fn flights() -> impl Strategy<Value = FlightSteps> {
    (1..50_usize, prop::collection::vec(hyperperiod(), 1..200))
        .prop_map(|(warm_up, hyperperiods)| build(warm_up, &hyperperiods))
}

fn score_of(flight: &FlightSteps) -> Score {
    score(flight, &Rules::default(), |clock| fly(flight, clock))
}

fn cells(section: &Section) -> [u64; 7] {
    let found = &section.decisions;
    [
        found.true_positive,
        found.false_positive,
        found.false_negative,
        found.true_negative,
        found.still_missed,
        found.outside,
        found.failsafe_changed,
    ]
}

proptest! {
    #[test]
    fn every_hyperperiod_falls_into_one_cell_and_positives_are_called_runs(flight in flights()) {
        let score = score_of(&flight);
        let [tp, fp, fneg, tneg, still, outside, _] = cells(&score.section);
        prop_assert_eq!(tp + fp + fneg + tneg + still + outside, score.hyperperiods);
        let last_runs = flight.scored().steps.iter().filter_map(|step| step.run);
        let called = last_runs.filter(|run| run.asked || run.reason == Reason::Trigger).count();
        prop_assert!(tp + fp <= called as u64);
        // A miss counts once until the next run, so never more often than runs and one.
        prop_assert!(fneg <= score.section.control.runs + 1);
        prop_assert!(score.section.decisions.failsafe_changed
            <= score.section.control.by_reason.failsafe);
    }

    #[test]
    fn windows_add_up_to_the_flight(flight in flights()) {
        let score = score_of(&flight);
        let sum = |of: &dyn Fn(&Section) -> u64| -> u64 {
            score.windows.iter().map(|window| of(&window.section)).sum()
        };
        for cell in 0..7 {
            prop_assert_eq!(sum(&|section| cells(section)[cell]), cells(&score.section)[cell]);
        }
        prop_assert_eq!(sum(&|section| section.control.runs), score.section.control.runs);
        let hyperperiods: u64 = score.windows.iter().map(|window| window.hyperperiods).sum();
        prop_assert_eq!(hyperperiods, score.hyperperiods);
        let length_s: f64 = score.windows.iter().map(|window| window.length_s).sum();
        prop_assert!((length_s - (score.duration_s - score.warm_up_s)).abs() < 1e-6);
        let stale = |share: Option<f64>, of: u64| share.unwrap_or(0.0) * of as f64;
        let stale_in_windows: f64 = score.windows.iter()
            .map(|window| stale(window.section.actuators.deviation.stale_fraction, window.hyperperiods))
            .sum();
        let stale_at_all = stale(score.section.actuators.deviation.stale_fraction, score.hyperperiods);
        prop_assert!((stale_in_windows - stale_at_all).abs() < 1e-6);
    }

    #[test]
    fn a_policy_that_applies_the_reference_everywhere_strays_nowhere(flight in flights()) {
        let mut perfect = FlightSteps::new(0, all(0.5));
        for (index, step) in flight.steps().iter().enumerate() {
            let run = Run {
                reason: Reason::Trigger,
                asked: true,
                expected: None,
                repaid: None,
                command: step.reference,
            };
            perfect.end_hyperperiod(step.at_us, step.reference, Some(run));
            if index == 0 {
                perfect.end_warm_up(step.at_us);
            }
        }
        prop_assume!(perfect.steps().len() > 1);
        let score = score_of(&perfect);
        let found = &score.section.actuators;
        for share in [found.deviation.stale_fraction, found.stale_from_trigger, found.stale_from_state] {
            prop_assert_eq!(share, Some(0.0));
        }
        for number in [
            found.deviation.rms_deviation_quanta,
            found.deviation.largest_deviation_quanta,
            found.deviation.rms_felt_quanta,
            found.deviation.largest_felt_quanta,
        ] {
            prop_assert_eq!(number, Some(0.0));
        }
        // So do all yardsticks with as many runs, one at each hyperperiod.
        prop_assert_eq!(score.oracle_equal.deviation.rms_deviation_quanta, Some(0.0));
        prop_assert_eq!(score.oracle_impulse_equal.deviation.rms_deviation_quanta, Some(0.0));
        prop_assert_eq!(score.periodic_ideal.deviation.rms_deviation_quanta, Some(0.0));
    }

    #[test]
    fn a_policy_with_the_references_state_is_stale_by_its_trigger_alone(flight in flights()) {
        let mut ideal = FlightSteps::new(0, all(0.5));
        for (index, step) in flight.steps().iter().enumerate() {
            let run = step.run.map(|run| Run { command: step.reference, ..run });
            ideal.end_hyperperiod(step.at_us, step.reference, run);
            if index == 0 {
                ideal.end_warm_up(step.at_us);
            }
        }
        let found = score_of(&ideal).section.actuators;
        prop_assert_eq!(found.deviation.stale_fraction, found.stale_from_trigger);
        prop_assert_eq!(found.deviation.rms_deviation_quanta, found.rms_from_trigger_quanta);
        prop_assert!(found.stale_from_state.is_none_or(|share| share == 0.0));
    }

    #[test]
    fn rms_and_staleness_do_not_care_which_of_two_is_the_reference(
        pairs in prop::collection::vec((0.0..1.0_f32, 0.0..1.0_f32), 1..50)
    ) {
        let flight_of = |swap: bool| {
            let mut flight = after_warm_up(0.5);
            for (one, other) in &pairs {
                let (one, other) = if swap { (other, one) } else { (one, other) };
                end(&mut flight, *one, run(Reason::Failsafe, *other));
            }
            score_of(&flight).section.actuators
        };
        let (there, back) = (flight_of(false), flight_of(true));
        prop_assert_eq!(there.deviation, back.deviation);
    }

    #[test]
    fn without_a_dead_band_the_oracle_is_the_reference(flight in flights()) {
        let track = Track::new(&flight.scored(), &Rules::default());
        let mut same = true;
        let runs = track.hold(Bound::DeadBand(0.0), |_, held, reference| same &= held == reference);
        prop_assert!(same);
        prop_assert_eq!(runs, flight.scored().steps.len() as u64);
    }

    #[test]
    fn the_oracle_is_never_stale(flight in flights()) {
        let rules = Rules::default();
        let track = Track::new(&flight.scored(), &rules);
        let found = track.oracle().deviation;
        prop_assert!(found.stale_fraction.is_none_or(|share| share == 0.0));
    }

    #[test]
    fn the_oracle_never_waits_longer_than_the_failsafe_interval(
        lengths_us in prop::collection::vec(500..30_000_u64, 1..300)
    ) {
        // Each reference occurs once, so that a held command shows when it was taken.
        let mut flight = after_warm_up(0.0);
        for (index, length_us) in (1_u16..).zip(&lengths_us) {
            let reference = f32::from(index) / 1024.0;
            flight.end_hyperperiod(flight.last_us() + length_us, all(reference), None);
        }
        let at_us: Vec<u64> = flight.steps().iter().map(|step| step.at_us).collect();
        let rules = rules();
        let track = Track::new(&flight.scored(), &rules);
        for bound in [Bound::DeadBand(2.0), Bound::Budget(2.0)] {
            let mut now = 0;
            track.hold(bound, |_, held, _| {
                now += 1;
                let taken = (held[0] * 1024.0) as usize;
                assert!(at_us[now] - at_us[taken] <= rules.failsafe_us);
            });
        }
    }

    #[test]
    fn the_oracle_at_equal_runs_meets_its_own_count(flight in flights()) {
        let rules = Rules::default();
        let track = Track::new(&flight.scored(), &rules);
        let runs = track.oracle().runs;
        prop_assert_eq!(track.oracle_equal(runs).runs, runs);
    }

    #[test]
    fn the_oracle_of_the_impulse_rule_at_equal_runs_is_a_run_off_at_most(flight in flights()) {
        let rules = Rules::default();
        let track = Track::new(&flight.scored(), &rules);
        let runs = track.impulse(rules.budget()).runs;
        prop_assert!(track.impulse_equal(runs).runs.abs_diff(runs) <= 1);
    }

    #[test]
    fn the_oracle_of_the_impulse_rule_runs_at_every_change_without_a_budget(flight in flights()) {
        let track = Track::new(&flight.scored(), &Rules::default());
        let mut same = true;
        track.hold(Bound::Budget(0.0), |_, held, reference| same &= held == reference);
        prop_assert!(same);
    }

    #[test]
    fn evenly_spaced_runs_are_as_many_as_asked_for(flight in flights(), runs in 0..300_u64) {
        let scored = flight.scored();
        let hyperperiods = scored.steps.len() as u64;
        let found = periodic_ideal(&scored, 0.01, runs);
        prop_assert_eq!(found.runs, runs.min(hyperperiods));
        if runs >= hyperperiods && hyperperiods > 0 {
            prop_assert_eq!(found.deviation.rms_deviation_quanta, Some(0.0));
        }
    }

    #[test]
    fn the_same_flight_has_the_same_score(flight in flights()) {
        prop_assert_eq!(score_of(&flight), score_of(&flight));
    }

    #[test]
    fn differing_is_mutual_and_widens_with_a_finer_quantum(
        one in 0.0..1.0_f32, other in 0.0..1.0_f32, quantum in 0.0..0.5_f32
    ) {
        let (one, other) = (first(one, 0.5), first(other, 0.5));
        prop_assert_eq!(differs(&one, &other, quantum), differs(&other, &one, quantum));
        if differs(&one, &other, quantum) {
            prop_assert!(differs(&one, &other, quantum / 2.0));
        }
        prop_assert!(quantum == 0.0 || !differs(&one, &one, quantum));
    }
}

//! Rare runs keep the control state of frequent ones, on aerobatics of many shapes.
//!
//! Beside every policy flies reference control, which runs at every sample and has a state of its
//! own. How far commands stray is measured with both states: what their ratio lies above one is
//! owed to integrals, filters and estimates that went another way because control ran rarely.
//!
//! The observer is left out: it learns from what the body does with its demand, and here the body
//! does not answer.

mod aerobatics;
mod shapes;

use hil_tests::logics::LogicName;
use hil_tests::replay::native::fly_and_score;
use hil_tests::replay::options::ReplayOptions;
use rayon::prelude::*;
use recorded_flights::Flight;
use shapes::{Asked, flights};

/// Seconds of manoeuvres in a flight.
const LENGTH_S: f64 = 12.0;

/// The largest ratio of a flight: on the edge of saturation two states now and then part for a while.
const MOST_OF_ONE: f64 = 1.3;
/// The largest ratio of all flights of a logic.
const MOST_OF_ALL: f64 = 1.03;

/// Felt deviation of a policy, in quanta: with its own control state, and with the reference's.
#[derive(Clone, Copy, Debug)]
struct Felt {
    own: f64,
    reference: f64,
}

impl Felt {
    fn of(flight: &Flight, logic: LogicName) -> Self {
        let options = ReplayOptions {
            gains: logic.into(),
            ..ReplayOptions::default()
        };
        let score = fly_and_score(flight, &options).expect("a flight");
        let actuators = &score.section.actuators;
        let felt = (
            actuators.deviation.rms_felt_quanta,
            actuators.rms_felt_from_trigger_quanta,
        );
        let (Some(own), Some(reference)) = felt else {
            panic!("{}: nothing is scored", flight.name);
        };
        Self { own, reference }
    }

    /// The root mean square of many.
    fn mean(all: &[Self]) -> Self {
        let of = |number: fn(&Self) -> f64| {
            let squares: f64 = all.iter().map(|felt| number(felt).powi(2)).sum();
            (squares / all.len() as f64).sqrt()
        };
        Self {
            own: of(|felt| felt.own),
            reference: of(|felt| felt.reference),
        }
    }

    fn ratio(&self) -> f64 {
        self.own / self.reference
    }
}

fn check_that_state_does_not_stray(logic: LogicName) {
    let flown = [(1, Asked::Own), (1, Asked::Level), (2, Asked::Level)];
    let all: Vec<Flight> = flown
        .into_iter()
        .flat_map(|(seed, asked)| {
            let flown = flights(seed, LENGTH_S, asked).into_iter();
            // A body that stays upside down, though level is asked for, is upset: motors are cut.
            flown.filter(move |flight| asked == Asked::Own || !flight.name.starts_with("split-S"))
        })
        .collect();
    let felt: Vec<Felt> = (all.par_iter())
        .map(|flight| Felt::of(flight, logic))
        .collect();
    for (flight, felt) in all.iter().zip(&felt) {
        let ratio = felt.ratio();
        println!("{:.3} {}: {felt:.3?}", ratio, flight.name);
        assert!(ratio < MOST_OF_ONE, "{}: {felt:?}", flight.name);
    }
    let mean = Felt::mean(&felt);
    println!("{:.3} in the mean: {mean:.3?}", mean.ratio());
    assert!(mean.ratio() < MOST_OF_ALL, "{mean:?}");
}

#[test]
fn the_cascades_state_does_not_stray_on_aerobatics() {
    check_that_state_does_not_stray(LogicName::Cascade);
}

#[test]
fn arducopters_state_does_not_stray_on_aerobatics() {
    check_that_state_does_not_stray(LogicName::ArduCopter);
}

#[test]
fn cleanflights_state_does_not_stray_on_aerobatics() {
    check_that_state_does_not_stray(LogicName::Cleanflight);
}

#[test]
fn openpilots_state_does_not_stray_on_aerobatics() {
    check_that_state_does_not_stray(LogicName::OpenPilot);
}

//! Thresholds learned on recorded flights, against maximum likelihood.

use reflex::sensors::{Input, Inputs};
use reflex::settings::Settings;

use super::comparison::{Outcome, compare};
use super::tap::tap;
use hil_tests::replay::native::fly;
use hil_tests::replay::options::ReplayOptions;
use recorded_flights::recordings::flights;

/// The triggers that make each of the leading inputs lead.
pub(super) fn settings() -> [(&'static str, Settings); 4] {
    let of = |triggers| Settings {
        triggers,
        p_run: 0.6,
        ..reflex::config::SETTINGS
    };
    [
        ("dead-band", of(Inputs::ALL.without(Input::Owed))),
        ("without command", of(Inputs::OF_AXES)),
        ("turned and chips", of(Inputs::OF_CHIPS.with(Input::Turned))),
        ("default", reflex::config::SETTINGS),
    ]
}

/// The worst of all comparisons of one input.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    comparisons: u32,
    off: f64,
    beyond: u32,
    separated: u32,
    misses: f64,
    no_model: u32,
    unknown: u32,
}

impl Worst {
    fn take(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Off(off) => {
                self.comparisons += 1;
                self.off = self.off.max(off);
                self.beyond += u32::from(off > BOUND);
            }
            Outcome::Misses(by) => {
                self.separated += 1;
                self.misses = self.misses.max(by);
            }
            Outcome::NoModel => self.no_model += 1,
            Outcome::Unknown => self.unknown += 1,
        }
    }
}

/// Labels of the rarer class from which a comparison counts.
const ENOUGH: usize = 30;

/// What the probability at a threshold may be off by.
const BOUND: f64 = 0.03;

/// Every so many refits, half a second each, an input's labels are compared.
const EVERY: u32 = 20;

#[test]
fn thresholds_of_recorded_flights_are_those_of_maximum_likelihood() {
    for (name, settings) in settings() {
        let mut worst = [Worst::default(); Input::ALL.len()];
        for flight in flights() {
            let options = ReplayOptions {
                settings,
                ..ReplayOptions::default()
            };
            let calls = fly(&flight, &options).expect("a flight");
            let mut refits = [0; Input::ALL.len()];
            tap(&calls, settings, |at, lessons| {
                let input = lessons.input as usize;
                refits[input] += 1;
                if refits[input] % EVERY != 6 || lessons.of_rarer_class() < ENOUGH {
                    return;
                }
                let outcome = compare(&lessons.binned, &lessons.samples());
                if matches!(outcome, Outcome::Off(off) if off > BOUND) {
                    let seconds = at.ticks() as f64 * 1e-6;
                    let input = lessons.input;
                    println!(
                        "{} {name} {input:?} {seconds:.1} s {outcome:?}",
                        flight.name
                    );
                }
                worst[input].take(outcome);
            });
        }
        for input in Input::ALL {
            let worst = worst[input as usize];
            println!("{name}, {input:?}: {worst:?}");
            assert_eq!(worst.beyond, 0, "{name}, {input:?}: {worst:?}");
            // A bin of the command is up to 4.2 % wide, of the others up to 39 %.
            let bin = if input == Input::Command { 0.042 } else { 0.39 };
            assert!(worst.misses <= bin, "{name}, {input:?}: {worst:?}");
        }
    }
}

//! Every logic gives the same bits in every way, on every recorded flight.

mod emulated;
mod whole;

use rayon::prelude::*;
use reflex::airframe::MotorShares;
use reflex_bench::step::Step;
use reflex_bench::ways::{self, Way};

use super::*;
use crate::replay::native::fly;
use crate::replay::options::ReplayOptions;
use recorded_flights::recordings::flights;

/// A logic in its four ways: time-triggered, ours, callbacks, pointer vector.
type Ways = [Box<dyn Way>; 4];

/// The logic of a name, at its start.
fn ways(name: LogicName) -> Ways {
    macro_rules! ways_of {
        ($($(#[$doc:meta])* $module:ident: $name:literal, $Logic:ident;)*) => {
            match name {
                $(LogicName::$Logic => [
                    Box::new(ways::$module::straight_line::$Logic::configured()),
                    Box::new(graph::$Logic::configured()),
                    Box::new(ways::$module::callbacks::$Logic::configured()),
                    Box::new(ways::$module::pointer_vector::$Logic::configured()),
                ],)*
            }
        };
    }
    reflex_settings::control_logics!(ways_of)
}

fn bits(command: MotorShares) -> Vec<u32> {
    command.iter().map(|share| share.to_bits()).collect()
}

/// Runs of every logic on every recorded flight, in reactive control.
fn for_every_flight(check: impl Fn(LogicName, &str, Vec<Step>) + Sync) {
    flights().par_iter().for_each(|flight| {
        for name in LogicName::value_variants() {
            let options = ReplayOptions {
                gains: (*name).into(),
                ..ReplayOptions::default()
            };
            let calls = fly(flight, &options).unwrap_or_else(|error| panic!("{error:#}"));
            let steps = steps_of(&calls, options.settings, *name);
            assert!(steps.len() > 1000, "{}", flight.name);
            check(*name, &flight.name, steps);
        }
    });
}

#[test]
fn callbacks_and_pointer_vectors_come_to_the_commands_of_ours() {
    for_every_flight(|name, flight, steps| {
        let [_, mut ours, mut callbacks, mut pointer_vector] = ways(name);
        for (run, step) in steps.iter().enumerate() {
            let expected = bits(ours.take(step));
            for other in [callbacks.take(step), pointer_vector.take(step)] {
                assert_eq!(
                    bits(other),
                    expected,
                    "{} on {flight}, run {run}",
                    name.word()
                );
            }
        }
    });
}

#[test]
fn where_every_input_is_set_time_triggered_control_comes_to_the_commands_of_ours() {
    for_every_flight(|name, flight, steps| {
        let held = whole::held(&steps);
        for (kind, steps) in [("changing", whole::changing(&held)), ("held", held)] {
            let [mut time_triggered, mut ours, ..] = ways(name);
            for (run, step) in steps.iter().enumerate() {
                let [expected, command] =
                    [&mut time_triggered, &mut ours].map(|way| way.take(step));
                assert_eq!(
                    bits(command),
                    bits(expected),
                    "{} on {flight}, {kind}, run {run}",
                    name.word()
                );
            }
        }
    });
}

#[test]
fn every_logic_goes_by_the_name_that_chooses_it() {
    for name in LogicName::value_variants() {
        let chosen = LogicName::from_str(name.word(), false);
        assert_eq!(chosen.as_ref(), Ok(name));
    }
}

#[test]
fn a_graph_takes_the_bytes_of_its_values_and_a_word_for_what_changed() {
    for name in LogicName::value_variants() {
        let (bytes, stored) = name.bytes();
        assert!(bytes <= stored + 8, "{}: {bytes}, {stored}", name.word());
    }
}

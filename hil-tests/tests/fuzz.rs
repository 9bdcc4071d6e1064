//! The harness of fuzzing finds what it is for, and keeps the input.

use std::fs;
use std::path::Path;
use std::time::Duration;

use hil_tests::fuzz::Target;
use hil_tests::fuzz::worker::{Inputs, Tried, try_inputs};

const INPUTS: Inputs = Inputs {
    seed: 1,
    first: 0,
    count: 100,
    time: None,
    patience: Duration::from_secs(60),
};

fn tried(name: &str, inputs: &Inputs) -> Result<Tried, String> {
    let target = Target::named(name).expect("a target");
    let program = Path::new(env!("CARGO_BIN_EXE_hil"));
    try_inputs(program, target, inputs).map_err(|error| error.to_string())
}

/// What is said of a target that fails, of which the kept input is the bad one.
fn failure(name: &str, inputs: &Inputs) -> String {
    let said = tried(name, inputs).expect_err("one of ten inputs is bad");
    let (before, file) = said.split_once("; cargo hil fuzz ").expect("a command");
    let file = file
        .strip_prefix(&format!("{name} --input "))
        .expect("a file");
    assert_eq!(fs::read(file).expect("the input is kept"), [9]);
    assert_eq!(said.lines().count(), 1, "{said}");
    before.to_owned()
}

#[test]
fn a_panic_is_found_with_its_words() {
    let said = failure("panics", &INPUTS);
    assert!(
        said.starts_with("panics: input ") && said.contains("a word for the user"),
        "{said}"
    );
}

#[test]
fn a_stack_that_overflows_is_found() {
    let said = failure("overflows", &INPUTS);
    assert!(said.contains("has overflowed its stack"), "{said}");
}

#[test]
fn a_reader_that_takes_all_memory_is_found() {
    let said = failure("hoards", &INPUTS);
    assert!(said.contains("memory allocation of"), "{said}");
}

#[test]
fn an_input_that_never_ends_is_found() {
    let patience = Duration::from_secs(2);
    let said = failure("hangs", &Inputs { patience, ..INPUTS });
    assert!(said.contains("takes over 2 s"), "{said}");
}

#[test]
fn a_sound_target_is_tried_as_often_as_asked_or_until_its_time_is_over() {
    let all = tried("options", &INPUTS).expect("nothing fails");
    assert!(all.inputs == 100 && all.accepted > 0, "{all:?}");
    let time = Some(Duration::ZERO);
    let some = tried(
        "options",
        &Inputs {
            time,
            count: u64::MAX,
            ..INPUTS
        },
    );
    assert!(some.expect("nothing fails").inputs < u64::MAX);
}

//! No task panics in flight: who can lead to a panic is listed, and argued.

use std::collections::{BTreeMap, BTreeSet};

use hil_tests::firmware::Firmware;
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;

use super::program::{PRIORITIES, Program};

/// Parts of the names of functions that only panics call.
const PANICS: [&str; 5] = [
    "core..panicking",
    "core9panicking",
    "unwrap_failed",
    "expect_failed",
    "slice_index_fail",
];

/// Who may lead to a panic, by a part of the symbol, and why none comes of it.
const ARGUED: [(&str, &str); 8] = [
    (
        "CAN1_TX",
        "a task's future is polled after its end: RTIC spawns it anew before",
    ),
    (
        "CAN1_RX0",
        "the same of the look at the battery, which the heartbeat waits for",
    ),
    ("CAN1_RX1", "the same; the failsafe's loop has no end"),
    (
        "5sleep",
        "the same of what a task waits for, which is dropped when it is over",
    ),
    ("sleep_until", "the same"),
    (
        "TIM5",
        "an overflow of the timer was missed: interrupts were masked for 36 minutes",
    ),
    (
        "3app4idle",
        "more items than room in a list: the list of a refit has the room of its source",
    ),
    (
        "_defmt_",
        "a line of the log begins within another: interrupts are masked meanwhile",
    ),
];

fn is_panic(name: &str) -> bool {
    PANICS.iter().any(|part| name.contains(part))
}

/// The functions that can be reached from these, with the way to each.
fn reached(program: &Program, starts: impl Iterator<Item = u32>) -> BTreeMap<u32, String> {
    let mut found = BTreeMap::new();
    let mut open: Vec<(u32, String)> = starts.map(|start| (start, String::new())).collect();
    while let Some((at, way)) = open.pop() {
        // A branch into the middle of a function belongs to that function.
        let Some((entry, function)) = program.functions.range(..=at).next_back() else {
            continue;
        };
        if found.contains_key(entry) {
            continue;
        }
        let way = format!("{way} > {:#}", rustc_demangle::demangle(&function.name));
        // What a panic calls is its own.
        if !is_panic(&function.name) {
            open.extend(function.calls.iter().map(|callee| (*callee, way.clone())));
        }
        found.insert(*entry, way);
    }
    found
}

#[test]
fn whoever_can_lead_a_task_to_a_panic_is_argued() {
    let firmware = Firmware::build(LogicName::configured(), &mut Silent).unwrap();
    let program = Program::read(&firmware.bytes);
    let idle = program
        .functions
        .iter()
        .filter(|(_, it)| it.name.contains("reflex3app4idle"));
    let starts: BTreeSet<u32> = (PRIORITIES.concat().into_iter())
        .map(|vector| program.start_of(vector))
        .chain(idle.map(|(start, _)| *start))
        .collect();
    let reached = reached(&program, starts.into_iter());
    let mut unargued = BTreeSet::new();
    for (start, way) in &reached {
        let function = &program.functions[start];
        let panics = function.calls.iter().any(|callee| {
            let callee = program.functions.range(..=callee).next_back();
            callee.is_some_and(|(_, callee)| is_panic(&callee.name))
        });
        let is_argued = ARGUED
            .iter()
            .any(|(caller, _)| function.name.contains(caller));
        if panics && !is_panic(&function.name) && !is_argued {
            unargued.insert(way.clone());
        }
    }
    println!("{} functions are reached", reached.len());
    assert!(unargued.is_empty(), "{unargued:#?}");
}

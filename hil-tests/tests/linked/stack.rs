//! The stack has a bound.
//!
//! A function takes at most the sum of all its instructions that lower the stack pointer, for none
//! is in a loop; a call adds what the callee takes. Recursion fails the test. Tasks of one priority
//! never interrupt each other, and nothing interrupts the start, so that the worst case is the start
//! alone, or idle and one task of every priority above it.

use std::collections::{BTreeMap, BTreeSet};

use hil_tests::firmware::Firmware;
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;
use object::{Object, ObjectSection};

use super::program::{PRIORITIES, Program};

/// What the processor stores for an exception, with floating point and alignment.
const EXCEPTION: u32 = 26 * 4 + 4;
/// What the end of the firmware needs below the deepest task, before its stack begins anew.
const RESERVE: u32 = 1024;
/// The most that the bound may be, in bytes.
const LIMIT: u32 = 28 * 1024;

impl Program {
    /// The most that a function takes, with all that it calls.
    fn depth(&self, start: u32, known: &mut BTreeMap<u32, u32>, path: &mut Vec<u32>) -> u32 {
        if let Some(depth) = known.get(&start) {
            return *depth;
        }
        let names = || {
            path.iter()
                .map(|at| self.functions[at].name.as_str())
                .collect::<Vec<_>>()
                .join(" > ")
        };
        assert!(!path.contains(&start), "recursion: {}", names());
        // A branch into the middle of a function belongs to that function.
        let Some((entry, function)) = self.functions.range(..=start).next_back() else {
            panic!("nothing at {start:#x}, called by {}", names())
        };
        if *entry != start && path.last() == Some(entry) {
            return 0;
        }
        path.push(*entry);
        let deepest = function
            .calls
            .iter()
            .map(|callee| self.depth(*callee, known, path))
            .max();
        path.pop();
        let depth = function.frame + deepest.unwrap_or(0);
        known.insert(start, depth);
        depth
    }

    fn deepest(&self, names: &[&str]) -> u32 {
        let mut known = BTreeMap::new();
        let depths = names
            .iter()
            .map(|name| self.depth(self.start_of(name), &mut known, &mut Vec::new()));
        depths.max().unwrap_or(0)
    }

    /// What `main` takes itself while idle runs, and idle with all that it calls.
    fn idle(&self) -> u32 {
        let idle = self
            .functions
            .iter()
            .filter(|(_, it)| it.name.contains("3app4idle"));
        let mut known = BTreeMap::new();
        let depths = idle.map(|(start, _)| self.depth(*start, &mut known, &mut Vec::new()));
        let deepest = depths.max().expect("idle is a function of its own");
        self.functions[&self.start_of("main")].frame + deepest
    }

    /// The most that the stack takes.
    fn stack(&self) -> u32 {
        let tasks = PRIORITIES.map(|vectors| EXCEPTION + self.deepest(vectors));
        let (start, idle) = (self.deepest(&["main"]), self.idle());
        println!("stack: {start} bytes of the start, {idle} of idle, {tasks:?} by priority");
        start.max(idle + tasks.iter().sum::<u32>())
    }
}

#[test]
fn the_stack_has_a_bound_far_below_its_memory() {
    let firmware = Firmware::build(LogicName::configured(), &mut Silent).unwrap();
    let program = Program::read(&firmware.bytes);
    let bound = program.stack();
    assert!(bound <= LIMIT, "{bound} bytes");
    let file = object::File::parse(&*firmware.bytes).unwrap();
    let vectors = file.section_by_name(".vector_table").unwrap();
    let vectors = vectors.data().unwrap().as_chunks().0.iter();
    // Nothing else interrupts: every vector that is not of these leads to the end.
    let ends = ["DefaultHandler", "NonMaskableInt"];
    let known = PRIORITIES.concat().into_iter().chain(ends);
    let known: BTreeSet<u32> = known.map(|name| program.start_of(name)).collect();
    for (exception, vector) in vectors.enumerate().skip(16) {
        let handler = u32::from_le_bytes(*vector) & !1;
        assert!(
            handler == 0 || known.contains(&handler),
            "exception {exception}: {handler:#x}"
        );
    }
    let elf = emulated_board::Elf::parse(firmware.bytes).unwrap();
    let memory = elf.stack().unwrap();
    assert!(bound + EXCEPTION + RESERVE <= memory.end - memory.start);
}

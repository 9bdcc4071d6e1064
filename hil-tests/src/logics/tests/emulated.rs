//! Time-triggered and reactive control agree bit by bit on core and host.
//!
//! Whole flights take minutes and are compared on request only:
//! `cargo test -p hil-tests --profile hil --ignore-rust-version --lib over_whole_flights -- --ignored --nocapture`

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use reflex_bench::digest::CommandDigest;
use reflex_bench::{BLOCK_STEPS, BLOCK_SYMBOLS};

use super::*;
use crate::costs::at_rest;
use crate::firmware::Firmware;
use crate::progress::Silent;
use emulated_board::emulated::EmulatedBoard;
use emulated_board::{Board, Elf, Feed, Hit, LogLine, Observer, Options, Watched};

/// Virtual time between two looks, and the most that a flight may take, ns.
const LOOK_NS: u64 = 100_000_000;
const LONGEST_NS: u64 = 600_000_000_000;

/// Runs of each flight that are compared every time: over eight seconds.
const QUICK_RUNS: usize = 8192;

/// What the program logs, and whether it is done.
#[derive(Default)]
struct Observed {
    digests: Vec<String>,
    done: bool,
}

impl Observer for Observed {
    fn log(&mut self, line: &LogLine) {
        self.digests.push(line.text.clone());
    }

    fn hit(&mut self, _: Hit) {
        self.done = true;
    }
}

/// The program `flights` and where it takes its steps.
struct Core {
    elf: Arc<Elf>,
    asks: Watched,
    done: Watched,
    address: u32,
}

impl Core {
    fn build() -> Self {
        let firmware = Firmware::build_flights(&mut Silent).expect("built");
        let elf = Elf::parse(firmware.bytes).expect("an ELF file");
        let [refill, given] = BLOCK_SYMBOLS;
        let function = |path| Watched::Address(elf.function(path).expect("linked"));
        Self {
            asks: function(&refill),
            done: function(&["marks", "done"]),
            address: elf.variable(&given).expect("linked"),
            elf: Arc::new(elf),
        }
    }

    /// What the core says after each block of steps.
    fn digests(&self, name: LogicName, steps: &[Step]) -> Vec<String> {
        let logic = name.place() as u32;
        let blocks = steps.chunks(BLOCK_STEPS).chain([&[][..]]);
        let options = Options {
            watches: vec![self.done.clone()],
            feed: Some(Feed {
                asks: self.asks.clone(),
                address: self.address,
                blocks: blocks.map(|block| image(logic, block)).collect(),
            }),
            flies: false,
            ..Options::default()
        };
        let mut board = EmulatedBoard::boot(&self.elf, at_rest(), &options).expect("booted");
        let mut observed = Observed::default();
        while !observed.done && board.now_ns() < LONGEST_NS {
            let ran = board.run_until(board.now_ns() + LOOK_NS, &mut observed);
            ran.unwrap_or_else(|fault| panic!("{}: {fault}", name.word()));
        }
        assert!(observed.done, "{} is not done", name.word());
        observed.digests
    }
}

/// Which logic, how many steps, then their words, as the core has them.
fn image(logic: u32, steps: &[Step]) -> Vec<u8> {
    let words = steps.iter().flat_map(Step::to_words);
    let head = [logic, steps.len() as u32];
    head.into_iter()
        .chain(words)
        .flat_map(u32::to_le_bytes)
        .collect()
}

/// The host's results, as the core writes them: steps, by the clock, ours.
fn digests_of_host(name: LogicName, steps: &[Step]) -> Vec<String> {
    let [mut time_triggered, mut ours, ..] = ways(name);
    let mut digests = [CommandDigest::new(); 2];
    let mut done = 0;
    let blocks = steps.chunks(BLOCK_STEPS).map(|block| {
        for step in block {
            digests[0].add(time_triggered.take(step));
            digests[1].add(ours.take(step));
        }
        done += block.len();
        let [by_clock, ours] = digests.map(CommandDigest::value);
        format!("{done} {by_clock:016x} {ours:016x}")
    });
    blocks.collect()
}

/// Compares the first runs of each flight, with inputs of both kinds.
fn core_and_host_agree(most_runs: usize) {
    let core = Core::build();
    let compared = AtomicUsize::new(0);
    for_every_flight(|name, flight, steps| {
        let mut held = whole::held(&steps);
        held.truncate(most_runs);
        let changing = whole::changing(&held);
        let mut pairs = changing.windows(2);
        assert!(pairs.all(|pair| whole::all_change(&pair[0], &pair[1])));
        for (kind, steps) in [("held", held), ("changing", changing)] {
            let expected = digests_of_host(name, &steps);
            let digests = core.digests(name, &steps);
            let what = format!("{} on {flight}, {kind}", name.word());
            assert_eq!(digests.len(), expected.len(), "{what}");
            for (core, host) in digests.iter().zip(&expected) {
                assert_eq!(core, host, "{what}: steps, by the clock, ours");
            }
            compared.fetch_add(steps.len(), Ordering::Relaxed);
        }
    });
    eprintln!("{} steps compared", compared.into_inner());
}

#[test]
fn where_every_input_is_set_both_ways_come_to_the_same_on_the_core_and_on_the_host() {
    core_and_host_agree(QUICK_RUNS);
}

#[test]
#[ignore = "minutes: whole flights, two million runs"]
fn both_ways_come_to_the_same_on_the_core_and_on_the_host_over_whole_flights() {
    core_and_host_agree(usize::MAX);
}

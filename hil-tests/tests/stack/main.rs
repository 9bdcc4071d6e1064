//! The stack has a bound, computed from the linked firmware's own instructions.
//!
//! A function takes at most the sum of all its instructions that lower the stack pointer, for none
//! is in a loop; a call adds what the callee takes. Calls through pointers are declared below, and one
//! that is not fails the test, as recursion does. Tasks of one priority never interrupt each other,
//! so that the worst case is idle, or the start, and one task of every priority above it.

mod thumb;

use std::collections::{BTreeMap, BTreeSet};

use hil_tests::firmware::Firmware;
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};
use thumb::{Step, steps};

/// Vectors by priority, lowest first: the table of `src/main.rs`, and the monotonic.
const PRIORITIES: [&[&str]; 6] = [
    &["CAN1_TX"],
    &["USART2", "DMA1_STREAM5", "DMA1_STREAM6", "CAN1_RX0"],
    &["CAN2_RX0"],
    &["DMA1_STREAM0", "CAN2_TX", "CAN1_RX1", "TIM5"],
    &["I2C1_EV", "I2C1_ER"],
    &["EXTI0", "EXTI1", "EXTI2", "TIM2"],
];

/// Who calls through pointers, and whom: parts of their symbols.
const THROUGH_POINTERS: [(&str, &[&str]); 10] = [
    ("CAN1_RX0", &["waker_"]),
    ("CAN1_RX1", &["waker_"]),
    ("CAN1_TX", &["waker_"]),
    ("TIM5", &["waker_"]),
    ("sleep", &["waker_"]),
    ("timer_queue", &["waker_"]),
    ("waker_wake", &["call_once"]),
    ("_defmt_", &["defmt_rtt7channel"]),
    ("Learners", &["Record$LT$R$GT$6labels"]),
    ("range5Range5holds", &["call_once", "range"]),
];

/// What the processor stores for an exception, with floating point and alignment.
const EXCEPTION: u32 = 26 * 4 + 4;
/// What the end of the firmware needs below the deepest task, before its stack begins anew.
const RESERVE: u32 = 1024;
/// The most that the bound may be, in bytes.
const LIMIT: u32 = 16 * 1024;

/// A function: what it takes, whom it calls, and whether it does so through pointers.
#[derive(Debug, Default)]
struct Function {
    name: String,
    frame: u32,
    calls: BTreeSet<u32>,
    through_pointers: bool,
}

/// A firmware.
struct Program {
    /// By their addresses.
    functions: BTreeMap<u32, Function>,
    /// Addresses by names: functions alike share one.
    names: BTreeMap<String, u32>,
}

fn address(symbol: &object::Symbol) -> u32 {
    symbol.address() as u32 & !1
}

/// Where the compiler says that constants (true), and then again instructions begin.
fn marks(file: &object::File) -> BTreeMap<u32, bool> {
    let marks = file
        .symbols()
        .filter_map(|it| match it.name().ok()?.get(..2)? {
            "$d" => Some((address(&it), true)),
            "$t" => Some((address(&it), false)),
            _ => None,
        });
    marks.collect()
}

/// The instructions of a function, in halves of words.
fn code(file: &object::File, start: u32, size: u32) -> Vec<u16> {
    let mut data =
        (file.sections()).filter_map(|it| it.data_range(start.into(), size.into()).ok().flatten());
    let halves = data.next().unwrap_or_default().as_chunks().0;
    halves
        .iter()
        .map(|half| u16::from_le_bytes(*half))
        .collect()
}

impl Program {
    fn read(bytes: &[u8]) -> Self {
        let file = object::File::parse(bytes).unwrap();
        let text = || file.symbols().filter(|it| it.kind() == SymbolKind::Text);
        let names = text().map(|it| (it.name().unwrap().to_owned(), address(&it)));
        let names = names.collect();
        let sized = text().filter(|it| it.size() > 0);
        let sizes: BTreeMap<u32, (u32, String)> = sized
            .map(|it| {
                (
                    address(&it),
                    (it.size() as u32, it.name().unwrap().to_owned()),
                )
            })
            .collect();
        let marks = marks(&file);
        let is_data = |at: u32| (marks.range(..=at).next_back()).is_some_and(|(_, data)| *data);
        let functions = sizes.iter().map(|(start, (size, name))| {
            let mut function = Function {
                name: name.clone(),
                ..Function::default()
            };
            for (at, step) in steps(*start, &code(&file, *start, *size)) {
                match step {
                    _ if is_data(at) => {}
                    Step::Lowers(bytes) => function.frame += bytes,
                    Step::Unbounded => panic!("{name} lowers its stack by a register at {at:#x}"),
                    Step::ThroughPointer => function.through_pointers = true,
                    Step::Leads(to) if !(*start..start + size).contains(&to) => {
                        function.calls.insert(to);
                    }
                    Step::Leads(_) | Step::Other => {}
                }
            }
            (*start, function)
        });
        let mut program = Self {
            functions: functions.collect(),
            names,
        };
        program.follow_pointers();
        program
    }

    fn follow_pointers(&mut self) {
        let named = |part: &str| {
            let found = self
                .functions
                .iter()
                .filter(|(_, it)| it.name.contains(part));
            found.map(|(start, _)| *start).collect::<Vec<_>>()
        };
        let declared: Vec<_> = THROUGH_POINTERS
            .iter()
            .map(|(caller, callees)| {
                (
                    *caller,
                    callees
                        .iter()
                        .flat_map(|part| named(part))
                        .collect::<Vec<_>>(),
                )
            })
            .collect();
        for (start, function) in self
            .functions
            .iter_mut()
            .filter(|(_, it)| it.through_pointers)
        {
            let known = declared
                .iter()
                .find(|(caller, _)| function.name.contains(caller));
            let (_, callees) =
                known.unwrap_or_else(|| panic!("{} calls through a pointer", function.name));
            // What is declared by a part of its name may be the caller too.
            function
                .calls
                .extend(callees.iter().filter(|callee| *callee != start));
        }
    }

    fn start_of(&self, name: &str) -> u32 {
        let found = self.names.get(name);
        *found.unwrap_or_else(|| panic!("no {name}"))
    }

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
}

#[test]
fn the_stack_has_a_bound_far_below_its_memory() {
    let firmware = Firmware::build(LogicName::configured(), &mut Silent).unwrap();
    let program = Program::read(&firmware.bytes);
    let tasks = PRIORITIES.map(|vectors| EXCEPTION + program.deepest(vectors));
    let below = program.deepest(&["main"]);
    let bound = below + tasks.iter().sum::<u32>();
    println!("stack: {bound} bytes: {below} of idle or the start, {tasks:?} by priority");
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

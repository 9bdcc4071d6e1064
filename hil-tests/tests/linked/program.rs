//! The linked firmware as a graph of calls, read from its own instructions.
//!
//! Calls through pointers are declared below; one that is not fails the test.

use std::collections::{BTreeMap, BTreeSet};

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

use super::thumb::{Step, steps};

/// Vectors by priority, lowest first: the table of `src/main.rs`, and the monotonic.
pub const PRIORITIES: [&[&str]; 6] = [
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

/// A function: what it takes, whom it calls, and whether it does so through pointers.
#[derive(Debug, Default)]
pub struct Function {
    pub name: String,
    pub frame: u32,
    pub calls: BTreeSet<u32>,
    through_pointers: bool,
}

/// A firmware.
pub struct Program {
    /// By their addresses.
    pub functions: BTreeMap<u32, Function>,
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
    pub fn read(bytes: &[u8]) -> Self {
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

    pub fn start_of(&self, name: &str) -> u32 {
        let found = self.names.get(name);
        *found.unwrap_or_else(|| panic!("no {name}"))
    }
}

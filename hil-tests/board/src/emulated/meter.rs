//! Counts what the emulated core executes, and on whose behalf.
//!
//! While the meter runs, the core is given one row of instructions at a time, so that every
//! instruction is known by its address. Between two rows the meter looks where the core went: a call and its
//! return, an exception and its return. The core itself, its accesses and its time are as without.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rigless::emulator::{Access, Checked, CoreBus, Exit, InterruptLine, Processor, Queued};
use rigless::time::VirtualNanos;

use super::thumb::{Flow, Rows};
use crate::elf::Code;
use crate::tally::{Came, Tally};

/// Number of the program status register by which GDB asks for it, and its exception's bits.
const XPSR: usize = 16;
const EXCEPTION: u16 = 0x1FF;
/// Where the core is that sleeps as it leaves its last handler: the lowest value that returns from one.
const ASLEEP_ON_EXIT: u32 = 0xF000_0000;

/// The meter of a core, which the core and the loop around it share.
#[derive(Clone, Debug, Default)]
pub(super) struct SharedMeter(Arc<Mutex<Option<Meter>>>);

impl SharedMeter {
    /// Counts from here on.
    pub(super) fn start(&self, code: Code, from_ns: u64, instructions: u64) {
        *self.meter() = Some(Meter::new(code, from_ns, instructions));
    }

    /// What was counted, if anything.
    pub(super) fn take(&self, to_ns: u64, instructions: u64) -> Option<Tally> {
        Some(self.meter().take()?.tally(to_ns, instructions))
    }

    /// The meter, where it runs.
    pub(super) fn meter(&self) -> MutexGuard<'_, Option<Meter>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A handler, or the thread, that has begun and not ended.
#[derive(Debug)]
struct Activation {
    exception: u16,
    /// The way that led to the function that the core executes.
    way: usize,
    /// Where each open call returns to, and the way of its caller.
    calls: Vec<(u32, usize)>,
}

/// Counts rows, and follows calls and exceptions.
#[derive(Debug)]
pub(super) struct Meter {
    rows: Rows,
    from_ns: u64,
    before: u64,
    ways: Vec<Came>,
    places: HashMap<Came, usize>,
    /// What is active, the newest last; never empty once the core has run.
    active: Vec<Activation>,
    /// How often so many instructions from an address were executed, by way.
    counts: HashMap<(usize, u32, u64), u64>,
    entries: BTreeMap<u16, u64>,
}

impl Meter {
    fn new(code: Code, from_ns: u64, before: u64) -> Self {
        Self {
            rows: Rows::of(code),
            from_ns,
            before,
            ways: Vec::new(),
            places: HashMap::new(),
            active: Vec::new(),
            counts: HashMap::new(),
            entries: BTreeMap::new(),
        }
    }

    fn tally(mut self, to_ns: u64, instructions: u64) -> Tally {
        let mut counts = BTreeMap::new();
        for ((way, address, length), times) in self.counts {
            for at in self.rows.at(address).first(length) {
                *counts.entry((way, *at)).or_default() += times;
            }
        }
        Tally {
            from_ns: self.from_ns,
            to_ns,
            executed: instructions - self.before,
            ways: self.ways,
            counts,
            entries: self.entries,
        }
    }

    /// As [`Processor::run`] of the core, which executes the same.
    pub(super) fn run(
        &mut self,
        core: &mut dyn Processor,
        budget: u32,
        bus: &mut dyn CoreBus,
    ) -> (Exit, u64) {
        let mut bus = RowByRow { bus, left: None };
        // Takes an exception that is due, and executes nothing.
        let (exit, _) = core.run(0, &mut bus);
        let pc = core.pc() as u32;
        self.follow(core, Flow::Elsewhere, [pc; 2]);
        if exit != Exit::Budget {
            return (exit, 0);
        }
        let (mut left, mut all) = (budget, 0);
        while left > 0 {
            let pc = core.pc() as u32;
            let row = self.rows.at(pc);
            let (exit, executed) = core.run(left.min(row.len()), &mut bus);
            if executed > 0 {
                let way = self.active.last().map_or(0, |active| active.way);
                *self.counts.entry((way, pc, executed)).or_default() += 1;
                let (flow, last, behind) = row.behind(executed);
                self.follow(core, flow, [last, behind]);
            }
            all += executed;
            left = bus.left.take().unwrap_or(left - executed as u32);
            if exit != Exit::Budget {
                return (exit, all);
            }
        }
        (Exit::Budget, all)
    }

    /// Notices where the core went from an instruction: its address, and the one behind it.
    fn follow(&mut self, core: &dyn Processor, flow: Flow, [at, behind]: [u32; 2]) {
        let (pc, exception) = (core.pc() as u32, exception_of(core));
        if pc >= ASLEEP_ON_EXIT {
            self.active.retain(|active| active.exception == 0);
            if self.active.is_empty() {
                self.activate(0);
            }
            return;
        }
        let Some(active) = self.active.last_mut() else {
            return self.activate(exception);
        };
        let same = active.exception == exception;
        match flow {
            Flow::Call if !same || pc != behind => {
                let caller = active.way;
                active.calls.push((behind, caller));
                let way = self.way(Came::Call { caller, at });
                self.active.last_mut().expect("as before").way = way;
            }
            Flow::Return if same && pc != behind => self.return_to(pc),
            Flow::Next if same => assert_eq!(pc, behind, "behind {at:#x}"),
            _ => {}
        }
        if !same {
            if flow == Flow::Return {
                self.active.pop();
            }
            self.switch_to(exception);
        }
    }

    /// A return within the same exception.
    fn return_to(&mut self, pc: u32) {
        let active = self.active.last_mut().expect("something runs");
        match active.calls.iter().rposition(|call| call.0 == pc) {
            Some(place) => {
                active.way = active.calls[place].1;
                active.calls.truncate(place);
            }
            // Its handler ended, and begins again at once.
            None if active.exception != 0 && active.calls.is_empty() => {
                *self.entries.entry(active.exception).or_default() += 1;
            }
            None => {}
        }
    }

    /// The core went on with another exception: one that was interrupted, or a new one.
    fn switch_to(&mut self, exception: u16) {
        let of = |active: &Activation| active.exception == exception;
        match self.active.iter().rposition(of) {
            Some(place) => self.active.truncate(place + 1),
            None => {
                // The thread is none.
                if exception != 0 {
                    *self.entries.entry(exception).or_default() += 1;
                }
                self.activate(exception);
            }
        }
    }

    fn activate(&mut self, exception: u16) {
        let way = self.way(Came::Exception(exception));
        self.active.push(Activation {
            exception,
            way,
            calls: Vec::new(),
        });
    }

    fn way(&mut self, came: Came) -> usize {
        *self.places.entry(came).or_insert_with(|| {
            self.ways.push(came);
            self.ways.len() - 1
        })
    }
}

/// The number of the exception that the core handles.
fn exception_of(core: &dyn Processor) -> u16 {
    let register = core.gdb_register(XPSR).unwrap_or_default();
    let low = [0, 1].map(|byte| register.get(byte).copied().unwrap_or(0));
    u16::from_le_bytes(low) & EXCEPTION
}

/// The core's bus, which has the core come back after each access.
struct RowByRow<'b> {
    bus: &'b mut dyn CoreBus,
    /// What the core may still execute, by its bus, behind the newest access.
    left: Option<u32>,
}

impl CoreBus for RowByRow<'_> {
    fn carry_on(&mut self, instructions: u64, event: Option<VirtualNanos>) -> Option<u32> {
        self.left = self.bus.carry_on(instructions, event);
        self.left.map(|_| 0)
    }

    fn access(&mut self, access: Access, from_code: bool) -> Option<u64> {
        self.bus.access(access, from_code)
    }

    fn time(&self, instructions: u64) -> VirtualNanos {
        self.bus.time(instructions)
    }

    fn queued(&mut self) -> Vec<Queued> {
        self.bus.queued()
    }

    fn acknowledge(&mut self, line: InterruptLine, instructions: u64) -> Option<u64> {
        self.bus.acknowledge(line, instructions)
    }

    fn read_checked(&mut self, access: Access, report: bool) -> Option<Checked> {
        self.bus.read_checked(access, report)
    }

    fn write_checked(&mut self, access: Access) -> Option<bool> {
        self.bus.write_checked(access)
    }

    fn stops_before(&mut self, access: &Access) -> bool {
        self.bus.stops_before(access)
    }

    fn send_trace(&mut self, bytes: &[u8]) {
        self.bus.send_trace(bytes);
    }
}

//! The firmware while it flies: its handlers, from interrupt to motors, its locks.

use anyhow::{Result, ensure};

use super::activations::{Activation, Activations, Instant, returns};
use super::locks::{LockPlaces, Locks};
use super::table::{Cost, Memory};
use super::{CORE_HZ, SWAP_LIMIT};
use crate::firmware::Firmware;
use crate::progress::{Progress, named};
use crate::record::HANDLERS;
use crate::replay::options::ReplayOptions;
use crate::replay::{emulated::Session, open_flight};
use emulated_board::{Elf, Hit, MotorWrite, Observer, Watched};

/// Seconds of the default flight: warm-up, reactive control, dozens of refits.
const LENGTH_S: f64 = 12.0;

/// Numbers of those on the way from the interrupt to the motors.
const INTERRUPT: usize = 0;
const END_OF_WAY: usize = 3;
/// Handlers that the table has rows of.
const LISTED: usize = 4;

/// What happens at a watched address.
#[derive(Clone, Copy, Debug)]
enum Event {
    Entry(usize),
    Return(usize),
    Raise,
    Lower,
    Swap,
}

/// What was measured.
pub(super) struct Flown {
    pub(super) parts: Vec<Cost>,
    pub(super) locks: Vec<Cost>,
    pub(super) memory: Memory,
}

/// Everything seen while the firmware flies.
struct Watcher {
    events: Vec<Event>,
    activations: Activations,
    locks: Locks,
    own: [Vec<u64>; HANDLERS.len()],
    way: Way,
    ways: Vec<Way>,
    writes_ns: Vec<u64>,
}

/// From an interrupt of the IMU to the end of its hyperperiod.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    start_ns: u64,
    handled: u64,
    /// The last handler.
    end_ns: [u64; 2],
}

/// Flies the default flight for some seconds.
pub(super) fn measure(firmware: &Firmware, progress: &mut dyn Progress) -> Result<Flown> {
    let options = ReplayOptions {
        duration_s: Some(LENGTH_S),
        ..ReplayOptions::default()
    };
    let (flight, path) = open_flight(&options)?;
    let (watches, events) = watched(&Elf::parse(firmware.bytes.clone())?)?;
    let mut watcher = Watcher {
        events,
        activations: Activations::default(),
        locks: Locks::default(),
        own: Default::default(),
        way: Way::default(),
        ways: Vec::new(),
        writes_ns: Vec::new(),
    };
    let mut session = Session::new(&flight, &options, firmware, watches)?;
    progress.stage(&format!("Counting a flight of {}", named(&path)));
    session.run(&mut watcher, progress)?;
    let outcome = session.end()?;
    // Two priorities above idle's are all that may be open where the flight was cut off.
    ensure!(
        watcher.activations.depth() <= 2,
        "a handler was entered and never returned"
    );
    ensure!(
        !watcher.locks.swaps.is_empty(),
        "no model was swapped in {LENGTH_S} s"
    );
    Ok(Flown {
        parts: watcher.parts(),
        locks: watcher.locks(),
        memory: Memory {
            flash: firmware.sizes.flash_bytes,
            ram: firmware.sizes.ram_bytes,
            stack: outcome.stack.used,
        },
    })
}

/// The addresses to watch, with what happens there.
fn watched(elf: &Elf) -> Result<(Vec<Watched>, Vec<Event>)> {
    let mut all: Vec<(u32, Event)> = Vec::new();
    for (number, (handler, _)) in HANDLERS.iter().enumerate() {
        let entry = elf.code(handler)?;
        let returns = returns(elf, entry)?;
        ensure!(!returns.is_empty(), "{handler} never returns");
        all.push((entry, Event::Entry(number)));
        all.extend(returns.into_iter().map(|at| (at, Event::Return(number))));
    }
    let locks = LockPlaces::of(elf, elf.function(&["reflex", "app", "idle"])?)?;
    all.extend(locks.raise.into_iter().map(|at| (at, Event::Raise)));
    all.extend(locks.lower.into_iter().map(|at| (at, Event::Lower)));
    all.push((elf.function(&["on_refit"])?, Event::Swap));
    Ok(all
        .into_iter()
        .map(|(at, event)| (Watched::Address(at), event))
        .unzip())
}

impl Observer for Watcher {
    fn motors(&mut self, write: &MotorWrite) {
        self.writes_ns.push(write.at_ns);
    }

    fn hit(&mut self, hit: Hit) {
        let at = Instant {
            ns: hit.at_ns,
            instructions: hit.instructions,
        };
        let handled = self.activations.handled();
        match self.events[hit.watch] {
            Event::Entry(handler) => self.activations.enter(handler, at),
            Event::Return(handler) => {
                if let Some(activation) = self.activations.leave(handler, at) {
                    self.take(&activation);
                }
            }
            Event::Raise if self.activations.is_idle() => self.locks.raise(at, handled),
            Event::Lower if self.activations.is_idle() => self.locks.lower(at, handled),
            Event::Swap => self.locks.swap(),
            Event::Raise | Event::Lower => {}
        }
    }
}

impl Watcher {
    fn take(&mut self, activation: &Activation) {
        self.own[activation.handler].push(activation.own);
        match activation.handler {
            INTERRUPT => {
                self.way = Way {
                    start_ns: activation.entered.ns,
                    handled: activation.own,
                    end_ns: [0; 2],
                }
            }
            between if between < END_OF_WAY => self.way.handled += activation.own,
            END_OF_WAY => {
                self.way.handled += activation.own;
                self.way.end_ns = [activation.entered.ns, activation.left_ns];
                self.ways.push(self.way);
            }
            _ => {}
        }
    }

    fn parts(&self) -> Vec<Cost> {
        let handlers = HANDLERS.iter().zip(&self.own).take(LISTED);
        let mut parts: Vec<Cost> = handlers
            .map(|((handler, what), own)| {
                Cost::of(&format!("{handler}, {what}"), own.clone(), None, CORE_HZ)
            })
            .collect();
        parts.push(self.interrupt_to_motors());
        parts
    }

    /// Handlers from the interrupt to the end of hyperperiods that wrote the motors.
    fn interrupt_to_motors(&self) -> Cost {
        let written = |way: &Way| {
            let [from, to] = way.end_ns;
            let last = self.writes_ns.partition_point(|at| *at <= to);
            let at = *self.writes_ns.get(last.checked_sub(1)?)?;
            (at >= from).then(|| at - way.start_ns)
        };
        let ways: Vec<_> = self
            .ways
            .iter()
            .filter_map(|way| Some((way.handled, written(way)?)))
            .collect();
        let longest_ns = ways.iter().map(|way| way.1).max().unwrap_or(0);
        let counts = ways.iter().map(|way| way.0).collect();
        let cost = Cost::of(
            "from interrupt to motors, all handlers",
            counts,
            None,
            CORE_HZ,
        );
        Cost {
            // Most of it the bus, while the core sleeps.
            virtual_us: longest_ns as f64 * 1e-3,
            ..cost
        }
    }

    fn locks(&self) -> Vec<Cost> {
        let Locks { swaps, others, .. } = &self.locks;
        vec![
            Cost::of(
                "lock that swaps a model",
                swaps.clone(),
                Some(SWAP_LIMIT),
                CORE_HZ,
            ),
            Cost::of("any other lock of idle", others.clone(), None, CORE_HZ),
        ]
    }
}

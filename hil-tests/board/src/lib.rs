//! The board under test, seen without knowing what plays it.
//!
//! A [`Board`] runs the flashed firmware to an instant, tells an [`Observer`]
//! what happened on its pins and in its logs, and ends in an [`Outcome`] or a
//! named [`Fault`]. [`emulated`] plays it on an instruction-level emulator; a
//! real board behind a debug probe can take its place.
//!
//! **Time** is the board's own: nanoseconds since its core left reset. Two
//! runs of an emulated board with the same inputs report the same bytes at the
//! same instants.

pub mod elf;
pub mod emulated;
pub mod fault;
pub mod log;
pub mod motors;
pub mod outcome;
pub mod rings;
pub mod tally;

use std::num::NonZeroU64;

pub use elf::{Code, Elf};
pub use emulated::{BusFault, Disturbance, SensorLine};
pub use fault::{Fault, FaultKind};
pub use log::LogLine;
pub use motors::{MOTORS, MotorWrite};
pub use outcome::{
    ENTRY_CYCLES, EXCEPTION_CYCLES, EXIT_CYCLES, LinkUse, Load, LoadSample, Outcome, StackUse,
};
pub use tally::{Came, Tally};

/// Symbol of the call log ring that the firmware keeps for its observer.
pub const CALLS_SYMBOL: &str = "REFLEX_CALLS";
/// Symbol of the settings block that is written before the firmware starts.
pub const SETTINGS_SYMBOL: &str = "REFLEX_SETTINGS";

/// A change of level on an interrupt line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// When, in ns.
    pub at_ns: u64,
    /// Which line.
    pub line: SensorLine,
    /// Whether the line became active.
    pub rising: bool,
}

/// The core arrived at a watched place, before the instruction there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit {
    /// When, in ns.
    pub at_ns: u64,
    /// Index of the place in [`Options::watches`].
    pub watch: usize,
    /// Instructions executed since reset.
    pub instructions: u64,
}

/// Hears what the firmware does, each kind of event in order of time.
///
/// Within one kind, calls are ordered by time; between kinds only as fine as
/// the board's polling period, except that everything up to the instant of
/// [`Observer::progress`] has been told by then.
pub trait Observer {
    /// A complete motor vector was written.
    fn motors(&mut self, _write: &MotorWrite) {}
    /// A sensor's interrupt line changed.
    fn edge(&mut self, _edge: Edge) {}
    /// New bytes of the call log, found by the poll at `at_ns`.
    fn calls(&mut self, _at_ns: u64, _bytes: &[u8]) {}
    /// A decoded line of the firmware's log.
    fn log(&mut self, _line: &LogLine) {}
    /// A byte of the link whose stop bit ended at `at_ns`.
    fn link(&mut self, _at_ns: u64, _byte: u8) {}
    /// The core arrived at a watched place.
    fn hit(&mut self, _hit: Hit) {}
    /// Everything until `at_ns` has been told; `instructions` since reset.
    fn progress(&mut self, _at_ns: u64, _instructions: u64) {}
}

/// A place in the code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Watched {
    /// The first instruction of a function.
    Symbol(String),
    /// The instruction at an address.
    Address(u32),
}

impl From<&str> for Watched {
    fn from(symbol: &str) -> Self {
        Self::Symbol(symbol.to_owned())
    }
}

/// Memory that is written anew each time the core asks for more.
#[derive(Clone, Debug)]
pub struct Feed {
    /// Arriving there, before the instruction, is asking.
    pub asks: Watched,
    /// Where each block is written.
    pub address: u32,
    /// The blocks in order; after the last one the memory stays as it is.
    pub blocks: Vec<Vec<u8>>,
}

/// How a board is started and watched.
#[derive(Clone, Debug)]
pub struct Options {
    /// Bytes for the symbol [`SETTINGS_SYMBOL`]; none leaves it as it is.
    pub settings: Option<Vec<u8>>,
    /// Bytes that memory holds before the firmware starts, each with the address of its first.
    pub memory: Vec<(u32, Vec<u8>)>,
    /// The run goes on past every fault and reset: what the firmware makes of it is looked at.
    pub survives: bool,
    /// Places, arrivals at which are reported as [`Observer::hit`].
    pub watches: Vec<Watched>,
    /// Memory that is filled while the program runs.
    pub feed: Option<Feed>,
    /// Nobody reads the log: what the firmware writes stays in the ring.
    pub log_is_unread: bool,
    /// The program is an autopilot: it keeps a call log, and falls silent only by a fault.
    pub flies: bool,
    /// Instructions that the core executes in a second without sleep; one per cycle of 168 MHz.
    ///
    /// Fewer make it a slower core whose buses and timers keep their clocks.
    pub instructions_per_second: NonZeroU64,
    /// What disturbs the sensors' wires.
    pub bus_faults: Vec<BusFault>,
    /// Time between two looks at the logs, in ns.
    ///
    /// RTT holds 1 KiB and the call log 2 KiB: what a period adds must fit.
    pub poll_ns: u64,
    /// By when the motors must be driven for the first time, in ns.
    pub boot_limit_ns: u64,
    /// Longest time without a motor write or a recorded call, in ns.
    pub silence_limit_ns: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            settings: None,
            memory: Vec::new(),
            survives: false,
            watches: Vec::new(),
            feed: None,
            log_is_unread: false,
            flies: true,
            instructions_per_second: NonZeroU64::new(168_000_000).expect("not zero"),
            bus_faults: Vec::new(),
            poll_ns: 1_000_000,
            boot_limit_ns: 2_000_000_000,
            silence_limit_ns: 500_000_000,
        }
    }
}

/// Firmware on its processor, with the sensors, motors and link around it.
pub trait Board {
    /// Runs on until `until_ns` and tells `observer` what happens meanwhile.
    ///
    /// Returns at once when that instant has passed. After a [`Fault`] the
    /// board stays where it stopped and every further call returns the fault.
    fn run_until(&mut self, until_ns: u64, observer: &mut dyn Observer) -> Result<(), Fault>;

    /// Transmits `bytes` to the firmware from `at_ns` on, at the link's rate.
    ///
    /// Frames are to be given in order of time and not before the instant the
    /// board has reached; one that would overlap its predecessor follows it.
    fn transmit(&mut self, at_ns: u64, bytes: &[u8]);

    /// Counts from here on which instructions are executed, for [`Outcome::tally`].
    fn count(&mut self);

    /// The instant reached, in ns.
    fn now_ns(&self) -> u64;

    /// Ends the run and measures what can only be measured at the end.
    fn finish(self: Box<Self>) -> Result<Outcome, Fault>;
}

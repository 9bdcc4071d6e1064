//! What the core's thread hands to the host's, one poll at a time.

use crate::{Edge, FaultKind, Hit, LinkUse, MotorWrite, Observer, StackUse, Tally};

/// An event with an instant of its own.
#[derive(Clone, Copy, Debug)]
pub(super) enum Event {
    Motors(MotorWrite),
    Edge(Edge),
    Hit(Hit),
    Link(u64, u8),
}

impl Event {
    pub(super) fn at_ns(&self) -> u64 {
        match self {
            Self::Motors(write) => write.at_ns,
            Self::Edge(edge) => edge.at_ns,
            Self::Hit(hit) => hit.at_ns,
            Self::Link(at_ns, _) => *at_ns,
        }
    }

    pub(super) fn tell(&self, observer: &mut dyn Observer) {
        match self {
            Self::Motors(write) => observer.motors(write),
            Self::Edge(edge) => observer.edge(*edge),
            Self::Hit(hit) => observer.hit(*hit),
            Self::Link(at_ns, byte) => observer.link(*at_ns, *byte),
        }
    }
}

/// Everything found by one poll.
#[derive(Debug, Default)]
pub(super) struct Batch {
    pub(super) at_ns: u64,
    pub(super) instructions: u64,
    /// Entered so far.
    pub(super) exceptions: u64,
    /// In order of time.
    pub(super) events: Vec<Event>,
    pub(super) calls: Vec<u8>,
    pub(super) log: Vec<u8>,
    /// The instant the host asked for is reached.
    pub(super) reached: bool,
    pub(super) fault: Option<FaultKind>,
}

/// What is measured once, at the end.
#[derive(Debug)]
pub(super) struct Final {
    pub(super) stack: StackUse,
    pub(super) link: LinkUse,
    pub(super) unmodelled: Vec<String>,
    pub(super) motor_period_ns: Option<u64>,
    pub(super) tally: Option<Tally>,
    pub(super) fault: Option<FaultKind>,
}

/// From the core's thread to the host.
#[derive(Debug)]
pub(super) enum Message {
    /// Some polls, in order.
    Batches(Vec<Batch>),
    Final(Final),
    /// What was read.
    Memory(Vec<u8>),
    /// The emulator gave up, with its message.
    Failed(String),
}

/// From the host to the core's thread, which waits for them at an instant.
#[derive(Debug)]
pub(super) enum Command {
    RunUntil(u64),
    Transmit(u64, Vec<u8>),
    Count,
    LoseCrystal,
    /// Voltages at the battery's pins, mV.
    Measure([u32; 2]),
    Write(u32, Vec<u8>),
    Read(u32, usize),
    Finish,
}

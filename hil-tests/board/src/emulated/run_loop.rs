//! The loop around the emulated core: polls, watches, faults, commands.
//!
//! It runs on the core's thread, between two instructions. Once per polling
//! period it collects what happened into a [`Batch`]; at the instant the host
//! asked for it waits for the next command.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};

use anyhow::Result;
use rigless::emulator::{Driver, Hit as WatchHit, Host, Settled, Stop, Watch};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use super::batch::{Batch, Command, Event, Final, Message};
use super::health::{HOLES, Health};
use super::memory::Memory;
use super::meter::SharedMeter;
use super::part::{Part, Rig};
use crate::motors::VectorGatherer;
use crate::rings::{CallLog, RttLog, TargetMemory};
use crate::{CALLS_SYMBOL, Elf, FaultKind, Hit, Options, SETTINGS_SYMBOL};

/// Polls that cross to the host's thread together, to wake it less often.
const POLLS_TOGETHER: usize = 16;
/// Where registers begin: below is memory.
const REGISTERS: u32 = 0x4000_0000;
/// How long a core may go on after a fault, so that its handler can log.
const LAST_WORDS_NS: u64 = 200_000;
/// Handlers that end the flight, and the fault that arriving there means.
const FATAL: [(&str, FaultKind); 2] = [
    ("HardFault", FaultKind::HardFault { detail: None }),
    ("DefaultHandler", FaultKind::UnhandledInterrupt),
];

/// Blocks that are still to be written, and where asking for one begins.
struct Feed {
    asks: u64,
    address: u32,
    blocks: std::vec::IntoIter<Vec<u8>>,
}

impl Feed {
    fn new(elf: &Elf, feed: &crate::Feed) -> Result<Self> {
        Ok(Self {
            asks: u64::from(elf.place_of(&feed.asks)?),
            address: feed.address,
            blocks: feed.blocks.clone().into_iter(),
        })
    }
}

/// State of the loop.
pub(super) struct RunLoop {
    elf: Arc<Elf>,
    meter: SharedMeter,
    commands: Receiver<Command>,
    messages: SyncSender<Message>,
    poll_ns: u64,
    memory: Vec<(u32, Vec<u8>)>,
    survives: bool,
    stack: Range<u32>,
    watches: Vec<u64>,
    fatal: Vec<(u64, FaultKind)>,
    /// Where exceptions are handled, and how many were entered.
    handlers: BTreeSet<u64>,
    exceptions: u64,
    feed: Option<Feed>,
    calls: Option<CallLog>,
    log: Option<RttLog>,
    motors: VectorGatherer,
    health: Health,
    hits: Vec<Hit>,
    held: Vec<Batch>,
    until_ns: u64,
    prepared: bool,
}

impl RunLoop {
    /// A loop for the firmware `elf`; an error names the symbol it lacks.
    pub(super) fn new(
        (elf, meter): (&Arc<Elf>, SharedMeter),
        options: &Options,
        commands: Receiver<Command>,
        messages: SyncSender<Message>,
    ) -> Result<Self> {
        let settings = options.settings.clone().map(|bytes| {
            let address = elf.symbol(SETTINGS_SYMBOL)?;
            anyhow::Ok((address, bytes))
        });
        let memory = options.memory.iter().cloned().map(Ok).chain(settings);
        let watches = options
            .watches
            .iter()
            .map(|place| Ok(u64::from(elf.place_of(place)?)));
        let feed = options.feed.as_ref().map(|feed| Feed::new(elf, feed));
        let calls = options.flies.then(|| elf.symbol(CALLS_SYMBOL));
        let log = (!options.log_is_unread).then(|| elf.symbol("_SEGGER_RTT").map(RttLog::new));
        let fatal = FATAL
            .into_iter()
            .filter(|_| !options.survives)
            .map(|(name, fault)| Ok((u64::from(elf.code(name)?), fault)));
        Ok(Self {
            elf: Arc::clone(elf),
            meter,
            commands,
            messages,
            poll_ns: options.poll_ns.max(1),
            memory: memory.collect::<Result<_>>()?,
            survives: options.survives,
            stack: elf.stack()?,
            watches: watches.collect::<Result<_>>()?,
            fatal: fatal.collect::<Result<_>>()?,
            handlers: elf.handlers().map(u64::from).collect(),
            exceptions: 0,
            feed: feed.transpose()?,
            calls: calls.transpose()?.map(CallLog::new),
            log: log.transpose()?,
            motors: VectorGatherer::default(),
            health: Health::new(Arc::clone(elf), options),
            hits: Vec::new(),
            held: Vec::new(),
            until_ns: 0,
            prepared: false,
        })
    }

    /// Before the first instruction: settings, stack pattern, watches.
    fn prepare(
        &mut self,
        session: &mut Session<Rig>,
        host: &mut dyn Host,
    ) -> Result<(), FaultKind> {
        let mut memory = Memory(host);
        memory.paint(&self.stack)?;
        for (address, bytes) in &self.memory {
            memory.write(*address, bytes)?;
        }
        for hole in HOLES {
            session.fail_next(hole.start, hole.end);
        }
        let fatal = self.fatal.iter().map(|fatal| fatal.0);
        let asks = self.feed.iter().map(|feed| feed.asks);
        let handlers = self.handlers.iter().copied();
        for address in (self.watches.iter().copied())
            .chain(fatal)
            .chain(asks)
            .chain(handlers)
        {
            session.watch(Watch::Instruction(address));
        }
        Ok(())
    }

    fn collect(&mut self, session: &mut Session<Rig>, stop: Stop, host: &mut dyn Host) -> Batch {
        let at_ns = stop.at.0;
        let mut batch = Batch {
            at_ns,
            instructions: stop.instruction_count,
            exceptions: self.exceptions,
            reached: at_ns >= self.until_ns,
            ..Batch::default()
        };
        self.take_events(session, &mut batch);
        let mut memory = Memory(host);
        let rings = self.read_rings(&mut memory, &mut batch);
        let full = memory.is_full(&self.stack);
        let overflow = FaultKind::StackOverflow {
            available: self.stack.end - self.stack.start,
        };
        // A stack that overflowed explains everything that follows from it.
        batch.fault = match (full, rings) {
            (Ok(_), Ok(())) if self.survives => None,
            (Ok(true), _) => Some(overflow),
            (Err(fault), _) | (_, Err(fault)) => Some(fault),
            (Ok(false), Ok(())) => self.health.check(session, &batch),
        };
        batch
    }

    fn read_rings(&mut self, memory: &mut Memory<'_>, batch: &mut Batch) -> Result<(), FaultKind> {
        if let Some(log) = &mut self.log {
            batch.log = log.read(memory)?;
        }
        if let Some(calls) = &mut self.calls {
            batch.calls = calls.read(memory)?;
        }
        Ok(())
    }

    fn take_events(&mut self, session: &mut Session<Rig>, batch: &mut Batch) {
        let part = &mut session.board_mut().part;
        let events = &mut batch.events;
        events.extend(part.edges.drain(..).map(Event::Edge));
        events.extend(self.hits.drain(..).map(Event::Hit));
        let heard = part.link.take_heard().into_iter();
        events.extend(heard.map(|(at_ns, byte)| Event::Link(at_ns, byte)));
        let [first, second] = &mut part.timers;
        let mut writes: Vec<_> = first
            .writes
            .drain(..)
            .chain(second.writes.drain(..))
            .collect();
        writes.sort_by_key(|write| write.at_ns);
        let vectors = writes
            .into_iter()
            .filter_map(|write| self.motors.push(write));
        events.extend(vectors.map(Event::Motors));
        events.extend(self.motors.flush(batch.at_ns).map(Event::Motors));
        events.sort_by_key(Event::at_ns);
    }

    /// Waits for the host; none when the run is to end here.
    fn obey(&mut self, session: &mut Session<Rig>, stop: Stop, host: &mut dyn Host) -> Option<()> {
        loop {
            match self.commands.recv().ok()? {
                Command::Transmit(at_ns, bytes) => {
                    session.board().part.link.schedule(at_ns, bytes);
                }
                Command::Count => {
                    let code = self.elf.executable();
                    self.meter.start(code, stop.at.0, stop.instruction_count);
                }
                Command::LoseCrystal => session.board_mut().part.lose_crystal(stop.at),
                Command::Measure(millivolts) => {
                    session.board_mut().part.measure(millivolts);
                }
                Command::Write(address, bytes) => {
                    let part = &mut session.board_mut().part;
                    if let Err(fault) = write(part, stop.at, host, address, &bytes) {
                        self.health.condemn(fault);
                    }
                }
                Command::Read(address, length) => {
                    let part = &mut session.board_mut().part;
                    let answer = match read(part, stop.at, host, address, length) {
                        Ok(bytes) => Message::Memory(bytes),
                        Err(fault) => Message::Failed(fault.to_string()),
                    };
                    self.messages.send(answer).ok()?;
                }
                Command::RunUntil(until_ns) => {
                    self.until_ns = until_ns;
                    return Some(());
                }
                Command::Finish => {
                    let last = self.last_measures(session, stop, host);
                    self.messages.send(Message::Final(last)).ok()?;
                    return None;
                }
            }
        }
    }

    fn send_held(&mut self) -> Option<()> {
        let held = std::mem::take(&mut self.held);
        self.messages.send(Message::Batches(held)).ok()
    }

    fn last_measures(
        &mut self,
        session: &mut Session<Rig>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Final {
        let stack = Memory(host).stack_use(&self.stack).unwrap_or_default();
        let unmodelled = session.unimplemented().values();
        let part = &session.board().part;
        Final {
            stack,
            link: part.link.used(),
            unmodelled: unmodelled
                .map(|gap| format!("{}.{}", gap.instance, gap.register))
                .collect(),
            motor_period_ns: part.timers[0].period_ns(),
            tally: self.meter.take(stop.at.0, stop.instruction_count),
            fault: self.health.last_check(part),
        }
    }

    /// Writes the next block where the core arrived at asking for it.
    fn fill(&mut self, host: &mut dyn Host, hit: WatchHit) {
        let asked = self.feed.as_mut().filter(|feed| feed.asks == hit.address);
        let Some((address, block)) =
            asked.and_then(|feed| Some((feed.address, feed.blocks.next()?)))
        else {
            return;
        };
        if let Err(fault) = Memory(host).write(address, &block) {
            self.health.condemn(fault);
        }
    }

    fn arrived(&mut self, session: &mut Session<Rig>, hit: WatchHit) {
        self.exceptions += u64::from(self.handlers.contains(&hit.address));
        if let Some(watch) = self.watches.iter().position(|&at| at == hit.address) {
            let (at_ns, instructions) = (hit.at.0, hit.instruction_count);
            self.hits.push(Hit {
                at_ns,
                watch,
                instructions,
            });
        }
        let fatal = self.fatal.iter().find(|fatal| fatal.0 == hit.address);
        if let Some((address, fault)) = fatal {
            session.unwatch(Watch::Instruction(*address));
            session.run_until(VirtualNanos(hit.at.0 + LAST_WORDS_NS));
            self.health.condemn(fault.clone());
        }
    }
}

/// Bytes of memory, or of the registers of the part's peripherals.
fn read(
    part: &mut Part,
    at: VirtualNanos,
    host: &mut dyn Host,
    address: u32,
    length: usize,
) -> Result<Vec<u8>, FaultKind> {
    let mut bytes = vec![0; length];
    if address < REGISTERS {
        Memory(host).read(address, &mut bytes)?;
        return Ok(bytes);
    }
    for (word, address) in bytes.chunks_mut(4).zip((u64::from(address)..).step_by(4)) {
        let value = part.read(at, address, Width::W32);
        let value = value.map_err(|error| FaultKind::Emulator(format!("{error:?}")))?;
        word.copy_from_slice(&(value as u32).to_le_bytes()[..word.len()]);
    }
    Ok(bytes)
}

/// Writes bytes to memory, or words to the registers of the part's peripherals.
fn write(
    part: &mut Part,
    at: VirtualNanos,
    host: &mut dyn Host,
    address: u32,
    bytes: &[u8],
) -> Result<(), FaultKind> {
    if address < REGISTERS {
        return Memory(host).write(address, bytes);
    }
    let words = bytes.as_chunks().0.iter();
    for (word, address) in words.zip((u64::from(address)..).step_by(4)) {
        let value = u64::from(u32::from_le_bytes(*word));
        let written = part.write(at, address, Width::W32, value);
        written.map_err(|error| FaultKind::Emulator(format!("{error:?}")))?;
    }
    Ok(())
}

impl Driver<Rig> for RunLoop {
    fn on_settled(&mut self, session: &mut Session<Rig>, host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Hit(hit) => {
                self.fill(host, hit);
                self.arrived(session, hit);
            }
            Settled::Access { access, .. } => self.health.note_access(access),
            // A board that was reset is at its end: no need to boot it again.
            Settled::Stop(stop) if !self.survives && !session.resets().is_empty() => {
                session.run_until(stop.at);
            }
            _ => {}
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Rig>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        let at_ns = stop.at.0;
        if self.prepared {
            let batch = self.collect(session, stop, host);
            let (reached, failed) = (batch.reached, batch.fault.is_some());
            self.held.push(batch);
            if reached || failed || self.held.len() == POLLS_TOGETHER {
                self.send_held()?;
            }
            if failed {
                return None;
            }
            if reached {
                self.obey(session, stop, host)?;
            }
        } else {
            if let Err(fault) = self.prepare(session, host) {
                let message = fault.to_string();
                self.messages.send(Message::Failed(message)).ok()?;
                return None;
            }
            self.prepared = true;
            self.obey(session, stop, host)?;
        }
        let next_poll = at_ns - at_ns % self.poll_ns + self.poll_ns;
        Some(VirtualNanos(next_poll.min(self.until_ns)))
    }
}

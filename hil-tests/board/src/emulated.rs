//! The board on an instruction-level emulator, in virtual time.
//!
//! The unmodified firmware runs on the crate `rigless` (an STM32F427 with a
//! Cortex-M4F core); the sensors are register-level models on its buses. The
//! core has a thread of its own and hands over what it found once per polling
//! period, so that decoding and scoring run beside it; the order and the
//! instants of events depend on virtual time only.
//!
//! Only this folder names the emulator.
//!
//! | file | holds |
//! |---|---|
//! | `part` | the processor: the emulator's part with our models in place |
//! | `exti`, `syscfg`, `pwm_timer` | the models that the emulator lacks or plays too dearly |
//! | `i2c`, `open_drain`, `dma` | the inertial sensor's bus |
//! | `bus_fault` | what a script has go wrong there and on interrupt lines |
//! | `sensors`, `link` | the chips and the ground station on the buses |
//! | `reflex_f427` | crystal, buses, lines and motors of the reference board |
//! | `wiring` | whether the firmware uses the pins and buffers that are wired |
//! | `metered`, `meter`, `thumb` | the core, with a meter of what it executes |
//! | `run_loop`, `health`, `memory` | polls, faults, stack |
//! | `batch` | what crosses between the two threads |
//!
//! **Not played**: cycles beyond one per instruction (no wait states; those of
//! exceptions are charged from their count), DMA arbitration, noise on lines, the pins' analogue side.

mod batch;
mod bus_fault;
mod dma;
mod exti;
mod health;
mod i2c;
mod link;
mod memory;
mod meter;
mod metered;
mod open_drain;
mod part;
mod pwm_timer;
mod reflex_f427;
mod run_loop;
mod sensors;
mod syscfg;
#[cfg(test)]
mod tests;
mod thumb;
mod wiring;

pub use bus_fault::{BusFault, Disturbance};
pub use reflex_f427::SensorLine;
pub use sensors::Sensors;

use std::num::NonZeroU64;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::thread;

use anyhow::{Context, Result};
use rigless::emulator::{self, Start};
use rigless::image::Image;
use rigless::session::Session;
use rigless::time::VirtualNanos;

use self::batch::{Batch, Command, Message};
use self::bus_fault::Script;
use self::link::Link;
use self::meter::SharedMeter;
use self::part::{Part, Rig};
use self::run_loop::RunLoop;
use super::log::LogDecoder;
use super::{Board, Elf, Fault, FaultKind, Load, LoadSample, Observer, Options, Outcome};

/// Messages that may wait for the host before the core waits for it.
const MESSAGES_AHEAD: usize = 16;
/// Time between two samples of the load, in ns.
const LOAD_PERIOD_NS: u64 = 100_000_000;

/// A booted board, standing at the instant it was last run to.
pub struct EmulatedBoard {
    commands: Sender<Command>,
    messages: Receiver<Message>,
    log: LogDecoder,
    last_error: Option<String>,
    load: Vec<LoadSample>,
    instructions_per_second: NonZeroU64,
    now_ns: u64,
    fault: Option<Fault>,
}

impl EmulatedBoard {
    /// Flashes `elf` and stands before its first instruction.
    ///
    /// An error names what the firmware lacks or why it cannot be placed.
    pub fn boot(elf: &Arc<Elf>, sensors: Sensors, options: &Options) -> Result<Self> {
        let log = LogDecoder::new(elf.bytes())?;
        let image = Image::new(Path::new("the firmware"), elf.bytes().to_vec(), None)?;
        let script = Script::from(options.bus_faults.as_slice());
        let part = Part::new(sensors, Link::default(), script)?;
        let instructions_per_second = options.instructions_per_second;
        let meter = SharedMeter::default();
        let rig = Rig {
            part,
            instructions_per_second,
            meter: meter.clone(),
        };
        let session = Session::new(Box::new(rig), 0, VirtualNanos(0))?;
        let (commands, obeyed) = mpsc::channel();
        let (sender, messages) = mpsc::sync_channel(MESSAGES_AHEAD);
        let run_loop = RunLoop::new((elf, meter), options, obeyed, sender.clone())?;
        thread::Builder::new()
            .name("emulated board".into())
            .spawn(move || run(session, &[image], run_loop, &sender))
            .context("no thread for the emulated board")?;
        Ok(Self {
            commands,
            messages,
            log,
            last_error: None,
            load: vec![LoadSample::default()],
            instructions_per_second,
            now_ns: 0,
            fault: None,
        })
    }

    /// The crystal stops now.
    ///
    /// The emulator raises no NMI: a test that wants it has the firmware pend it.
    pub fn lose_crystal(&mut self) {
        // As for `transmit`.
        let _ = self.command(Command::LoseCrystal);
    }

    /// What the battery's divider and shunt put on their pins from now on, mV; at first nothing.
    pub fn measure(&mut self, voltage_mv: u32, current_mv: u32) {
        // As for `transmit`.
        let _ = self.command(Command::Measure([voltage_mv, current_mv]));
    }

    /// Writes bytes to memory, or words to registers, between two instructions.
    pub fn write(&mut self, address: u32, bytes: &[u8]) {
        // As for `transmit`.
        let _ = self.command(Command::Write(address, bytes.to_vec()));
    }

    /// Bytes of memory, or of registers.
    ///
    /// # Errors
    /// The board is at its end, or there is nothing at the address.
    pub fn read(&mut self, address: u32, length: usize) -> Result<Vec<u8>, Fault> {
        self.command(Command::Read(address, length))?;
        loop {
            if let Message::Memory(bytes) = self.next_message()? {
                return Ok(bytes);
            }
        }
    }

    fn take_batch(&mut self, batch: Batch, observer: &mut dyn Observer) -> Result<bool, Fault> {
        self.now_ns = batch.at_ns;
        for event in &batch.events {
            event.tell(observer);
        }
        if !batch.calls.is_empty() {
            observer.calls(batch.at_ns, &batch.calls);
        }
        for line in self.log.feed(batch.at_ns, &batch.log) {
            if line.level == Some("error") {
                self.last_error = Some(line.text.clone());
            }
            observer.log(&line);
        }
        let due = (self.load.last()).map_or(0, |last| last.at_ns + LOAD_PERIOD_NS);
        if batch.at_ns >= due || batch.reached && batch.instructions > 0 {
            self.load.push(LoadSample {
                at_ns: batch.at_ns,
                instructions: batch.instructions,
                exceptions: batch.exceptions,
            });
        }
        observer.progress(batch.at_ns, batch.instructions);
        match batch.fault {
            Some(kind) => Err(self.fail(kind)),
            None => Ok(batch.reached),
        }
    }

    fn fail(&mut self, kind: FaultKind) -> Fault {
        let kind = self.explain(kind);
        let fault = Fault {
            at_ns: self.now_ns,
            kind,
        };
        self.fault = Some(fault.clone());
        fault
    }

    /// A HardFault after a panic is that panic.
    fn explain(&mut self, kind: FaultKind) -> FaultKind {
        match (kind, self.last_error.take()) {
            (FaultKind::HardFault { detail: None }, Some(text)) => {
                match text.strip_prefix("panicked at ") {
                    Some(message) => FaultKind::Panic(message.replace('\n', " ")),
                    None => FaultKind::HardFault {
                        detail: Some(format!("its log last said: {text}")),
                    },
                }
            }
            (kind, _) => kind,
        }
    }

    /// The next message; a fault when the core's thread is gone.
    fn next_message(&mut self) -> Result<Message, Fault> {
        match self.messages.recv() {
            Ok(Message::Failed(message)) => Err(self.fail(FaultKind::Emulator(message))),
            Ok(message) => Ok(message),
            Err(_) => Err(self.fail(FaultKind::Emulator("it panicked".into()))),
        }
    }

    fn command(&mut self, command: Command) -> Result<(), Fault> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        // A core that is gone has left the reason as its last message.
        let _ = self.commands.send(command);
        Ok(())
    }
}

impl Board for EmulatedBoard {
    fn run_until(&mut self, until_ns: u64, observer: &mut dyn Observer) -> Result<(), Fault> {
        if until_ns <= self.now_ns && self.fault.is_none() {
            return Ok(());
        }
        self.command(Command::RunUntil(until_ns))?;
        loop {
            let Message::Batches(batches) = self.next_message()? else {
                continue;
            };
            for batch in batches {
                if self.take_batch(batch, observer)? {
                    return Ok(());
                }
            }
        }
    }

    fn transmit(&mut self, at_ns: u64, bytes: &[u8]) {
        // After a fault nobody listens any more, which run_until reports.
        let _ = self.command(Command::Transmit(at_ns, bytes.to_vec()));
    }

    fn count(&mut self) {
        // As for `transmit`.
        let _ = self.command(Command::Count);
    }

    fn now_ns(&self) -> u64 {
        self.now_ns
    }

    fn finish(mut self: Box<Self>) -> Result<Outcome, Fault> {
        self.command(Command::Finish)?;
        loop {
            let Message::Final(last) = self.next_message()? else {
                continue;
            };
            if let Some(kind) = last.fault {
                return Err(self.fail(kind));
            }
            return Ok(Outcome {
                ended_ns: self.now_ns,
                load: Load {
                    instructions_per_second: self.instructions_per_second.get(),
                    samples: self.load,
                },
                stack: last.stack,
                link: last.link,
                motor_period_ns: last.motor_period_ns,
                damaged_log_frames: self.log.damaged(),
                unmodelled: last.unmodelled,
                tally: last.tally,
            });
        }
    }
}

fn run(session: Session<Rig>, images: &[Image], run_loop: RunLoop, sender: &SyncSender<Message>) {
    if let Err(error) = emulator::run(session, &Start::new(images), run_loop) {
        // Nobody to tell when the host has dropped the board.
        let _ = sender.send(Message::Failed(error.to_string()));
    }
}

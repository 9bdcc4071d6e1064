//! Bursts of the MPU6050 moved by interrupts and DMA: no instruction waits.
//!
//! One transaction is START, address, register, repeated START, address, data by DMA, STOP: four
//! event interrupts of some 30 instructions and one at the end of the DMA. Checks of the chip's
//! registers are appended to a burst by a repeated START, so they never delay one.
//!
//! A transaction that got nowhere from one edge to the next is cut off; one that is only slow goes on,
//! and the edge is counted. Two that fail in a row have the bus repaired, by another task: nothing here
//! waits longer than a few microseconds, for a STOP or for a stream to end.

use heapless::Deque;
use reflex::app::Fault;
use reflex::tasks::imu::{self, Edge, Guard, Guarded, Imu, Remedy};
use reflex::tasks::mpu6050::Sensor;
use reflex::time::Instant;
use reflex_drivers::Error;
use reflex_drivers::mpu6050::{ADDRESS, BURST_LENGTH, BURST_START, Check};
use stm32f4xx_hal::ClearFlags;
use stm32f4xx_hal::dma::traits::{Channel, Stream, StreamISR};
use stm32f4xx_hal::dma::{ChannelX, DmaDirection, Stream0, config::Priority};
use stm32f4xx_hal::pac::{self, Interrupt};

use super::{Bus, Repaired};

/// Event interrupts of one transaction before it counts as hung, spurious errors among them; four
/// are expected, and a START that waits for its turn on the bus repeats the one before it for some
/// microseconds.
const MOST_EVENTS: u8 = 100;
/// Looks at a STOP that is on the wire, or at a stream that ends: some 5 us.
const MOST_LOOKS: u8 = 100;
/// Faults that may wait to be reported.
const FAULTS: usize = 4;

/// The vector of the task that takes the reports: that of the DMA stream.
const READER: Interrupt = Interrupt::DMA1_STREAM0;

/// Where the DMA puts a burst: in words, which are read in fewer steps than bytes.
pub type Buffer = [u32; BURST_LENGTH.div_ceil(4)];

type Report = imu::Report<Sensor>;

/// What the transaction under way is for.
#[derive(Clone, Copy, Debug)]
enum Purpose {
    Burst(Instant),
    Check(Check),
}

impl Purpose {
    fn register(self) -> u8 {
        match self {
            Self::Burst(_) => BURST_START,
            Self::Check(check) => check.register,
        }
    }

    fn length(self) -> u16 {
        match self {
            Self::Burst(_) => BURST_LENGTH as u16,
            Self::Check(check) => u16::from(check.length),
        }
    }
}

/// What the transaction under way waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Start,
    WriteAddress,
    Restart,
    ReadAddress,
    Data,
}

/// The bus with its DMA stream; without the bus while it is lent.
pub struct Engine {
    bus: Option<Bus>,
    stream: Stream0<pac::DMA1>,
    buffer: &'static mut Buffer,
    phase: Phase,
    purpose: Purpose,
    guard: Guard<Sensor>,
    events: u8,
    /// How far the transaction was at the last edge.
    got: u16,
    /// A spurious error was reported of this transaction.
    glitch: bool,
    /// The bus is to be repaired.
    repair: bool,
    faults: Deque<(Instant, Fault), FAULTS>,
}

impl Guarded for Engine {
    type Imu = Sensor;

    fn guard(&mut self) -> &mut Guard<Sensor> {
        &mut self.guard
    }
}

impl Engine {
    /// Takes the stream and a buffer that the DMA controller can reach; the bus comes by
    /// [`Engine::give_back`].
    pub fn new(mut stream: Stream0<pac::DMA1>, buffer: &'static mut Buffer) -> Self {
        stream.set_channel(ChannelX::<1>::VALUE);
        stream.set_direction(DmaDirection::PeripheralToMemory);
        stream.set_memory_increment(true);
        stream.set_priority(Priority::VeryHigh);
        stream.set_memory_address(buffer.as_mut_ptr() as u32);
        stream.listen_transfer_complete();
        stream.listen_transfer_error();
        let never = Instant::from_ticks(0);
        Self {
            bus: None,
            stream,
            buffer,
            phase: Phase::Idle,
            purpose: Purpose::Burst(never),
            guard: Guard::new(never),
            events: 0,
            got: 0,
            glitch: false,
            repair: false,
            faults: Deque::new(),
        }
    }

    /// An edge, or that one is missing: starts a burst, or counts what else it may be.
    #[inline]
    pub fn on_edge(&mut self, edge: Edge) {
        match edge {
            Edge::Sample(at) => self.start_burst(at),
            Edge::TooSoon(at) => self.tell(Fault::ImuEdge, at),
            Edge::Missed { at, first } => {
                if first {
                    self.tell(Fault::ImuLine, at);
                }
                self.start_burst(at);
            }
        }
    }

    /// Starts a burst, unless one is under way that gets on.
    fn start_burst(&mut self, at: Instant) {
        if self.phase != Phase::Idle {
            let got = self.progress();
            if got != self.got {
                self.got = got;
                return self.tell(Fault::ImuOverrun, at);
            }
            self.abort(at);
        }
        if self.bus.as_ref().is_some_and(|bus| !bus.is_free()) {
            return self.abort(at);
        }
        self.begin(Purpose::Burst(at));
    }

    /// How far the transaction is; 0 before its first event.
    fn progress(&self) -> u16 {
        let data = match self.phase {
            Phase::Data => BURST_LENGTH as u16 - self.stream.number_of_transfers(),
            _ => 0,
        };
        u16::from(self.events) + data
    }

    /// Lends the bus for polled transfers, with what they are to do; bursts that fall into that time
    /// are left out.
    ///
    /// `None` while it is lent already.
    pub fn lend(&mut self) -> Option<(Bus, Remedy)> {
        let mut bus = self.bus.take()?;
        self.phase = Phase::Idle;
        self.stop_stream();
        bus.restart();
        Some((bus, self.guard.remedy(crate::board::now())))
    }

    /// Takes the bus back, and the result of the repair. Silence is counted from here.
    pub fn give_back(&mut self, bus: Bus, repaired: &Repaired) {
        let now = crate::board::now();
        if repaired.is_err() {
            self.tell(Fault::ImuBus, now);
        }
        self.bus = Some(bus);
        self.phase = Phase::Idle;
        let answered = !matches!(repaired, Err(Error::Bus(_)));
        self.guard.repaired(now, answered);
    }

    /// A cut-off that was not reported yet, or what the transaction that ended led to.
    pub fn report(&mut self) -> Option<Report> {
        if let Some((at, fault)) = self.faults.pop_front() {
            // There may be more to report.
            rtic::pend(READER);
            let repair = core::mem::take(&mut self.repair);
            return Some(Report::Fault(at, fault, repair));
        }
        if self.phase != Phase::Data {
            // Of a stream that took its time to stop: it would raise this interrupt for ever.
            self.stream.clear_all_flags();
            return None;
        }
        if self.stream.is_transfer_complete() {
            return self.finish();
        }
        if self.stream.is_transfer_error() {
            self.abort_now();
        }
        None
    }

    fn begin(&mut self, purpose: Purpose) {
        let Some(bus) = &mut self.bus else { return };
        self.purpose = purpose;
        self.events = 0;
        self.got = 0;
        self.glitch = false;
        self.phase = Phase::Start;
        bus.listen(Listen::Events);
        bus.request_start();
    }

    /// `I2C1_EV`: one step of the transaction.
    pub fn on_event(&mut self) {
        let Some(bus) = &mut self.bus else { return };
        let status = bus.i2c.sr1().read();
        self.events = self.events.saturating_add(1);
        if self.events > MOST_EVENTS {
            return self.abort_now();
        }
        match self.phase {
            Phase::Start if status.sb().bit_is_set() => {
                if status.rx_ne().bit_is_set() {
                    // A byte that the last transaction left would shift all data by one; there is
                    // room for two of them.
                    bus.i2c.dr().read();
                    bus.i2c.dr().read();
                }
                bus.take_start_back();
                bus.i2c.dr().write(|w| w.dr().set(ADDRESS << 1));
                self.phase = Phase::WriteAddress;
            }
            Phase::WriteAddress if status.addr().bit_is_set() => {
                bus.i2c.sr2().read();
                bus.i2c.dr().write(|w| w.dr().set(self.purpose.register()));
                // Waits for the end of that byte (RM0090, 27.3.3): no interrupt in between.
                bus.request_start();
                self.phase = Phase::Restart;
            }
            Phase::Restart if status.sb().bit_is_set() => {
                bus.take_start_back();
                bus.i2c.dr().write(|w| w.dr().set(ADDRESS << 1 | 1));
                self.phase = Phase::ReadAddress;
            }
            Phase::ReadAddress if status.addr().bit_is_set() => self.receive(),
            Phase::Idle | Phase::Data => bus.listen(Listen::Nothing),
            // An event that repeats itself: MOST_EVENTS bounds it.
            _ => {}
        }
    }

    /// `I2C1_ER`: nobody answered, or the bus was disturbed.
    pub fn on_error(&mut self) {
        let Some(bus) = &mut self.bus else { return };
        let status = bus.i2c.sr1().read();
        bus.clear_errors();
        if self.phase == Phase::Idle {
            return;
        }
        if status.af().bit_is_set() {
            if self.phase == Phase::Restart {
                // A START is on its way: no STOP may be asked for, and its SB would begin the next
                // transaction.
                return self.abort_now();
            }
            // The bus is well, and ours.
            self.end();
            return self.fail(crate::board::now());
        }
        self.events = self.events.saturating_add(1);
        if status.arlo().bit_is_set() || self.events > MOST_EVENTS {
            return self.abort_now();
        }
        // A bus error in a master is spurious, and its transfer goes on (ES0206, 2.10.1).
        if !core::mem::replace(&mut self.glitch, true) {
            self.tell(Fault::ImuGlitch, crate::board::now());
        }
    }

    /// Hands the data phase to the DMA, then lets the address event end.
    fn receive(&mut self) {
        let length = self.purpose.length();
        let Some(bus) = &mut self.bus else { return };
        self.stream
            .set_peripheral_address(bus.i2c.dr().as_ptr() as u32);
        self.stream.set_number_of_transfers(length);
        self.stream.clear_all_flags();
        // SAFETY: configured in `new`; the buffer is static and at least `length` bytes long, and
        // nothing reads it before the transfer is complete.
        unsafe { self.stream.enable() };
        bus.listen(Listen::Data);
        if length == 1 {
            bus.i2c.cr1().write(|w| w.pe().set_bit());
        }
        bus.i2c.sr2().read();
        self.phase = Phase::Data;
    }

    /// The DMA has the last byte: goes on with a check or ends with STOP.
    fn finish(&mut self) -> Option<Report> {
        self.stream.clear_all_flags();
        if self.bus.as_ref().is_some_and(Bus::is_data_held) {
            // The chip let go of SDA at the last byte: what holds it made zeros of the data.
            self.abort_now();
            return None;
        }
        // SAFETY: the transfer is complete; volatile, because the DMA controller wrote it.
        let words = unsafe { core::ptr::read_volatile(self.buffer) };
        let bytes = words.map(u32::to_le_bytes);
        let bytes = bytes.as_flattened().first_chunk();
        let bytes = *bytes.unwrap_or(&[0; BURST_LENGTH]);
        Some(match self.purpose {
            Purpose::Burst(at) => {
                let new = Sensor::is_new(&bytes);
                // One that forgot what it is to do has nothing new either.
                let silent = !new && self.guard.is_silent(at);
                if new {
                    self.guard.hear(at);
                }
                match self.guard.check(at, crate::board::now) {
                    Some(check) => self.begin(Purpose::Check(check)),
                    None => self.end(),
                }
                match new {
                    true => Report::Burst(at, bytes),
                    false => Report::Fault(at, Fault::ImuStale, silent),
                }
            }
            Purpose::Check(check) => {
                self.end();
                let [a, b, c, d, ..] = bytes;
                Report::Check(check, [a, b, c, d])
            }
        })
    }

    fn end(&mut self) {
        self.phase = Phase::Idle;
        if let Some(bus) = &mut self.bus {
            bus.listen(Listen::Nothing);
            bus.i2c.cr1().write(|w| w.pe().set_bit().stop().set_bit());
        }
    }

    /// As [`Self::abort`]; not inlined, as its registers would be saved at every event.
    #[cold]
    #[inline(never)]
    fn abort_now(&mut self) {
        self.abort(crate::board::now());
    }

    /// Cuts the transaction off and reports it.
    #[cold]
    #[inline(never)]
    fn abort(&mut self, at: Instant) {
        self.stop_stream();
        self.phase = Phase::Idle;
        if let Some(bus) = &mut self.bus {
            bus.restart();
            // A line that is still low needs clocks: another attempt would only hang.
            self.repair |= bus.is_held();
        }
        self.fail(at);
    }

    #[cold]
    #[inline(never)]
    fn fail(&mut self, at: Instant) {
        self.repair |= self.guard.fail();
        self.tell(Fault::ImuBus, at);
    }

    /// Reports a fault at the priority of the reports' reader; a full queue tells enough already.
    #[cold]
    #[inline(never)]
    fn tell(&mut self, fault: Fault, at: Instant) {
        let _ = self.faults.push_back((at, fault));
        rtic::pend(READER);
    }

    /// Ends a stream by the book (RM0090, 10.3.17): its interrupts off, EN off, and its flags cleared
    /// once it reads off, as it raises them when it has really stopped.
    fn stop_stream(&mut self) {
        self.stream.unlisten_transfer_complete();
        self.stream.unlisten_transfer_error();
        // SAFETY: the data are given up.
        unsafe { self.stream.disable() };
        let _ = (0..MOST_LOOKS).any(|_| !self.stream.is_enabled());
        self.stream.clear_all_flags();
        self.stream.listen_transfer_complete();
        self.stream.listen_transfer_error();
    }
}

/// Which interrupts and DMA requests the peripheral may raise.
#[derive(Clone, Copy)]
enum Listen {
    Nothing,
    Events,
    Data,
}

impl Bus {
    /// False where a STOP stays on its way, until when CR1 must not be written, or a line is held.
    fn is_free(&self) -> bool {
        (0..MOST_LOOKS).any(|_| self.i2c.cr1().read().stop().bit_is_clear()) && !self.is_held()
    }

    fn request_start(&mut self) {
        self.i2c
            .cr1()
            .write(|w| w.pe().set_bit().ack().set_bit().start().set_bit());
    }

    /// A START that had to wait for a byte's end was carried out: taken back, so that the next one
    /// is a new request, whatever the peripheral remembers.
    fn take_start_back(&mut self) {
        self.i2c.cr1().write(|w| w.pe().set_bit().ack().set_bit());
    }

    fn listen(&mut self, what: Listen) {
        self.i2c.cr2().write(|w| {
            // SAFETY: as in `restart`.
            let w = unsafe { w.freq().bits(super::PCLK_MHZ) };
            match what {
                Listen::Nothing => w,
                Listen::Events => w.iterren().set_bit().itevten().set_bit(),
                // LAST has the byte before the end of the DMA refused, so that the chip stops.
                Listen::Data => w.iterren().set_bit().dmaen().set_bit().last().set_bit(),
            }
        });
    }
}

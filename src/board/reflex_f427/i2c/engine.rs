//! Bursts of the MPU6050 moved by interrupts and DMA: no instruction waits.
//!
//! One transaction is START, address, register, repeated START, address, data by DMA, STOP: four
//! event interrupts of some 30 instructions and one at the end of the DMA. A transaction still
//! under way when the next one is due is cut off and reported: nothing here waits, so nothing
//! here can hang. Checks of the chip's registers are appended to a burst by a repeated START, so
//! they never delay one.

use heapless::Deque;
use reflex::app::Fault;
use reflex::tasks::imu::{self, Guard, Guarded};
use reflex::tasks::mpu6050::Sensor;
use reflex::time::Instant;
use reflex_drivers::mpu6050::{ADDRESS, BURST_LENGTH, BURST_START, Check};
use stm32f4xx_hal::ClearFlags;
use stm32f4xx_hal::dma::traits::{Channel, Stream, StreamISR};
use stm32f4xx_hal::dma::{ChannelX, DmaDirection, Stream0, config::Priority};
use stm32f4xx_hal::pac::{self, Interrupt};

use super::Bus;

/// Event interrupts of one transaction before it counts as hung; four are expected, and a START
/// that waits for its turn on the bus repeats the one before it for some microseconds.
const MOST_EVENTS: u8 = 100;
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
        let never = Instant::from_ticks(0);
        Self {
            bus: None,
            stream,
            buffer,
            phase: Phase::Idle,
            purpose: Purpose::Burst(never),
            guard: Guard::new(never),
            events: 0,
            faults: Deque::new(),
        }
    }

    /// Starts a burst for the interrupt stamped `at`; cuts off what is still under way.
    pub fn start_burst(&mut self, at: Instant) {
        if self.phase != Phase::Idle {
            self.abort(Fault::ImuOverrun, at);
        }
        self.begin(Purpose::Burst(at));
    }

    /// Lends the bus for polled transfers; bursts that fall into that time are left out.
    ///
    /// `None` while it is lent already.
    pub fn lend(&mut self) -> Option<Bus> {
        let mut bus = self.bus.take()?;
        self.phase = Phase::Idle;
        self.stop_stream();
        bus.restart();
        Some(bus)
    }

    /// Takes the bus back, reports what failed meanwhile; silence is counted from here.
    pub fn give_back(&mut self, bus: Bus, failed: Option<Fault>) {
        if let Some(fault) = failed {
            self.tell(fault, crate::board::now());
        }
        self.bus = Some(bus);
        self.phase = Phase::Idle;
        self.guard.hear(crate::board::now());
    }

    /// A cut-off that was not reported yet, or what the transaction that ended led to.
    pub fn report(&mut self) -> Option<Report> {
        if let Some((at, fault)) = self.faults.pop_front() {
            // There may be more to report.
            rtic::pend(READER);
            return Some(Report::Fault(at, fault));
        }
        (self.phase == Phase::Data && self.stream.is_transfer_complete()).then(|| self.finish())
    }

    fn begin(&mut self, purpose: Purpose) {
        let Some(bus) = &mut self.bus else { return };
        self.purpose = purpose;
        self.events = 0;
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
            return self.abort_now(Fault::ImuBus);
        }
        match self.phase {
            Phase::Start if status.sb().bit_is_set() => {
                if status.rx_ne().bit_is_set() {
                    // A byte that the last transaction left would shift all data by one.
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
        self.abort_now(Fault::ImuBus);
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
    fn finish(&mut self) -> Report {
        self.stream.clear_all_flags();
        // SAFETY: the transfer is complete; volatile, because the DMA controller wrote it.
        let words = unsafe { core::ptr::read_volatile(self.buffer) };
        let bytes = words.map(u32::to_le_bytes);
        let bytes = bytes.as_flattened().first_chunk();
        let bytes = *bytes.unwrap_or(&[0; BURST_LENGTH]);
        match self.purpose {
            Purpose::Burst(at) => {
                self.guard.hear(at);
                match self.guard.check(at, crate::board::now) {
                    Some(check) => self.begin(Purpose::Check(check)),
                    None => self.end(),
                }
                Report::Burst(at, bytes)
            }
            Purpose::Check(check) => {
                self.end();
                let [a, b, c, d, ..] = bytes;
                Report::Check(check, [a, b, c, d])
            }
        }
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
    fn abort_now(&mut self, fault: Fault) {
        self.abort(fault, crate::board::now());
    }

    /// Cuts the transaction off and reports it.
    #[cold]
    #[inline(never)]
    fn abort(&mut self, fault: Fault, at: Instant) {
        self.stop_stream();
        if let Some(bus) = &mut self.bus {
            bus.restart();
        }
        self.phase = Phase::Idle;
        self.tell(fault, at);
    }

    /// Reports a fault at the priority of the reports' reader; a full queue tells enough already.
    fn tell(&mut self, fault: Fault, at: Instant) {
        let _ = self.faults.push_back((at, fault));
        rtic::pend(READER);
    }

    fn stop_stream(&mut self) {
        // SAFETY: the data are given up.
        unsafe { self.stream.disable() };
        self.stream.clear_all_flags();
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

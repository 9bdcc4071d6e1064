//! Chip models on wires: buses that take time, interrupt lines that are watched.
//!
//! The drivers see embedded-hal buses; behind them is the very model that the emulated board
//! hangs on its buses, given the same bytes at nearly the same instants. A transfer is played in
//! one go, so the time of a bus may run ahead of the board's by the length of a transfer.

use std::cell::{Cell, RefCell};
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{self, ErrorKind, I2c, NoAcknowledgeSource};
use embedded_hal::spi::{self, SpiDevice};

use crate::faults::Fault;
use chip_models::{Chip, I2cChip, Mpu6050, OwnClock, SpiChip};

/// A byte on SPI at 5.25 MHz, with the instructions around it, ns.
const SPI_BYTE_NS: u64 = 1_600;
/// Selecting and deselecting a chip, ns.
const SPI_SELECT_NS: u64 = 1_000;
/// Eight bits and their acknowledgement on I2C at 400 kHz, ns.
const I2C_BYTE_NS: u64 = 22_500;
/// START, repeated START or STOP, ns.
const I2C_CONDITION_NS: u64 = 1_000;

/// A chip and its interrupt line.
pub(crate) struct Wired<C> {
    pub(crate) chip: C,
    level: bool,
    /// A rising edge that nobody heard yet.
    risen_ns: Option<u64>,
    /// Every rising edge so far, ns.
    pub(crate) rises: Vec<u64>,
}

impl<C: Chip> Wired<C> {
    fn look(&mut self, now_ns: u64) {
        let before = std::mem::replace(&mut self.level, self.chip.interrupt());
        if self.level && !before {
            self.rises.push(now_ns);
            self.risen_ns.get_or_insert(now_ns);
        }
    }
}

/// A chip that its bus and its board share.
pub(crate) struct Wire<C>(Rc<RefCell<Wired<C>>>);

impl<C> Clone for Wire<C> {
    fn clone(&self) -> Self {
        Self(Rc::clone(&self.0))
    }
}

impl<C: Chip> Wire<C> {
    pub(super) fn new(chip: C) -> Self {
        let wired = Wired {
            chip,
            level: false,
            risen_ns: None,
            rises: Vec::new(),
        };
        Self(Rc::new(RefCell::new(wired)))
    }

    /// Works on the chip and its line; not to be called from within itself.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut Wired<C>) -> T) -> T {
        work(&mut self.0.borrow_mut())
    }

    /// Lets time pass until `now_ns`; the rising edge that was not heard yet, if there is one.
    pub(super) fn hear(&self, now_ns: u64) -> Option<u64> {
        self.with(|wired| {
            wired.chip.advance(now_ns);
            wired.look(now_ns);
            wired.risen_ns.take_if(|at| *at <= now_ns)
        })
    }

    /// When [`Self::hear`] is worth a call next.
    pub(super) fn next_ns(&self) -> u64 {
        self.with(|wired| wired.risen_ns.unwrap_or_else(|| wired.chip.next_event()))
    }
}

/// The time of a bus, ns: its transfers push it on.
#[derive(Clone, Default)]
pub(super) struct BusTime(Rc<Cell<Times>>);

#[derive(Clone, Copy, Default)]
struct Times {
    now_ns: u64,
    /// When it was last put to use, and for how long it was at most.
    begun_ns: u64,
    longest_ns: u64,
}

impl BusTime {
    pub(super) fn now_ns(&self) -> u64 {
        self.0.get().now_ns
    }

    /// The bus is used next at this instant.
    pub(super) fn set_ns(&self, now_ns: u64) {
        let times = self.0.get();
        self.0.set(Times {
            now_ns,
            begun_ns: now_ns,
            ..times
        });
    }

    /// The longest time that a task kept it.
    pub(super) fn longest_ns(&self) -> u64 {
        self.0.get().longest_ns
    }

    /// What came before counts no more.
    pub(super) fn forget_longest(&self) {
        let times = self.0.get();
        self.0.set(Times {
            longest_ns: 0,
            ..times
        });
    }

    fn pass(&self, length_ns: u64) -> u64 {
        let mut times = self.0.get();
        times.now_ns += length_ns;
        times.longest_ns = times.longest_ns.max(times.now_ns - times.begun_ns);
        self.0.set(times);
        times.now_ns
    }
}

/// A delay is time in which the bus is not used.
impl DelayNs for BusTime {
    fn delay_ns(&mut self, length_ns: u32) {
        self.pass(u64::from(length_ns));
    }
}

/// A die with a clock of its own, on its wires.
pub(crate) type DieWire = Wire<Box<dyn OwnClock>>;

/// A die behind its chip select.
pub(super) struct Spi {
    pub(super) wire: DieWire,
    pub(super) time: BusTime,
}

impl spi::ErrorType for Spi {
    type Error = Infallible;
}

impl Spi {
    fn byte(&self, wired: &mut Wired<Box<dyn OwnClock>>, mosi: u8) -> u8 {
        let now_ns = self.time.pass(SPI_BYTE_NS);
        let miso = wired.chip.transfer(now_ns, mosi);
        wired.look(now_ns);
        miso
    }

    fn operate(
        &self,
        wired: &mut Wired<Box<dyn OwnClock>>,
        operation: &mut spi::Operation<'_, u8>,
    ) {
        match operation {
            spi::Operation::Read(bytes) => {
                for byte in bytes.iter_mut() {
                    *byte = self.byte(wired, 0);
                }
            }
            spi::Operation::Write(bytes) => {
                for byte in bytes.iter() {
                    self.byte(wired, *byte);
                }
            }
            spi::Operation::Transfer(into, from) => {
                for place in 0..into.len().max(from.len()) {
                    let miso = self.byte(wired, from.get(place).copied().unwrap_or(0));
                    if let Some(byte) = into.get_mut(place) {
                        *byte = miso;
                    }
                }
            }
            spi::Operation::TransferInPlace(bytes) => {
                for byte in bytes.iter_mut() {
                    *byte = self.byte(wired, *byte);
                }
            }
            spi::Operation::DelayNs(length_ns) => {
                self.time.pass(u64::from(*length_ns));
            }
        }
    }
}

impl SpiDevice for Spi {
    fn transaction(&mut self, operations: &mut [spi::Operation<'_, u8>]) -> Result<(), Infallible> {
        self.wire.with(|wired| {
            wired.chip.select(self.time.pass(SPI_SELECT_NS));
            for operation in operations {
                self.operate(wired, operation);
            }
            let now_ns = self.time.pass(SPI_SELECT_NS);
            wired.chip.deselect(now_ns);
            wired.look(now_ns);
        });
        Ok(())
    }
}

/// The I2C bus with the one chip on it.
pub(super) struct I2cBus {
    pub(super) wire: Wire<Mpu6050>,
    pub(super) time: BusTime,
    /// While one of them holds nobody acknowledges.
    pub(super) silences: Vec<Fault>,
}

impl i2c::ErrorType for I2cBus {
    type Error = ErrorKind;
}

impl I2cBus {
    fn operate(
        &self,
        wired: &mut Wired<Mpu6050>,
        address: u8,
        operation: &mut i2c::Operation<'_>,
    ) -> bool {
        let read = matches!(operation, i2c::Operation::Read(_));
        let started_ns = self.time.pass(I2C_CONDITION_NS);
        if self.silences.iter().any(|fault| fault.holds(started_ns))
            || !wired.chip.start(started_ns, address, read)
        {
            return false;
        }
        self.time.pass(I2C_BYTE_NS);
        match operation {
            i2c::Operation::Read(bytes) => {
                let count = bytes.len();
                for (place, byte) in bytes.iter_mut().enumerate() {
                    let now_ns = self.time.pass(I2C_BYTE_NS);
                    *byte = wired.chip.read(now_ns, place + 1 == count);
                    // A pulse of the pin is two bytes long: it must not be missed.
                    wired.look(now_ns);
                }
                true
            }
            i2c::Operation::Write(bytes) => bytes.iter().all(|byte| {
                let now_ns = self.time.pass(I2C_BYTE_NS);
                let taken = wired.chip.write(now_ns, *byte);
                wired.look(now_ns);
                taken
            }),
        }
    }
}

impl I2c for I2cBus {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [i2c::Operation<'_>],
    ) -> Result<(), ErrorKind> {
        self.wire.with(|wired| {
            let done = operations
                .iter_mut()
                .all(|operation| self.operate(wired, address, operation));
            let now_ns = self.time.pass(I2C_CONDITION_NS);
            wired.chip.stop(now_ns);
            wired.look(now_ns);
            if done {
                Ok(())
            } else {
                Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown))
            }
        })
    }
}

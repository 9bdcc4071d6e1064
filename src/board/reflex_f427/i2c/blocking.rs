//! Start-up and repair: transfers that poll, each wait bounded.
//!
//! The order of flags is RM0090, 27.3.3: the last bytes of a read must be told from the others
//! before they arrive, by how many are left.

use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use stm32f4xx_hal::pac::i2c1::sr1;

use super::Bus;

/// Counts of `asm::delay` between two looks: two or three cycles each.
const PAUSE: u32 = 100;
/// Looks before a wait is given up: 120 us at least, five bytes' time.
const MOST_LOOKS: u32 = 100;

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum BusError {
    /// Nobody answered to the address or took the byte.
    NoAcknowledge,
    /// Another master won, or a line is held.
    ArbitrationLost,
    /// A flag did not come in time: the bus hangs.
    Timeout,
}

impl Error for BusError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoAcknowledge => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown),
            Self::ArbitrationLost => ErrorKind::ArbitrationLoss,
            Self::Timeout => ErrorKind::Other,
        }
    }
}

impl ErrorType for Bus {
    type Error = BusError;
}

impl I2c for Bus {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), BusError> {
        let result = self.run(address, operations);
        if result.is_err() {
            // A chip left in the middle of a transfer waits for clocks and a STOP. The peripheral
            // cannot give them: a request may be pending, which forbids another (RM0090, 27.6.1).
            self.restart();
            self.revive();
        }
        result
    }
}

impl Bus {
    /// Every operation is a segment of its own, with a repeated START before all but the first.
    ///
    /// The traits would have neighbours of one kind joined; none of the drivers has such.
    fn run(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        self.until_free()?;
        let count = operations.len();
        let mut started = false;
        for (place, operation) in operations.iter_mut().enumerate() {
            let last = place + 1 == count;
            match operation {
                Operation::Write(bytes) => self.write_segment(address, bytes, started, last)?,
                Operation::Read(bytes) => self.read_segment(address, bytes, started, last)?,
            }
            started = !last && matches!(operation, Operation::Read(_));
        }
        Ok(())
    }

    fn until_free(&mut self) -> Result<(), BusError> {
        for _ in 0..MOST_LOOKS {
            if !self.is_busy() {
                return Ok(());
            }
            cortex_m::asm::delay(PAUSE);
        }
        Err(BusError::Timeout)
    }

    fn until(&mut self, flag: impl Fn(&sr1::R) -> bool) -> Result<(), BusError> {
        for _ in 0..MOST_LOOKS {
            let status = self.i2c.sr1().read();
            if status.af().bit_is_set() {
                return Err(BusError::NoAcknowledge);
            }
            if status.berr().bit_is_set() {
                // Spurious in a master, whose transfer goes on (ES0206, 2.10.1).
                self.clear_errors();
            }
            if status.arlo().bit_is_set() {
                return Err(BusError::ArbitrationLost);
            }
            if flag(&status) {
                return Ok(());
            }
            cortex_m::asm::delay(PAUSE);
        }
        Err(BusError::Timeout)
    }

    /// START and the address byte, up to the flag that stretches the clock until it is cleared.
    ///
    /// `started`: the segment before, a read, has requested the START already.
    fn address(&mut self, byte: u8, started: bool) -> Result<(), BusError> {
        if !started {
            self.i2c
                .cr1()
                .write(|w| w.pe().set_bit().ack().set_bit().start().set_bit());
        }
        self.until(|status| status.sb().bit_is_set())?;
        self.i2c.cr1().write(|w| w.pe().set_bit().ack().set_bit());
        self.i2c.dr().write(|w| w.dr().set(byte));
        self.until(|status| status.addr().bit_is_set())
    }

    fn write_segment(
        &mut self,
        address: u8,
        bytes: &[u8],
        started: bool,
        last: bool,
    ) -> Result<(), BusError> {
        self.address(address << 1, started)?;
        self.i2c.sr2().read();
        for byte in bytes {
            self.until(|status| status.tx_e().bit_is_set())?;
            self.i2c.dr().write(|w| w.dr().set(*byte));
        }
        if !bytes.is_empty() {
            self.until(|status| status.btf().bit_is_set())?;
        }
        if last {
            self.i2c.cr1().write(|w| w.pe().set_bit().stop().set_bit());
        }
        Ok(())
    }

    fn read_segment(
        &mut self,
        address: u8,
        bytes: &mut [u8],
        started: bool,
        last: bool,
    ) -> Result<(), BusError> {
        self.address(address << 1 | 1, started)?;
        match bytes {
            [] => {
                self.i2c.sr2().read();
                self.finish(last);
            }
            [only] => {
                self.i2c.cr1().write(|w| w.pe().set_bit());
                // Between the two the byte must not come to its end.
                cortex_m::interrupt::free(|_| {
                    self.i2c.sr2().read();
                    self.finish(last);
                });
                *only = self.receive()?;
            }
            [first, second] => {
                self.i2c.cr1().write(|w| w.pe().set_bit().pos().set_bit());
                self.i2c.sr2().read();
                self.until(|status| status.btf().bit_is_set())?;
                self.finish(last);
                *first = self.receive()?;
                *second = self.receive()?;
            }
            [most @ .., third, second, first] => {
                self.i2c.sr2().read();
                for byte in most {
                    *byte = self.receive()?;
                }
                // Two bytes wait and stretch the clock: time enough to refuse the next.
                self.until(|status| status.btf().bit_is_set())?;
                self.i2c.cr1().write(|w| w.pe().set_bit());
                *third = self.receive()?;
                self.until(|status| status.btf().bit_is_set())?;
                self.finish(last);
                *second = self.receive()?;
                *first = self.receive()?;
            }
        }
        Ok(())
    }

    /// STOP after the last segment; the START of the next one follows by itself.
    fn finish(&mut self, last: bool) {
        if last {
            self.i2c.cr1().write(|w| w.pe().set_bit().stop().set_bit());
        } else {
            self.i2c.cr1().write(|w| w.pe().set_bit().start().set_bit());
        }
    }

    fn receive(&mut self) -> Result<u8, BusError> {
        self.until(|status| status.rx_ne().bit_is_set())?;
        Ok(self.i2c.dr().read().dr().bits())
    }
}

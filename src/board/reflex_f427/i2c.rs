//! I2C1 at 400 kHz, with a bound on every wait.
//!
//! The abstraction layer's own I2C waits for flags without a bound, which a hung bus turns into a
//! hung drone. Here the bus has two users, one at a time:
//!
//! - [`Engine`]: bursts of the MPU6050, moved by interrupts and DMA; no instruction waits.
//! - [`Bus`] as an embedded-hal `I2c`: start-up and repair, polled with a bound, while the engine
//!   has lent it.

mod blocking;
mod engine;

use reflex_drivers::Error;
use reflex_drivers::bus_recovery::{Recovery, recover};
use stm32f4xx_hal::gpio::{Alternate, OpenDrain, PB8, PB9, PinState};
use stm32f4xx_hal::{pac, rcc, rcc::Enable, rcc::Reset};

use crate::board::clock::Delay;

pub use blocking::BusError;
pub use engine::{Buffer, Engine};

/// APB1 clock in MHz, which the peripheral wants to know.
const PCLK_MHZ: u8 = 42;
/// 42 MHz / (3 * 35) = 400 kHz, low twice as long as high.
const CLOCK_DIVIDER: u16 = 35;
/// Longest rise time, 300 ns, in periods of the APB1 clock, plus one.
const RISE_TIME: u8 = 13;

/// The result of a chip's repair.
pub type Repaired = Result<(), Error<BusError>>;

/// The peripheral with its two pins.
pub struct Bus {
    i2c: pac::I2C1,
    scl: PB8<Alternate<4, OpenDrain>>,
    sda: PB9<Alternate<4, OpenDrain>>,
}

impl Bus {
    /// Clocks and configures the peripheral.
    pub fn new(
        i2c: pac::I2C1,
        scl: PB8<Alternate<4, OpenDrain>>,
        sda: PB9<Alternate<4, OpenDrain>>,
        rcc: &mut rcc::Rcc,
    ) -> Self {
        pac::I2C1::enable(rcc);
        pac::I2C1::reset(rcc);
        let mut bus = Self { i2c, scl, sda };
        bus.restart();
        bus
    }

    /// Resets the peripheral's logic, whatever state it is in, and configures it again.
    ///
    /// The only way out of a transfer that the bus does not end (RM0090, 27.6.1, SWRST).
    fn restart(&mut self) {
        self.i2c.cr1().write(|w| w.swrst().set_bit());
        self.i2c.cr1().reset();
        // SAFETY: 42 MHz is APB1's clock and within the field's 2 to 50.
        self.i2c.cr2().write(|w| unsafe { w.freq().bits(PCLK_MHZ) });
        // SAFETY: any divider of at least 4 is allowed without DUTY.
        self.i2c
            .ccr()
            .write(|w| unsafe { w.f_s().fast().ccr().bits(CLOCK_DIVIDER) });
        self.i2c.trise().write(|w| w.trise().set(RISE_TIME));
        self.i2c.cr1().write(|w| w.pe().set_bit());
    }

    /// Clears every error flag: each by a zero, which changes no other flag.
    fn clear_errors(&mut self) {
        self.i2c.sr1().reset();
    }

    /// True while a line is low or a transfer is under way.
    fn is_busy(&self) -> bool {
        self.i2c.sr2().read().busy().bit_is_set()
    }

    /// True while somebody else holds SDA, in a pause of a transfer or without one.
    fn is_data_held(&self) -> bool {
        self.sda.is_low()
    }

    /// True while somebody holds a line though the peripheral does not.
    fn is_held(&self) -> bool {
        const BOTH: u32 = 1 << 8 | 1 << 9;
        // SAFETY: reading changes nothing; both at once, as every burst asks.
        let pins = unsafe { (*pac::GPIOB::ptr()).idr().read().bits() };
        pins & BOTH != BOTH
    }

    /// Resets the peripheral and clocks the bus free, by what the pins read: BUSY may lag.
    ///
    /// Takes up to 200 us, 25 where nobody holds a line: a chip in the middle of sending ones looks
    /// idle, so one clock with its STOP is always sent.
    pub fn revive(&mut self) -> Recovery {
        let Self { scl, sda, .. } = self;
        let recovery = scl.with_open_drain_output_in_state(PinState::High, |scl| {
            sda.with_open_drain_output_in_state(PinState::High, |sda| recover(scl, sda, &mut Delay))
        });
        self.restart();
        match recovery {
            Ok(recovery) => recovery,
            Err(never) => match never {},
        }
    }
}

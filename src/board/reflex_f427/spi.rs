//! SPI1, full duplex, with a bound on every wait.
//!
//! A byte takes 1.52 us at 5.25 MHz, in which the core sleeps: its interrupt is not enabled, but as
//! it becomes pending the sleep ends (SEVONPEND). So it does by any other: by every sample, by the
//! failsafe ten times a second.

use cortex_m::peripheral::{NVIC, SCB};
use cortex_m::register::primask;
use embedded_hal::spi::{ErrorKind, ErrorType, SpiBus};
use stm32f4xx_hal::gpio::{Speed, gpioa};
use stm32f4xx_hal::pac::{self, Interrupt};
use stm32f4xx_hal::{rcc, rcc::Enable, rcc::Reset};

/// Counts of `asm::delay` until a byte should be there, before interrupts run: 256 cycles.
const BYTE: u32 = 120;
/// SEVONPEND of the system control register (PM0214, 4.4.6).
const EVENT_ON_PENDING: u32 = 1 << 4;
/// Looks at the status register before a byte counts as lost.
const MOST_LOOKS: u32 = 32;

/// The bus; chip selects belong to its devices.
#[derive(Debug)]
pub struct Spi1(pac::SPI1);

/// A byte did not come back within [`MOST_LOOKS`]: the peripheral is not clocked or broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub struct Timeout;

impl embedded_hal::spi::Error for Timeout {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl Spi1 {
    /// Mode 3 at 84 MHz / 16 = 5.25 MHz, 8 bits, most significant bit first.
    pub fn new(
        spi: pac::SPI1,
        (sck, miso, mosi): (gpioa::PA5, gpioa::PA6, gpioa::PA7),
        rcc: &mut rcc::Rcc,
        scb: &mut SCB,
    ) -> Self {
        // Slower edges of SCK corrupt the last bit that is received (ES0206, 2.12.4).
        sck.into_alternate::<5>().speed(Speed::VeryHigh);
        miso.into_alternate::<5>().speed(Speed::VeryHigh);
        mosi.into_alternate::<5>().speed(Speed::VeryHigh);
        pac::SPI1::enable(rcc);
        pac::SPI1::reset(rcc);
        // SAFETY: no other bit changes, and nothing but this driver waits for events.
        unsafe { scb.scr.modify(|held| held | EVENT_ON_PENDING) };
        spi.cr2().write(|w| w.rxneie().not_masked());
        spi.cr1().write(|w| {
            w.cpol().idle_high();
            w.cpha().second_edge();
            w.mstr().master();
            w.br().div16();
            // The chip selects are ordinary pins: the peripheral must believe its own is high.
            w.ssm().enabled();
            w.ssi().slave_not_selected();
            w.spe().enabled()
        });
        Self(spi)
    }

    fn exchange(&mut self, byte: u8) -> Result<u8, Timeout> {
        NVIC::unpend(Interrupt::SPI1);
        self.0.dr().write(|w| w.dr().set(u16::from(byte)));
        for _ in 0..MOST_LOOKS {
            if primask::read().is_active() {
                cortex_m::asm::wfe();
            } else {
                cortex_m::asm::delay(BYTE);
            }
            if self.0.sr().read().rxne().bit_is_set() {
                return Ok(self.0.dr().read().dr().bits() as u8);
            }
        }
        Err(Timeout)
    }
}

impl ErrorType for Spi1 {
    type Error = Timeout;
}

impl SpiBus for Spi1 {
    fn read(&mut self, words: &mut [u8]) -> Result<(), Timeout> {
        for word in words {
            *word = self.exchange(0)?;
        }
        Ok(())
    }

    fn write(&mut self, words: &[u8]) -> Result<(), Timeout> {
        words
            .iter()
            .try_for_each(|&word| self.exchange(word).map(|_| ()))
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Timeout> {
        for place in 0..read.len().max(write.len()) {
            let received = self.exchange(write.get(place).copied().unwrap_or(0))?;
            if let Some(word) = read.get_mut(place) {
                *word = received;
            }
        }
        Ok(())
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Timeout> {
        for word in words {
            *word = self.exchange(*word)?;
        }
        Ok(())
    }

    /// Every byte was waited for: nothing is left on its way.
    fn flush(&mut self) -> Result<(), Timeout> {
        Ok(())
    }
}

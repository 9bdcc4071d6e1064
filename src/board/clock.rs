//! Clocks, the 1 us monotonic, and the only place that reads it.
//!
//! 168 MHz from the board's crystal: APB1 42 MHz (its timers 84 MHz), APB2 84 MHz. The monotonic
//! is TIM5 at 1 MHz, extended to 64 bit by its overflow interrupts.
//!
//! It is the HAL's, not rtic-monotonics'. Measured on the emulated chip, each with its newest
//! release: 527 against 806 instructions a wake, 18 against 51 a reading, 2160 bytes less RAM, no
//! second register crate and no second fugit. And rtic-monotonics 3.0.0 can hang: its period
//! counter is a spin lock on this core, which a handler above TIM5 that reads the clock, as the
//! sensors' do, waits for in vain in a window of 95 ns once every 36 minutes.

use embedded_hal::delay::DelayNs;
use reflex::time::Instant;
use rtic_time::Monotonic;
use stm32f4xx_hal::time::Hertz;
use stm32f4xx_hal::{pac, prelude::*, rcc};

/// The monotonic that tasks sleep on.
pub type Mono = stm32f4xx_hal::timer::MonoTimerUs<pac::TIM5>;

/// Core clock in MHz.
const CORE_MHZ: u32 = 168;

/// Starts the crystal and the PLL; hangs without a crystal, long before anything can fly.
pub fn start(rcc: pac::RCC, crystal: Hertz) -> rcc::Rcc {
    let config = rcc::Config::hse(crystal)
        .sysclk(CORE_MHZ.MHz())
        .hclk(CORE_MHZ.MHz())
        .pclk1(42.MHz())
        .pclk2(84.MHz());
    let rcc = rcc.freeze(config);
    // Should the crystal stop, NMI comes, and the processor's own oscillator goes on.
    rcc.cr().modify(|_, w| w.csson().set_bit());
    rcc
}

/// True where the clock security system found that the crystal stopped.
pub fn lost_crystal() -> bool {
    // SAFETY: reads a register, which changes nothing.
    let rcc = unsafe { &*pac::RCC::PTR };
    rcc.cir().read().cssf().bit()
}

/// The present time.
#[must_use]
pub fn now() -> Instant {
    Mono::now()
}

defmt::timestamp!("{=u64:us}", now().ticks());

/// Waits by counted instructions, paced by the monotonic.
///
/// Reading a timer costs a bus access, so it is read only a few times per wait; a clock that
/// stands still cannot hold it up for ever.
#[derive(Debug)]
pub struct Delay;

impl Delay {
    /// Counts per microsecond of `asm::delay`, which takes three cycles per count at most.
    const COUNTS_PER_US: u32 = CORE_MHZ / 3;

    /// Each look at the clock leaves at most a third of the wait: enough for 4000 s.
    const MOST_LOOKS: u32 = 24;
}

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        let until = now().ticks() + u64::from(ns.div_ceil(1000)) + 1;
        for _ in 0..Self::MOST_LOOKS {
            let left = until.saturating_sub(now().ticks()) as u32;
            if left == 0 {
                return;
            }
            cortex_m::asm::delay(left.saturating_mul(Self::COUNTS_PER_US));
        }
    }
}

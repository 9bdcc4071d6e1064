//! Clocks, the 1 us monotonic, and the only place that reads it.
//!
//! 168 MHz from the board's crystal: APB1 42 MHz (its timers 84 MHz), APB2 84 MHz. The monotonic
//! is TIM5 at 1 MHz, extended to 64 bit by its overflow interrupts.
//!
//! It is rtic-monotonics', with one word of care. The counter of its half periods has 64 bit, which
//! portable-atomic makes a spin lock on this core: a handler above TIM5 that reads the clock while
//! the counter is written waits for ever, in a window of 95 ns once in 36 minutes. Tried on the
//! emulated timer, with readers above and below, at 400 phases 12 ns apart around boundaries: it
//! hangs at phase 69. The feature `critical-section` changes nothing on a core that can compare and
//! swap; `unsafe-assume-single-core` masks interrupts instead, passes all phases without a hang or a
//! step back, and saves the 2 KiB of the locks.

use embedded_hal::delay::DelayNs;
use reflex::time::{Duration, Instant, at_micros};
use rtic_monotonics::{Timebase, stm32::Priority};
use stm32f4xx_hal::time::Hertz;
use stm32f4xx_hal::{pac, prelude::*, rcc};

rtic_monotonics::stm32_tim5_monotonic!(Timer, 1_000_000);

type Wake = <Timer as Timebase>::Instant;
type Sleep = <Timer as Timebase>::Duration;

/// Core clock in MHz.
const CORE_MHZ: u32 = 168;
/// Clock of the timers of APB1 in Hz.
const TIMER_HZ: u32 = 84_000_000;

/// Starts the crystal, the PLL and the monotonic; hangs without a crystal, long before anything can fly.
pub fn start(rcc: pac::RCC, crystal: Hertz) -> rcc::Rcc {
    let config = rcc::Config::hse(crystal)
        .sysclk(CORE_MHZ.MHz())
        .hclk(CORE_MHZ.MHz())
        .pclk1(42.MHz())
        .pclk2(84.MHz());
    let rcc = rcc.freeze(config);
    // Should the crystal stop, NMI comes, and the processor's own oscillator goes on.
    rcc.cr().modify(|_, w| w.csson().set_bit());
    Timer::start(TIMER_HZ, Priority::rtic_default());
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
    at_micros(Timer::now().duration_since_epoch().as_micros())
}

/// Sleeps until an instant.
pub async fn sleep_until(at: Instant) {
    Timer::delay_until(Wake::from_ticks(at.ticks())).await;
}

/// Sleeps for a span.
pub async fn sleep(span: Duration) {
    Timer::delay(Sleep::from_ticks(span.ticks())).await;
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

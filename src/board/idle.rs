//! Idle's sleep: through all interrupts, until a task raises it.
//!
//! The core sleeps as it leaves the last handler (SLEEPONEXIT): interrupts that raise nothing
//! return to no instruction of idle.

use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;

/// SLEEPONEXIT of the system control register (PM0214, 4.4.6).
const SLEEP_ON_EXIT: u32 = 1 << 1;

static RAISED: AtomicBool = AtomicBool::new(true);

/// Has [`wait`] return, now or when it is called next.
pub fn raise() {
    RAISED.store(true, Ordering::Relaxed);
    // SAFETY: as in `wait`; handlers that interrupt one another here all write the same.
    unsafe { (*SCB::PTR).scr.modify(|held| held & !SLEEP_ON_EXIT) }
}

/// Sleeps until idle is raised, unless it was since the last call.
///
/// With interrupts masked none can come between the look and the sleep; one that is pending ends
/// the sleep all the same, and is served at once.
pub fn wait() {
    while !RAISED.swap(false, Ordering::Relaxed) {
        cortex_m::interrupt::free(|_| {
            if !RAISED.load(Ordering::Relaxed) {
                // SAFETY: only this module writes the register after the start, here with interrupts
                // masked.
                unsafe { (*SCB::PTR).scr.modify(|held| held | SLEEP_ON_EXIT) }
                cortex_m::asm::wfi();
            }
        });
    }
}

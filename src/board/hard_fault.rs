//! A HardFault says where it came from, then waits for the watchdog.
//!
//! Nothing else would tell it from a drone that fell silent. The motors keep their last command
//! until the watchdog resets the board, which is within 0.4 s, or 0.75 s where its oscillator is slow.

use core::ops::Range;

use cortex_m_rt::{ExceptionFrame, exception};

/// The flash, where instructions are.
const FLASH: Range<u32> = 0x0800_0000..0x0820_0000;

// SAFETY: the handler touches nothing that the interrupted code owns, and does not return to it.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // A panic ends in an undefined instruction, and has said why already.
    if !is_undefined_instruction(frame.pc()) {
        defmt::error!("hard fault at {=u32:#010x}", frame.pc());
    }
    loop {
        cortex_m::asm::wfi();
    }
}

fn is_undefined_instruction(at: u32) -> bool {
    if !at.is_multiple_of(2) || !FLASH.contains(&at) {
        return false;
    }
    // SAFETY: aligned, and within the flash, which is always readable.
    let instruction = unsafe { core::ptr::read_volatile(at as *const u16) };
    instruction & 0xFF00 == 0xDE00
}

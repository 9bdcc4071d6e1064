//! The end of the firmware: motors stop, then last words, then a reset.
//!
//! A HardFault, a panic, the crystal's loss (NMI) and an interrupt without a task all come here.
//! Nothing is formatted and no stack is trusted before the motors have their shortest pulse. They
//! keep it until the watchdog resets the board, after 0.27 to 0.75 s: that tells a speed controller
//! to stop, where a reset at once would cut a pulse and leave it with the last command until its
//! own timeout. During the reset the pins float; the pull-downs of the wiring keep them low.

use core::arch::{asm, naked_asm};
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicU32, Ordering};

use reflex::reset::{Ending, LastWords};

use super::{clock, last_words, motors};

/// Address of the place of a panic; 0 where there was none.
static PANICKED_AT: AtomicU32 = AtomicU32::new(0);

/// Numbers of the exceptions that end here by name.
const NMI: u32 = 2;
const HARD_FAULT: u32 = 3;
/// Where the number of the active exception is in a program status.
const EXCEPTION: u32 = 0x1FF;

/// What the processor stores on the stack when it takes an exception.
#[repr(C)]
struct Frame {
    registers: [u32; 5],
    link_register: u32,
    program_counter: u32,
    status: u32,
}

/// The vector of HardFault, entered without a stack that can be trusted.
///
/// Where less than 1 KiB of it is left it begins anew at its top, which nobody returns to.
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
#[unsafe(link_section = ".HardFault.reflex")]
unsafe extern "C" fn hard_fault() -> ! {
    naked_asm!(
        "mrs r0, msp",
        "ldr r1, =_stack_end + 1024",
        "cmp r0, r1",
        "bhs 0f",
        "ldr r1, =_stack_start",
        "msr msp, r1",
        "0:",
        "b {end}",
        end = sym end,
    )
}

/// The vector of NMI.
#[unsafe(naked)]
#[unsafe(export_name = "NonMaskableInt")]
unsafe extern "C" fn non_maskable() -> ! {
    naked_asm!("b {hard_fault}", hard_fault = sym hard_fault)
}

/// The vector of every interrupt without a task.
#[unsafe(naked)]
#[unsafe(export_name = "DefaultHandler")]
unsafe extern "C" fn unhandled() -> ! {
    naked_asm!("b {hard_fault}", hard_fault = sym hard_fault)
}

/// Goes the way of a HardFault, at once: what the message would say, its place says as well.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let place = info
        .location()
        .map_or(0, |place| core::ptr::from_ref(place) as u32);
    PANICKED_AT.store(place, Ordering::Relaxed);
    cortex_m::asm::udf()
}

/// The end; `stack` is where the processor stored a frame.
extern "C" fn end(stack: u32) -> ! {
    motors::stop();
    let handled = handled();
    if handled == NMI && clock::lost_crystal() {
        motors::stop_without_crystal();
    }
    let place = PANICKED_AT.load(Ordering::Relaxed);
    let frame = frame(stack);
    let ending = match handled {
        NMI => Ending::ClockLost,
        HARD_FAULT if place != 0 => Ending::Panic,
        HARD_FAULT if frame.is_none() => Ending::StackOverflow,
        HARD_FAULT => Ending::HardFault,
        _ => Ending::Unhandled,
    };
    let exception = match (ending, frame) {
        (Ending::Unhandled, _) => handled,
        (_, Some(frame)) => frame.status & EXCEPTION,
        (_, None) => handled,
    };
    let words = LastWords {
        ending,
        mode: last_words::mode(),
        exception: exception as u8,
        program_counter: frame.map_or(0, |frame| frame.program_counter),
        link_register: frame.map_or(0, |frame| frame.link_register),
        place,
    };
    last_words::leave(Some(&words));
    // The log last: should it be what failed, nothing is lost but this line.
    last_words::tell(&words);
    loop {
        cortex_m::asm::wfi();
    }
}

/// The exception that is being handled.
fn handled() -> u32 {
    let status: u32;
    // SAFETY: reads a register, and nothing else.
    unsafe { asm!("mrs {}, ipsr", out(reg) status, options(nomem, nostack, preserves_flags)) }
    status & EXCEPTION
}

/// The frame on the stack, where it fits there.
fn frame(stack: u32) -> Option<&'static Frame> {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    let (start, end) = (
        (&raw const _stack_end) as u32,
        (&raw const _stack_start) as u32,
    );
    let last = end - size_of::<Frame>() as u32;
    let fits = (start..=last).contains(&stack) && stack.is_multiple_of(4);
    // SAFETY: aligned and within the stack's memory, which is always readable; nobody writes it any
    // more, as the stack that this handler uses ends below the frame, or begins at the top.
    fits.then(|| unsafe { &*(stack as *const Frame) })
}

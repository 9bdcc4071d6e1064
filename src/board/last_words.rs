//! Last words: kept in memory that a reset leaves alone, told in the log.
//!
//! The symbol `REFLEX_LAST_WORDS` is read from outside as well.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::panic::Location;
use core::ptr;
use core::sync::atomic::{AtomicU8, Ordering};

use reflex::reset::{LastWords, Mode};
use stm32f4xx_hal::pac::Interrupt;

/// The flash, where a panic's place in the source is.
const FLASH: core::ops::Range<u32> = 0x0800_0000..0x0810_0000;
/// Number of the first exception that is an interrupt.
const FIRST_INTERRUPT: u8 = 16;
/// No source file has a longer name.
const LONGEST_NAME: u32 = 128;

#[repr(transparent)]
struct Storage(UnsafeCell<MaybeUninit<[u8; LastWords::LENGTH]>>);

// SAFETY: it is used by the start, before any task runs, and then by handlers that never return.
// The failsafe's task, the only one, writes it while it lets the watchdog end the firmware.
unsafe impl Sync for Storage {}

#[used]
#[unsafe(export_name = "REFLEX_LAST_WORDS")]
#[unsafe(link_section = ".uninit.REFLEX_LAST_WORDS")]
static WORDS: Storage = Storage(UnsafeCell::new(MaybeUninit::uninit()));

/// How the drone flies, by its number: in a fault nobody can be asked.
static MODE: AtomicU8 = AtomicU8::new(0);

/// Takes note of how the drone flies.
pub fn note(mode: Mode) {
    MODE.store(mode.number(), Ordering::Relaxed);
}

/// How the drone flew when it was noted last.
pub fn mode() -> Mode {
    Mode::from_number(MODE.load(Ordering::Relaxed)).unwrap_or(Mode::Ground)
}

/// Leaves words to the next start; none takes them back.
pub fn leave(words: Option<&LastWords>) {
    let bytes = words.map_or([0; LastWords::LENGTH], LastWords::to_bytes);
    // SAFETY: in bounds; volatile, because only the program after this one reads it.
    unsafe { ptr::write_volatile(WORDS.0.get().cast(), bytes) }
}

/// Takes the words that the program before this one left.
pub fn take() -> Option<LastWords> {
    // SAFETY: in bounds, and any bytes are a valid array; volatile, because the program before
    // this one wrote them.
    let bytes = unsafe { ptr::read_volatile(WORDS.0.get().cast()) };
    leave(None);
    LastWords::from_bytes(&bytes)
}

/// Tells words in the log.
pub fn tell(words: &LastWords) {
    let &LastWords {
        ending,
        mode,
        exception,
        program_counter: pc,
        link_register: lr,
        place,
    } = words;
    if let Some((file, line)) = source(place) {
        defmt::error!("panicked at {=str}:{=u32}", file, line);
    }
    defmt::error!(
        "ended by {} in {=istr} at {=u32:#010x} from {=u32:#010x}, {}",
        ending,
        task(exception),
        pc,
        lr,
        mode
    );
}

/// The task that is bound to an exception, as the table of `main.rs` has it.
fn task(exception: u8) -> defmt::Str {
    let tasks = [
        (Interrupt::EXTI0, defmt::intern!("imu_ready")),
        (Interrupt::EXTI1, defmt::intern!("accel_threshold")),
        (Interrupt::EXTI2, defmt::intern!("mag_event")),
        (Interrupt::I2C1_EV, defmt::intern!("imu_step")),
        (Interrupt::I2C1_ER, defmt::intern!("imu_failed")),
        (Interrupt::DMA1_STREAM0, defmt::intern!("imu_received")),
        (Interrupt::CAN2_TX, defmt::intern!("hyperperiod")),
        (Interrupt::CAN1_RX1, defmt::intern!("a task of priority 4")),
        (Interrupt::CAN2_RX0, defmt::intern!("chips")),
        (Interrupt::USART2, defmt::intern!("link_idle")),
        (Interrupt::DMA1_STREAM5, defmt::intern!("link_half")),
        (Interrupt::DMA1_STREAM6, defmt::intern!("link_sent")),
        (Interrupt::CAN1_RX0, defmt::intern!("a task of priority 2")),
        (Interrupt::CAN1_TX, defmt::intern!("repair_imu")),
        (Interrupt::TIM5, defmt::intern!("the monotonic")),
    ];
    let Some(vector) = exception.checked_sub(FIRST_INTERRUPT) else {
        return defmt::intern!("idle");
    };
    let found = tasks.iter().find(|(bound, _)| *bound as u8 == vector);
    found.map_or(defmt::intern!("no task"), |(_, name)| *name)
}

/// File and line of a panic.
fn source(place: u32) -> Option<(&'static str, u32)> {
    let length = size_of::<Location<'static>>() as u32;
    if !place.is_multiple_of(4) || !is_in_flash(place, length) {
        return None;
    }
    // SAFETY: aligned and within the flash. A panic left the address; should another firmware have
    // been flashed since, whose words are these, the name is looked at no further than this.
    let location = unsafe { &*(place as *const Location<'static>) };
    let file = location.file();
    let named =
        file.len() as u32 <= LONGEST_NAME && is_in_flash(file.as_ptr() as u32, LONGEST_NAME);
    named.then(|| (file, location.line()))
}

fn is_in_flash(start: u32, length: u32) -> bool {
    FLASH.contains(&start) && length <= FLASH.end - start
}

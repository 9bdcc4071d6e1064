//! The settings block's place in memory: the symbol `REFLEX_SETTINGS`.
//!
//! A host or a bootloader writes it before start; start-up code leaves `.uninit` alone.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use reflex::config::LIMITS;
use reflex::graph::{CONFIGURED, Flown, Tuned};
use reflex::settings::{BlockError, Start};

/// What a start is given: the gains are those of the control logic that is built in.
pub type Given = Start<<Flown as Tuned>::Gains>;

#[repr(transparent)]
struct Storage(UnsafeCell<MaybeUninit<[u8; Given::LENGTH]>>);

// SAFETY: the firmware only reads it, as volatile bytes.
unsafe impl Sync for Storage {}

#[used]
#[unsafe(export_name = "REFLEX_SETTINGS")]
#[unsafe(link_section = ".uninit.REFLEX_SETTINGS")]
static BLOCK: Storage = Storage(UnsafeCell::new(MaybeUninit::uninit()));

/// What the block gives, or the configuration where there is no valid block; says which in the log.
#[must_use]
pub fn read() -> Given {
    // SAFETY: aligned, in bounds, and any bytes are a valid array; volatile, because it was
    // written from outside the program.
    let bytes = unsafe { core::ptr::read_volatile(BLOCK.0.get().cast::<[u8; Given::LENGTH]>()) };
    match Start::from_bytes(&bytes, &LIMITS) {
        Ok(start) => {
            defmt::info!("settings: block {}", start.settings);
            start
        }
        Err(BlockError::Absent) => {
            defmt::info!("settings: defaults {}", CONFIGURED.settings);
            CONFIGURED
        }
        Err(error) => {
            defmt::warn!("settings: block refused ({}), defaults hold", error);
            CONFIGURED
        }
    }
}

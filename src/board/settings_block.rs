//! The settings block's place in memory: the symbol `REFLEX_SETTINGS`.
//!
//! A host or a bootloader writes it before start; start-up code leaves `.uninit` alone.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use reflex::config::{LIMITS, SETTINGS};
use reflex::settings::{BLOCK_LENGTH, BlockError, Settings};

#[repr(transparent)]
struct Storage(UnsafeCell<MaybeUninit<[u8; BLOCK_LENGTH]>>);

// SAFETY: the firmware only reads it, as volatile bytes.
unsafe impl Sync for Storage {}

#[used]
#[unsafe(export_name = "REFLEX_SETTINGS")]
#[unsafe(link_section = ".uninit.REFLEX_SETTINGS")]
static BLOCK: Storage = Storage(UnsafeCell::new(MaybeUninit::uninit()));

/// The block's settings, or the defaults where there is no valid block; says which in the log.
#[must_use]
pub fn read() -> Settings {
    // SAFETY: aligned, in bounds, and any bytes are a valid array; volatile, because it was
    // written from outside the program.
    let bytes = unsafe { core::ptr::read_volatile(BLOCK.0.get().cast::<[u8; BLOCK_LENGTH]>()) };
    match Settings::from_bytes(&bytes, &LIMITS) {
        Ok(settings) => {
            defmt::info!("settings: block {}", settings);
            settings
        }
        Err(BlockError::Absent) => {
            defmt::info!("settings: defaults {}", SETTINGS);
            SETTINGS
        }
        Err(error) => {
            defmt::warn!("settings: block refused ({}), defaults hold", error);
            SETTINGS
        }
    }
}

//! The settings block's place in memory: the symbol `REFLEX_SETTINGS`.
//!
//! A host or a bootloader writes it before start; start-up code leaves `.uninit` alone.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use reflex::config::LIMITS;
use reflex::graph::{CONFIGURED, Flown, Tuned};
use reflex::settings::{BlockError, Parameter, Start};
use reflex::store::Found;
use reflex::tasks::store::restored;

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

/// What the block gives, where there is a valid one; else the configuration with what is stored.
#[must_use]
pub fn in_force(stored: &[Parameter]) -> Given {
    read().unwrap_or_else(|_| restored(&CONFIGURED, stored, Found::Sound).0)
}

/// What a start is given; says in the log from where, and what that means for what the store held.
#[must_use]
pub fn choose(stored: &[Parameter], found: Found) -> (Given, Found) {
    let (mut start, found) = restored(&CONFIGURED, stored, found);
    match read() {
        Ok(given) => {
            defmt::info!("settings: block");
            start = given;
        }
        Err(BlockError::Absent) => {}
        Err(error) => defmt::warn!("settings: block refused ({})", error),
    }
    let count = stored.len();
    defmt::info!(
        "settings: {=usize} stored, {}; {}",
        count,
        found,
        start.settings
    );
    (start, found)
}

#[inline(never)]
fn read() -> Result<Given, BlockError> {
    let mut bytes = [0; Given::LENGTH];
    for (place, byte) in bytes.iter_mut().enumerate() {
        // SAFETY: in bounds, and any byte is valid; volatile, because it was written from outside the
        // program.
        *byte = unsafe { BLOCK.0.get().cast::<u8>().add(place).read_volatile() };
    }
    Start::from_bytes(&bytes, &LIMITS)
}

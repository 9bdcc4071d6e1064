//! The board: everything that knows the STM32F427, and the only `unsafe` code.
//!
//! A board is a folder of its name with its pins, crystal, buses and chips; `config/selection.toml`
//! chooses it. Its `start` brings the processor up and hands the board's parts to the tasks of
//! `main.rs`. The files here serve every board with an STM32F427.
//!
//! | file | for |
//! |---|---|
//! | `clock` | core clock, monotonic, delays |
//! | `lines` | external interrupts |
//! | `guarded` | RTIC's resources as the tasks' |
//! | `calls`, `settings_block` | symbols that a host reads and writes |
//! | `watchdog`, `hard_fault` | the last resort |

pub mod calls;
mod clock;
pub mod guarded;
mod hard_fault;
mod lines;
mod settings_block;
mod watchdog;

#[cfg(board = "reflex_f427")]
mod reflex_f427;
#[cfg(board = "reflex_f427")]
pub use reflex_f427::{ChipLine, Chips, Engine, ImuLine, Link, Motors, imu, start};

pub use clock::{Mono, now};
pub use settings_block::Given;

use core::sync::atomic::{AtomicBool, Ordering};

/// Sleeps until an interrupt, unless one has left work in the meantime.
///
/// With interrupts masked none can come between the look and the sleep; one that is pending ends
/// the sleep all the same, and is served at once.
pub fn sleep_unless(work: &AtomicBool) {
    cortex_m::interrupt::free(|_| {
        if !work.load(Ordering::Relaxed) {
            cortex_m::asm::wfi();
        }
    });
}

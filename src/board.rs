//! The board: everything that knows the STM32F427, and the only `unsafe` code.
//!
//! A board is a folder of its name with its pins, crystal, buses and chips; `config/selection.toml`
//! chooses it. Its `start` brings the processor up and hands the board's parts to the tasks of
//! `main.rs`. The files here serve every board with an STM32F427.
//!
//! | file | for |
//! |---|---|
//! | `clock` | core clock, monotonic, delays |
//! | `idle` | sleep between tasks |
//! | `lines` | external interrupts |
//! | `guarded` | RTIC's resources as the tasks' |
//! | `calls`, `settings_block` | symbols that a host reads and writes |
//! | `watchdog`, `fault` | the last resort |
//! | `last_words`, `reset` | what a start finds of the one before |

pub mod calls;
mod clock;
mod fault;
pub mod guarded;
pub mod idle;
mod last_words;
mod lines;
mod reset;
mod settings_block;
mod watchdog;

#[cfg(board = "reflex_f427")]
mod reflex_f427;
#[cfg(board = "reflex_f427")]
use reflex_f427::motors;
#[cfg(board = "reflex_f427")]
pub use reflex_f427::{
    Board as Started, ChipLine, Chips, Engine, Gauge, ImuLine, Link, Motors, imu, start,
};

pub use clock::{now, sleep, sleep_until};
pub use watchdog::{SIGNS, Watchdog};

/// Writes an event to the log: a run only where details are asked for.
pub fn log(event: &reflex::app::Event) {
    match event {
        reflex::app::Event::Ran { .. } => defmt::debug!("{}", event),
        _ => defmt::info!("{}", event),
    }
}

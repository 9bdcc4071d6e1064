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
//! | `keeper` | the store |
//! | `last_words`, `reset` | what a start finds of the one before |

pub mod calls;
mod clock;
mod fault;
pub mod guarded;
pub mod idle;
mod keeper;
mod last_words;
mod lines;
mod reset;
mod settings_block;
mod watchdog;

use reflex::app::Event;

#[cfg(board = "reflex_f427")]
mod reflex_f427;
#[cfg(board = "reflex_f427")]
use reflex_f427::motors;
#[cfg(board = "reflex_f427")]
pub use reflex_f427::{
    Board as Started, ChipLine, Chips, Engine, Gauge, ImuLine, Keeper, Link, Motors, imu, start,
};

pub use clock::{now, sleep, sleep_until};
pub use reflex::reset::Sign;
pub use watchdog::{SIGNS, Watchdog};

/// Events that are logged before idle looks for other work again.
const MOST_EVENTS: usize = 8;

/// Writes events to the log: runs only where details are asked for.
pub fn log(mut next: impl FnMut() -> Option<Event>) {
    for event in (0..MOST_EVENTS).map_while(|_| next()) {
        match event {
            Event::Ran { .. } => defmt::debug!("{}", event),
            _ => defmt::info!("{}", event),
        }
    }
}

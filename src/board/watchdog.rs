//! The independent watchdog: resets the board when the failsafe timer stops coming.
//!
//! It runs from its own oscillator, which is 17 to 47 kHz by the datasheet, so that a timeout of
//! 400 ms may be 272 ms: the timer task feeds it at least every [`LONGEST_SLEEP`].

use reflex::time::{Duration, micros};
use stm32f4xx_hal::{pac, prelude::*, watchdog::IndependentWatchdog};

/// The longest time between two feeds.
pub const LONGEST_SLEEP: Duration = micros(100_000);

/// Starts the watchdog, stopped while a debugger halts the core.
///
/// Its timeout holds from the first feed on; until then it counts from its maximum. A feed within
/// 500 us of the start would reload that maximum.
pub fn start(iwdg: pac::IWDG, debug: &pac::DBGMCU) -> IndependentWatchdog {
    let mut watchdog = IndependentWatchdog::new(iwdg);
    watchdog.stop_on_debug(debug, true);
    watchdog.start(400.millis());
    watchdog
}

//! The independent watchdog: resets the board when the failsafe timer stops coming.
//!
//! It runs from its own oscillator, which is 17 to 47 kHz by the datasheet, so that a timeout of
//! 400 ms may be 272 ms: the failsafe's task feeds it more often, at least every
//! [`reflex::tasks::control::LONGEST_SLEEP`].

use stm32f4xx_hal::{pac, prelude::*, watchdog::IndependentWatchdog};

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

//! What a start finds of the one before: cause of the reset, voltage, last words.

use reflex::reset::{Reset, ResetCause};
use stm32f4xx_hal::pac;

use super::last_words;

/// The brown-out level with which flash at this clock works down to the reset, in mV.
const WANTED_MV: u16 = 2_830;

/// Reads it, once: the next start finds its own.
pub fn take(rcc: &pac::RCC, flash: &pac::FLASH) -> Reset {
    let cause = cause(rcc);
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    Reset {
        cause,
        last_words: last_words::take(),
        brown_out_mv: brown_out_mv(flash),
    }
}

/// The flag that says most: any reset pulls the reset pin as well, and a rising supply passes the
/// brown-out level.
fn cause(rcc: &pac::RCC) -> ResetCause {
    let flags = rcc.csr().read();
    let flags = [
        (flags.lpwrrstf().bit(), ResetCause::Other),
        (flags.wwdgrstf().bit(), ResetCause::Other),
        (flags.wdgrstf().bit(), ResetCause::Watchdog),
        (flags.sftrstf().bit(), ResetCause::Software),
        (flags.porrstf().bit(), ResetCause::PowerOn),
        (flags.borrstf().bit(), ResetCause::BrownOut),
        (flags.padrstf().bit(), ResetCause::Pin),
    ];
    let found = flags.iter().find(|(is_set, _)| *is_set);
    found.map_or(ResetCause::Other, |(_, cause)| *cause)
}

/// The falling supply at which each level of the option bytes resets (DS9405, table 22), typically.
fn brown_out_mv(flash: &pac::FLASH) -> Option<u16> {
    match flash.optcr().read().bor_lev().bits() {
        0b00 => Some(WANTED_MV),
        0b01 => Some(2_500),
        0b10 => Some(2_190),
        _ => None,
    }
}

/// Tells it in the log.
pub fn tell(reset: &Reset) {
    match reset.is_unexpected() {
        true => defmt::error!("started by {}, which nobody asked for", reset.cause),
        false => defmt::info!("started by {}", reset.cause),
    }
    if let Some(words) = &reset.last_words {
        last_words::tell(words);
    }
    if reset.brown_out_mv != Some(WANTED_MV) {
        defmt::warn!(
            "brown-out reset at {} mV, not {=u16}: set the option bytes",
            reset.brown_out_mv,
            WANTED_MV
        );
    }
}

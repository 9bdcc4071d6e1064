//! The kinds of logs that can be read, each known by its content.
//!
//! A further kind is a file of this folder and a line of [`FORMATS`].

mod blackbox;
mod dataflash;
mod foreign;
mod text;
mod ulog;
mod usd;

use super::error::Fault;
use super::packed::unpacked;
use super::recording::Recording;
use super::skipped::Skipped;
use super::units::Units;

/// One kind of log.
struct Format {
    /// True for the content of such a log.
    knows: fn(&[u8]) -> bool,
    read: fn(&[u8], &Units) -> Result<Recording, Fault>,
}

/// Text comes last: it is what is left.
static FORMATS: [Format; 5] = [
    Format {
        knows: ulog::knows,
        read: |bytes, _| ulog::read(bytes),
    },
    Format {
        knows: blackbox::knows,
        read: |bytes, _| blackbox::read(bytes),
    },
    Format {
        knows: dataflash::knows,
        read: |bytes, _| dataflash::read(bytes),
    },
    Format {
        knows: usd::knows,
        read: |bytes, _| usd::read(bytes),
    },
    Format {
        knows: text::knows,
        read: text::read,
    },
];

/// Reads a log of any kind; `units` are those of text, where they are told.
///
/// # Errors
/// What the file is, if it is no log; what the log lacks; where it cannot be read.
pub(super) fn read(bytes: &[u8], units: &Units) -> Result<Recording, Fault> {
    let mut skipped = Skipped::default();
    let bytes = unpacked(bytes, &mut skipped)?;
    if bytes.is_empty() {
        return Err(Fault::whole("is empty"));
    }
    if let Some(reason) = foreign::named(&bytes) {
        return Err(Fault::whole(reason));
    }
    let format = FORMATS.iter().find(|format| (format.knows)(&bytes));
    let format = format.ok_or_else(|| {
        Fault::whole(
            "is no log that is known: replays read ULog (PX4), Blackbox (Betaflight, INAV), \
             DataFlash (ArduPilot .bin), Crazyflie uSD and CSV, each also as .gz",
        )
    })?;
    let mut recording = (format.read)(&bytes, units)?;
    skipped.append(recording.skipped);
    recording.skipped = skipped;
    Ok(recording.of_numbers())
}

//! `boards/*.toml`: what may vary on one wiring.

use reflex_settings::{BOARD, Declared, Settings, rates};

use crate::document::Document;
use crate::error::ConfigError;
use crate::values::{Schema, Values, schema};

/// Voltages of a cell, each below the one before.
const FALLING_VOLTS: [&str; 3] = ["low_v", "critical_v", "collapsed_v"];

/// What a file of `boards/` holds.
pub(crate) fn file() -> Schema {
    let chosen = Settings::SETTINGS.iter().filter(|setting| setting.of_board);
    schema(rates().chain(BOARD).chain(chosen))
}

/// What only several values together can show.
pub(crate) fn check(document: &Document, values: &Values) -> Result<(), ConfigError> {
    let key = |name: &str| format!("battery.{name}");
    for pair in FALLING_VOLTS.windows(2) {
        let [above, below] = [pair[0], pair[1]].map(|name| values.number(&key(name)));
        if below >= above {
            let message = format!(
                "{below} is out of range, must be below {}, {above} V",
                pair[0]
            );
            return Err(document.error_at(&key(pair[1]), message));
        }
    }
    Ok(())
}

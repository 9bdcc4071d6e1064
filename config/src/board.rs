//! `boards/*.toml`: what may vary on one wiring.

use reflex_settings::{BOARD, Declared, Settings, rates};

use crate::values::{Schema, schema};

/// What a file of `boards/` holds.
pub(crate) fn file() -> Schema {
    let chosen = Settings::SETTINGS.iter().filter(|setting| setting.of_board);
    schema(rates().chain(BOARD).chain(chosen))
}

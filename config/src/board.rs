//! `boards/*.toml`: what may vary on one wiring.

use reflex_settings::{BOARD, Declared, Settings, rates};

use crate::document::Document;
use crate::error::ConfigError;
use crate::values::{Schema, Values, schema};

/// What a file of `boards/` holds.
pub(crate) fn file() -> Schema {
    let chosen = Settings::SETTINGS.iter().filter(|setting| setting.of_board);
    schema(rates().chain(BOARD).chain(chosen))
}

/// What only several values together can show: a battery is low before it is nearly empty, nearly empty
/// before it has collapsed, and measured until then.
pub(crate) fn check(values: &Values, document: &Document) -> Result<(), ConfigError> {
    document.check_below(values, ["battery.critical_v", "battery.low_v"])?;
    document.check_below(values, ["battery.collapsed_v", "battery.critical_v"])?;
    let cells = values.number("battery.cells");
    let empty = cells * values.number("battery.critical_v");
    if cells > 0.0 && values.number("battery.least_v") >= empty {
        let message = format!("must be below critical_v of all cells, {empty} V");
        return Err(document.error_at("battery.least_v", message));
    }
    Ok(())
}

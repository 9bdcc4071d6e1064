//! `safety.toml`: when motors may turn, and what ends a flight.

use reflex_settings::SAFETY;

use crate::ConfigError;
use crate::document::Document;
use crate::values::{Schema, Values, schema};

/// What `safety.toml` holds.
pub(crate) fn file() -> Schema {
    schema(SAFETY)
}

/// What only several values together can show: the thrust of an armed drone on the ground, of one
/// that may be in the air, and of one that climbs.
pub(crate) fn check(values: &Values, document: &Document) -> Result<(), ConfigError> {
    document.check_below(values, ["arming.most_thrust", "ground.idle_thrust"])?;
    document.check_below(values, ["ground.idle_thrust", "ground.lifting_thrust"])
}

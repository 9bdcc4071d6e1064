//! `safety.toml`: when motors may turn, and what ends a flight.

use reflex_settings::SAFETY;

use crate::values::{Schema, schema};

/// What `safety.toml` holds.
pub(crate) fn file() -> Schema {
    schema(SAFETY)
}

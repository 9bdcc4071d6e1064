//! `budget.toml`: what the firmware may take.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

use crate::profile::{PARTS, REST};
use crate::toolchain;

/// The content of `budget.toml`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Most bytes of flash.
    pub flash_bytes: u64,
    /// Most bytes of RAM, the deepest stack among them.
    pub ram_and_stack_bytes: u64,
    /// Most instructions of parts of the firmware in a hover, per sample of the inertial sensor.
    pub hover_instructions_per_sample: BTreeMap<String, u64>,
}

impl Budget {
    /// Reads the file.
    ///
    /// # Errors
    /// There is something wrong in it.
    pub fn read() -> Result<Self> {
        let file = toolchain::root().join("hil-tests/budget.toml");
        let text = std::fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        Self::parse(&text).with_context(|| file.display().to_string())
    }

    fn parse(text: &str) -> Result<Self> {
        let budget: Self = toml::from_str(text)?;
        let known = || PARTS.iter().map(|part| part.name).chain([REST, ALL]);
        let limits = &budget.hover_instructions_per_sample;
        match limits
            .keys()
            .find(|name| known().all(|known| known != *name))
        {
            None => Ok(budget),
            Some(name) => bail!(
                "hover_instructions_per_sample: no part is named `{name}`, must be one of: {}",
                known().collect::<Vec<_>>().join(", ")
            ),
        }
    }
}

/// The row of all parts together.
pub(super) const ALL: &str = "all";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_of_no_part_is_refused() {
        let text = |part: &str| {
            format!(
                "flash_bytes = 1\nram_and_stack_bytes = 2\n\
                 [hover_instructions_per_sample]\n\"{part}\" = 3\n"
            )
        };
        for part in ["foresight", REST, ALL] {
            let limits = Budget::parse(&text(part)).unwrap();
            assert_eq!(limits.hover_instructions_per_sample[part], 3);
        }
        let refusal = Budget::parse(&text("fore sight")).unwrap_err().to_string();
        assert!(refusal.contains("no part is named `fore sight`, must be one of: foresight, "));
    }
}

//! `budget.toml`: what the firmware may take.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;

use crate::profile::{PARTS, REST, flash_part_names};
use crate::toolchain;

/// The content of `budget.toml`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Most bytes of flash.
    pub flash_bytes: u64,
    /// Most bytes of RAM, the deepest stack among them.
    pub ram_and_stack_bytes: u64,
    /// Most bytes of flash of its parts, whichever control logic flies.
    pub flash_bytes_of_parts: BTreeMap<String, u64>,
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
        let counted: Vec<&str> = PARTS
            .iter()
            .map(|part| part.name)
            .chain([REST, ALL])
            .collect();
        let measured: Vec<&str> = flash_part_names().collect();
        check_names(
            "hover_instructions_per_sample",
            &budget.hover_instructions_per_sample,
            &counted,
        )?;
        check_names(
            "flash_bytes_of_parts",
            &budget.flash_bytes_of_parts,
            &measured,
        )?;
        Ok(budget)
    }

    /// Fails where some part of a firmware's flash takes more than it may.
    ///
    /// # Errors
    /// The first that does.
    pub fn check_flash(&self, parts: &BTreeMap<&'static str, u64>) -> Result<()> {
        for (name, bytes) in parts {
            if let Some(limit) = self.flash_bytes_of_parts.get(*name) {
                ensure!(
                    bytes <= limit,
                    "{name} takes {bytes} bytes of flash, its limit is {limit}"
                );
            }
        }
        Ok(())
    }
}

fn check_names(table: &str, limits: &BTreeMap<String, u64>, known: &[&str]) -> Result<()> {
    let unknown = limits.keys().find(|name| !known.contains(&name.as_str()));
    match unknown {
        None => Ok(()),
        Some(name) => bail!(
            "{table}: no part is named `{name}`, must be one of: {}",
            known.join(", ")
        ),
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
                "flash_bytes = 1\nram_and_stack_bytes = 2\nflash_bytes_of_parts = {{}}\n\
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

    #[test]
    fn a_part_may_use_its_flash_up_but_not_pass_it() {
        let budget = Budget {
            flash_bytes_of_parts: BTreeMap::from([("link".to_owned(), 10)]),
            ..Budget::default()
        };
        assert!(
            budget
                .check_flash(&BTreeMap::from([("link", 10), ("log", 99)]))
                .is_ok()
        );
        let over = budget
            .check_flash(&BTreeMap::from([("link", 11)]))
            .unwrap_err();
        assert_eq!(
            over.to_string(),
            "link takes 11 bytes of flash, its limit is 10"
        );
    }
}

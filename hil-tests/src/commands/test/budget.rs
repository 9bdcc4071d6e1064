//! The firmware's size against its budget, with the stack that a replay used.

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

use crate::progress::Progress;
use crate::replay::replay;
use crate::replay_options::ReplayOptions;
use crate::scoring::Firmware;
use crate::toolchain;

/// The content of `budget.toml`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Budget {
    flash_bytes: u64,
    ram_and_stack_bytes: u64,
}

/// Replays the default flight and compares what the firmware took.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    let file = toolchain::root().join("hil-tests/budget.toml");
    let text = std::fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    let budget: Budget = toml::from_str(&text).with_context(|| file.display().to_string())?;
    let report = replay(&ReplayOptions::default(), progress)?;
    let firmware = report.about.firmware.context("no firmware was replayed")?;
    budget.compare(&firmware)
}

impl Budget {
    fn compare(&self, firmware: &Firmware) -> Result<()> {
        ensure!(
            firmware.flash_bytes <= self.flash_bytes,
            "the firmware takes {} bytes of flash, the budget is {}",
            firmware.flash_bytes,
            self.flash_bytes
        );
        let memory = firmware.ram_bytes + firmware.stack_bytes;
        ensure!(
            memory <= self.ram_and_stack_bytes,
            "the firmware takes {memory} bytes of RAM ({} and {} of stack), the budget is {}",
            firmware.ram_bytes,
            firmware.stack_bytes,
            self.ram_and_stack_bytes
        );
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: Budget = Budget {
        flash_bytes: 1000,
        ram_and_stack_bytes: 100,
    };

    fn compared(flash_bytes: u64, ram_bytes: u64, stack_bytes: u64) -> Result<()> {
        BUDGET.compare(&Firmware {
            flash_bytes,
            ram_bytes,
            stack_bytes,
        })
    }

    #[test]
    fn a_budget_may_be_used_up_but_not_passed() {
        assert!(compared(1000, 60, 40).is_ok());
        let error = compared(1001, 60, 40).unwrap_err().to_string();
        assert_eq!(
            error,
            "the firmware takes 1001 bytes of flash, the budget is 1000"
        );
        let error = compared(1000, 60, 41).unwrap_err().to_string();
        assert!(
            error.contains("101 bytes of RAM (60 and 41 of stack)"),
            "{error}"
        );
    }
}

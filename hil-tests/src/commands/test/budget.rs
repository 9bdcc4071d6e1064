//! Flash, RAM and stack of the firmware with each control logic, against a budget.

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use serde::Deserialize;

use crate::logics::LogicName;
use crate::progress::Progress;
use crate::replay::emulated::replay;
use crate::replay::options::ReplayOptions;
use crate::scoring::Firmware;
use crate::toolchain;

/// The content of `budget.toml`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Budget {
    flash_bytes: u64,
    ram_and_stack_bytes: u64,
}

/// Replays the default flight with every control logic and compares what the firmware took.
///
/// A replay also shows that firmware and host compute the same commands.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    let file = toolchain::root().join("hil-tests/budget.toml");
    let text = std::fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    let budget: Budget = toml::from_str(&text).with_context(|| file.display().to_string())?;
    let configured = LogicName::configured();
    let others = LogicName::value_variants().iter();
    let others = others.filter(|name| **name != configured);
    // The configured one last: what follows uses the firmware that was built with it.
    for logic in others.chain([&configured]) {
        let options = ReplayOptions {
            gains: (*logic).into(),
            ..ReplayOptions::default()
        };
        let report = replay(&options, progress)?;
        let firmware = report.run.firmware.context("no firmware was replayed")?;
        let compared = budget.compare(&firmware);
        compared.with_context(|| format!("with the control logic {}", logic.word()))?;
    }
    Ok(())
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

//! Flash, RAM and stack of the firmware with each control logic, against a budget.

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;

use crate::costs::Budget;
use crate::firmware as built;
use crate::logics::LogicName;
use crate::profile::flash_of_parts;
use crate::progress::Progress;
use crate::replay::emulated::replay;
use crate::replay::options::ReplayOptions;
use crate::scoring::{Firmware, Score};

/// Replays the default flight with every control logic and compares what the firmware took.
///
/// A replay also shows that firmware and host compute the same commands, and the load.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    let budget = Budget::read()?;
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
        let parts = flash_of_parts(&built::Firmware::build(*logic, progress)?)?;
        let compared = compare(&budget, &firmware).and_then(|()| budget.check_flash(&parts));
        let within = compared.and_then(|()| compare_load(&report.score));
        within.with_context(|| format!("with the control logic {}", logic.word()))?;
    }
    Ok(())
}

fn compare(budget: &Budget, firmware: &Firmware) -> Result<()> {
    ensure!(
        firmware.flash_bytes <= budget.flash_bytes,
        "the firmware takes {} bytes of flash, the budget is {}",
        firmware.flash_bytes,
        budget.flash_bytes
    );
    let memory = firmware.ram_bytes + firmware.stack_bytes;
    ensure!(
        memory <= budget.ram_and_stack_bytes,
        "the firmware takes {memory} bytes of RAM ({} and {} of stack), the budget is {}",
        firmware.ram_bytes,
        firmware.stack_bytes,
        budget.ram_and_stack_bytes
    );
    Ok(())
}

/// Share by which a load may differ from the table's, on a flight whose warm-up and saturation are
/// each logic's own.
const MOST_OFF: f64 = 0.1;

/// What reactive control took of the processor, against the table that native replays take it from.
fn compare_load(score: &Score) -> Result<()> {
    let load = score.periodic_equal_load.as_ref();
    let load = load.context("hil-tests/load.toml lacks it")?;
    let measured = load.policy_load_measured.context("no processor was busy")?;
    let by_table = load.policy_load_by_table;
    ensure!(
        (by_table / measured - 1.0).abs() < MOST_OFF,
        "the processor was busy for {:.2} % of the time, hil-tests/load.toml says {:.2} %: \
         its head tells how to measure it",
        100.0 * measured,
        100.0 * by_table
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(flash_bytes: u64, ram_bytes: u64, stack_bytes: u64) -> Result<()> {
        let budget = Budget {
            flash_bytes: 1000,
            ram_and_stack_bytes: 100,
            ..Budget::default()
        };
        let firmware = Firmware {
            flash_bytes,
            ram_bytes,
            stack_bytes,
        };
        compare(&budget, &firmware)
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

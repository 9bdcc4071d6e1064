//! `cargo hil memory`: flash by part, and RAM, with each control logic.

use std::collections::BTreeMap;

use anyhow::Result;
use clap::{Args, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;

use super::bar::Bar;
use crate::firmware::Firmware;
use crate::json::to_json;
use crate::logics::LogicName;
use crate::profile::{flash_of_parts, flash_part_names};
use crate::progress::Progress;

/// Which firmware is measured, and how it is printed.
#[derive(Clone, Debug, Args)]
pub(super) struct MemoryArguments {
    /// Control logic [default: all of them, one after the other]
    #[arg(long)]
    logic: Option<LogicName>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// The memory of the firmware with each control logic.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(super) struct MemoryReport {
    /// A firmware for each.
    logics: Vec<OfLogic>,
}

/// The memory of the firmware with one control logic.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
struct OfLogic {
    /// Its name.
    logic: String,
    /// Bytes of flash by part.
    flash_of_parts: BTreeMap<&'static str, u64>,
    /// Bytes of flash.
    flash: u32,
    /// Bytes of variables.
    ram: u32,
}

/// Builds, measures, prints.
pub(super) fn run(arguments: &MemoryArguments) -> Result<()> {
    let mut bar = Bar::new();
    let logics = match arguments.logic {
        Some(logic) => vec![logic],
        None => LogicName::value_variants().to_vec(),
    };
    let measured = logics.into_iter().map(|logic| measure(logic, &mut bar));
    let measured = measured.collect::<Result<_>>();
    bar.finish();
    let report = MemoryReport { logics: measured? };
    super::print(&if arguments.json {
        to_json(&report)?
    } else {
        report.table()
    })
}

fn measure(logic: LogicName, progress: &mut dyn Progress) -> Result<OfLogic> {
    let firmware = Firmware::build(logic, progress)?;
    Ok(OfLogic {
        logic: logic.word().to_owned(),
        flash_of_parts: flash_of_parts(&firmware)?,
        flash: firmware.sizes.flash_bytes,
        ram: firmware.sizes.ram_bytes,
    })
}

impl MemoryReport {
    /// A table for people, in the form of the pages in docs/.
    fn table(&self) -> String {
        let row = |name: &str, of: &dyn Fn(&OfLogic) -> String| {
            let cells: Vec<String> = self.logics.iter().map(of).collect();
            format!("| {name} | {} |\n", cells.join(" | "))
        };
        let mut text = row("bytes of flash", &|it| format!("`{}`", it.logic));
        text += &row("---", &|_| "---".to_owned()).replace(' ', "");
        for name in flash_part_names() {
            text += &row(name, &|it| {
                it.flash_of_parts
                    .get(name)
                    .copied()
                    .unwrap_or(0)
                    .to_string()
            });
        }
        text += &row("**all**", &|it| it.flash.to_string());
        text += &row("variables, in RAM", &|it| it.ram.to_string());
        text
    }
}

//! What everything costs, against its limits: as a table and as JSON.

use schemars::JsonSchema;
use serde::Serialize;

use super::logics::LogicCost;

/// All costs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Costs {
    /// Instructions of the emulated core in a second.
    pub core_hz: u64,
    /// The parts, in isolation and in flight.
    pub parts: Vec<Cost>,
    /// Parts of the firmware in a simulated hover: the mean of a sample, rounded up.
    pub hover: Vec<Cost>,
    /// Every control logic, in four ways.
    pub logics: Vec<LogicCost>,
    /// Memory that the firmware takes.
    pub firmware: Memory,
    /// How long locks are held, without what preempts them.
    pub locks: Vec<Cost>,
}

/// What one part costs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Cost {
    /// What was measured.
    pub name: String,
    /// Instructions of the dearest measurement.
    pub instructions: u64,
    /// Instructions of the median.
    pub typical: u64,
    /// How often it was measured.
    pub measured: usize,
    /// Most instructions that it may cost.
    pub limit: Option<u64>,
    /// Virtual time of the dearest measurement.
    pub virtual_us: f64,
}

/// Bytes of memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Memory {
    /// Vectors, code, constants, first values of variables.
    pub flash: u32,
    /// Variables.
    pub ram: u32,
    /// The stack, as deep as the replay went.
    pub stack: u32,
}

impl Cost {
    /// The cost of a part from all its measurements, which were busy all the time.
    pub(super) fn of(name: &str, mut counts: Vec<u64>, limit: Option<u64>, core_hz: u64) -> Self {
        counts.sort_unstable();
        let instructions = counts.last().copied().unwrap_or(0);
        Self {
            name: name.to_owned(),
            instructions,
            typical: counts.get(counts.len() / 2).copied().unwrap_or(0),
            measured: counts.len(),
            limit,
            virtual_us: instructions as f64 * 1e6 / core_hz as f64,
        }
    }

    fn is_over(&self) -> bool {
        self.limit.is_some_and(|limit| self.instructions > limit)
    }

    fn verdict(&self) -> &'static str {
        match self.limit {
            Some(_) if self.is_over() => "OVER",
            Some(_) => "ok",
            None => "-",
        }
    }
}

impl Costs {
    /// The first that is dearer than its limit, in one line.
    #[must_use]
    pub fn over(&self) -> Option<String> {
        let mut all = self.parts.iter().chain(&self.locks).chain(&self.hover);
        let Some(over) = all.find(|cost| cost.is_over()) else {
            return self.logics.iter().find_map(LogicCost::over);
        };
        Some(format!(
            "{} takes {} instructions, its limit is {}",
            over.name,
            over.instructions,
            over.limit.unwrap_or(0)
        ))
    }

    /// Instructions of every control logic, a row for each thing that changed.
    fn logics_table(&self) -> String {
        let row =
            |[what, t, r, c, p]: [&str; 5]| format!("{what:<46} {t:>9} {r:>9} {c:>9} {p:>9}\n");
        let head = [
            "control logic, what changed",
            "by clock",
            "reactive",
            "callbacks",
            "pointers",
        ];
        let mut text = format!("\n{}", row(head));
        for cells in self.logics.iter().flat_map(LogicCost::rows) {
            text += &row([&cells[0], &cells[1], &cells[2], &cells[3], &cells[4]]);
        }
        text
    }

    /// A table for people.
    #[must_use]
    pub fn table(&self) -> String {
        let row = |name: &str, [typical, most, us, limit, verdict]: [&str; 5]| {
            format!("{name:<46} {typical:>9} {most:>9} {us:>9} {limit:>9}  {verdict}\n")
        };
        let mut text = row("part", ["typical", "most", "us", "limit", ""]);
        for cost in self.parts.iter().chain(&self.locks).chain(&self.hover) {
            let numbers = [
                &cost.typical.to_string(),
                &cost.instructions.to_string(),
                &format!("{:.2}", cost.virtual_us),
                &cost.limit.map_or("-".to_owned(), |limit| limit.to_string()),
                cost.verdict(),
            ];
            text += &row(&cost.name, numbers.map(|number| number));
        }
        text += &self.logics_table();
        let Memory { flash, ram, stack } = self.firmware;
        text += &format!(
            "\nInstructions, and their time at {} MHz.\n",
            self.core_hz / 1_000_000
        );
        text += &format!("Flash {flash} bytes, RAM {ram} bytes, stack {stack} bytes.\n");
        text
    }
}

//! Every control logic in four ways: what a step costs, and one input alone.

use std::collections::BTreeMap;
use std::sync::Arc;

use anyhow::{Result, ensure};
use clap::ValueEnum;
use reflex::dataflow::Source;
use reflex::graph::ControlLogic;
use reflex_bench::step::Step;
use reflex_bench::{STEPS, STEPS_SYMBOL, WAYS};
use schemars::JsonSchema;
use serde::Serialize;

use super::program::{Program, at_rest};
use super::steps::{INPUTS, cases};
use crate::firmware::Firmware;
use crate::logics::{LogicName, steps_of};
use crate::progress::Progress;
use crate::replay::native::fly;
use crate::replay::options::ReplayOptions;
use emulated_board::Elf;
use recorded_flights::Flight;

/// Blocks of a flight's runs that are measured.
const BLOCKS: usize = 4;

/// Instructions of one way for each step.
type Counts = Vec<u64>;

/// What a control logic costs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LogicCost {
    /// Its name.
    pub name: String,
    /// Mean instructions of a step in which every input changed.
    #[serde(flatten)]
    pub everything: WayCost,
    /// The same where one input alone changed, ours.
    pub by_input: BTreeMap<String, u64>,
    /// The same by callbacks.
    pub callbacks_by_input: BTreeMap<String, u64>,
    /// The same by a pointer vector.
    pub pointer_vector_by_input: BTreeMap<String, u64>,
    /// Steps in which ours took as many instructions as callbacks or a pointer vector, or more.
    pub not_least: usize,
    /// Bytes that the graph takes.
    pub ram_bytes: usize,
    /// Bytes of its values, one by one.
    pub stored_bytes: usize,
    /// Recorded flights that were asked for.
    pub flights: Vec<FlightCost>,
}

/// Mean instructions of a step, in each way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct WayCost {
    /// One function that computes everything.
    pub time_triggered: u64,
    /// Ours: the graph, which computes what a change reaches.
    pub reactive: u64,
    /// Callbacks through function pointers, depth first.
    pub callbacks: u64,
    /// The pointer vector of the paper's RP-Embedded.
    pub pointer_vector: u64,
}

/// What the runs of a recorded flight cost.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FlightCost {
    /// The flight's name.
    pub log: String,
    /// Runs that were measured, in blocks spread over the flight.
    pub steps: usize,
    /// Their mean.
    #[serde(flatten)]
    pub mean: WayCost,
}

impl LogicCost {
    /// One line about a cost beyond its limit, where there is one.
    ///
    /// Where everything changed, ours may take an eighth more than time-triggered control. It takes
    /// less than the other reactive ways in every step. An input that reaches less than a fifth
    /// of the work takes at most three tenths of it.
    #[must_use]
    pub fn over(&self) -> Option<String> {
        let (name, all) = (&self.name, &self.everything);
        if 8 * all.reactive > 9 * all.time_triggered {
            return Some(format!(
                "{name} takes {} instructions where everything changed, its limit is 9/8 of {}",
                all.reactive, all.time_triggered
            ));
        }
        if self.not_least > 0 {
            return Some(format!(
                "{name} takes as much as callbacks or a pointer vector in {} steps",
                self.not_least
            ));
        }
        // The cost of a change that reaches no node, which is no part of the work.
        let overhead = self.by_input.values().min().copied().unwrap_or(0);
        let mut inputs = self.by_input.iter();
        let (input, cost) = inputs.find(|(_, cost)| {
            let slice = cost.saturating_sub(overhead);
            5 * slice < all.time_triggered && 10 * **cost > 3 * all.time_triggered
        })?;
        Some(format!(
            "{name} takes {cost} instructions where {input} changed, its limit is 0.3 of {}",
            all.time_triggered
        ))
    }

    /// Rows of a table: what changed, then the four ways.
    pub(super) fn rows(&self) -> Vec<[String; 5]> {
        let row = |what: String, cost: &WayCost| {
            let numbers = [
                cost.time_triggered,
                cost.reactive,
                cost.callbacks,
                cost.pointer_vector,
            ];
            let [t, r, c, p] = numbers.map(|number| number.to_string());
            [what, t, r, c, p]
        };
        let mut rows = vec![row(format!("{}: everything", self.name), &self.everything)];
        rows.extend(self.by_input.iter().map(|(input, reactive)| {
            let of = |costs: &BTreeMap<String, u64>| costs.get(input).copied().unwrap_or(0);
            let cost = WayCost {
                time_triggered: self.everything.time_triggered,
                reactive: *reactive,
                callbacks: of(&self.callbacks_by_input),
                pointer_vector: of(&self.pointer_vector_by_input),
            };
            row(format!("{}: {input}", self.name), &cost)
        }));
        rows.extend(
            self.flights
                .iter()
                .map(|flight| row(format!("{}: {}", self.name, flight.log), &flight.mean)),
        );
        rows
    }
}

impl WayCost {
    /// Means over the steps that `counts`.
    fn mean(ways: &[Counts; WAYS], mut counts: impl FnMut(usize) -> bool) -> Self {
        let steps: Vec<usize> = (0..ways[0].len()).filter(|step| counts(*step)).collect();
        let mean = |way: &Counts| {
            let sum: u64 = steps.iter().map(|step| way[*step]).sum();
            let steps = steps.len().max(1) as u64;
            (sum + steps / 2) / steps
        };
        let [time_triggered, reactive, callbacks, pointer_vector] = ways;
        Self {
            time_triggered: mean(time_triggered),
            reactive: mean(reactive),
            callbacks: mean(callbacks),
            pointer_vector: mean(pointer_vector),
        }
    }
}

/// The program that runs every logic in every way.
pub(super) struct LogicProgram {
    elf: Elf,
}

impl LogicProgram {
    pub(super) fn build(progress: &mut dyn Progress) -> Result<Self> {
        let program = Firmware::build_logics(progress)?;
        progress.stage("Counting the control logics");
        Ok(Self {
            elf: Elf::parse(program.bytes)?,
        })
    }

    /// Every logic over made-up steps.
    pub(super) fn measure(&self) -> Result<Vec<(LogicName, LogicCost)>> {
        let cases = cases();
        let steps: Vec<Step> = cases.iter().map(|case| case.step).collect();
        let logics = LogicName::value_variants().iter();
        let costs = logics.map(|name| {
            let ways = self.run(*name, &steps)?;
            let description = name.logic().description();
            let has = |input: &str| {
                let mut values = description.values.iter();
                values.any(|it| it.name == input && matches!(it.source, Source::Input { .. }))
            };
            let alone: Vec<(String, WayCost)> = INPUTS
                .iter()
                .filter(|input| has(input))
                .map(|input| {
                    let of_input = |step: usize| cases[step].alone == Some(*input);
                    ((*input).to_owned(), WayCost::mean(&ways, of_input))
                })
                .collect();
            let of = |way: fn(&WayCost) -> u64| {
                let costs = alone.iter().map(|(input, cost)| (input.clone(), way(cost)));
                costs.collect::<BTreeMap<_, _>>()
            };
            let counts = |step: &usize| cases[*step].alone.is_none_or(has);
            let (ram_bytes, stored_bytes) = name.bytes();
            let cost = LogicCost {
                name: name.word().to_owned(),
                everything: WayCost::mean(&ways, |step| cases[step].alone.is_none()),
                by_input: of(|cost| cost.reactive),
                callbacks_by_input: of(|cost| cost.callbacks),
                pointer_vector_by_input: of(|cost| cost.pointer_vector),
                not_least: (0..steps.len())
                    .filter(counts)
                    .filter(|step| ways[1][*step] >= ways[2][*step].min(ways[3][*step]))
                    .count(),
                ram_bytes,
                stored_bytes,
                flights: Vec::new(),
            };
            Ok((*name, cost))
        });
        costs.collect()
    }

    /// One logic over the runs of recorded flights, in reactive control as it is configured.
    pub(super) fn measure_flights(
        &self,
        name: LogicName,
        flights: &[Flight],
        progress: &mut dyn Progress,
    ) -> Result<Vec<FlightCost>> {
        let options = ReplayOptions {
            gains: name.into(),
            ..ReplayOptions::default()
        };
        let costs = flights.iter().map(|flight| {
            progress.stage(&format!("Counting {} on {}", name.word(), flight.name));
            let steps = steps_of(&fly(flight, &options)?, options.settings, name);
            self.measure_runs(name, &flight.name, &steps)
        });
        costs.collect()
    }

    /// One logic over runs, in blocks spread over them.
    fn measure_runs(&self, name: LogicName, log: &str, steps: &[Step]) -> Result<FlightCost> {
        let mut all: [Counts; WAYS] = Default::default();
        let apart = (steps.len() / BLOCKS).max(1);
        for block in steps.chunks(apart).take(BLOCKS) {
            let block = &block[..block.len().min(STEPS)];
            for (all, way) in all.iter_mut().zip(self.run(name, block)?) {
                all.extend(way);
            }
        }
        Ok(FlightCost {
            log: log.to_owned(),
            steps: all[0].len(),
            mean: WayCost::mean(&all, |_| true),
        })
    }

    /// Instructions of one logic, in every way, for each step.
    fn run(&self, name: LogicName, steps: &[Step]) -> Result<[Counts; WAYS]> {
        let mut elf = self.elf.clone();
        elf.overwrite(&STEPS_SYMBOL, &image(name.place(), steps))?;
        let pairs = Program::new(&Arc::new(elf))?.run(at_rest())?;
        let expected = 1 + steps.len() * WAYS;
        ensure!(
            pairs.len() == expected,
            "the control logics ended at measurement {} of {expected}",
            pairs.len()
        );
        let nothing = pairs[0];
        let mut ways: [Counts; WAYS] = Default::default();
        for step in pairs[1..].chunks_exact(WAYS) {
            for (way, count) in ways.iter_mut().zip(step) {
                way.push(count.saturating_sub(nothing));
            }
        }
        Ok(ways)
    }
}

/// Which logic, how many steps, then their words, as the program's memory holds them.
fn image(logic: usize, steps: &[Step]) -> Vec<u8> {
    let head = [logic as u32, steps.len() as u32];
    let words = head
        .into_iter()
        .chain(steps.iter().flat_map(Step::to_words));
    words.flat_map(u32::to_le_bytes).collect()
}

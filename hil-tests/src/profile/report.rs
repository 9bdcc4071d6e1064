//! The sums of a profile, as JSON and as text.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Serialize;

use super::floats::Arithmetic;
use super::parts::{PARTS, REST, part_of};
use super::stacks::Stack;
use crate::record::{Counted, HANDLERS};
use emulated_board::EXCEPTION_CYCLES;

/// Functions that the text lists.
const LISTED: usize = 30;

/// What was flown.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Subject {
    /// The log, or mission, environment and airframe.
    pub flight: String,
    /// Name of the control logic.
    pub logic: String,
    /// `reactive` or `periodic`.
    pub policy: String,
    /// Runs per second that were asked for; null for the reactive policy.
    pub rate_hz: Option<f64>,
    /// Seed of everything.
    pub seed: u32,
    /// SHA-256 over all motor writes with their times; without a profile it is the same.
    pub digest: String,
}

/// Where the instructions of a flight's scored part went.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Profile {
    /// What was flown.
    #[serde(flatten)]
    pub subject: Subject,
    /// Where the scored part begins, s since reset.
    pub from_s: f64,
    /// How long it lasts, s.
    pub length_s: f64,
    /// Samples of the inertial sensor in it.
    pub samples: u64,
    /// Runs of the control logic in it.
    pub runs: u64,
    /// Instructions that the core executes in a second without sleep.
    pub core_hz: u64,
    /// Exceptions that were entered. The emulated core takes no cycles for it.
    pub exceptions: u64,
    /// All instructions; `busy_fraction` is that of the flight's own report.
    pub all: Share,
    /// Share of the processor with 22 cycles for each exception, as silicon takes them to enter and to leave.
    pub busy_with_exceptions: f64,
    /// Instructions by part, in the order of the table of parts.
    pub parts: Vec<Share>,
    /// By function: the innermost of a module that a part names, with what it calls elsewhere.
    pub functions: Vec<Share>,
    /// By task, the dearest first.
    pub tasks: Vec<TaskShare>,
    /// Instructions that compute with floats: a core without a unit for them calls a library for each.
    pub floats: Vec<Share>,
}

/// Instructions of a part, a function, a task, or all.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Share {
    /// Its name.
    pub name: String,
    /// Its instructions.
    pub instructions: u64,
    /// The same, per second.
    pub per_second: f64,
    /// The same, per sample of the inertial sensor; null without any.
    pub per_sample: Option<f64>,
    /// The same, per run of the control logic; null without any.
    pub per_run: Option<f64>,
    /// Share of the processor.
    pub busy_fraction: f64,
}

/// Instructions of a task.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TaskShare {
    /// Its interrupt handler and what that is for, and its instructions.
    #[serde(flatten)]
    pub share: Share,
    /// How often its exceptions were entered; 0 for idle, which is none.
    pub entries: u64,
}

impl Profile {
    /// The sums of some stacks.
    pub(super) fn of(
        subject: Subject,
        counted: &Counted,
        stacks: &[Stack],
        floats: &BTreeMap<Arithmetic, u64>,
    ) -> Self {
        let tally = &counted.tally;
        let length_s = (tally.to_ns - tally.from_ns) as f64 * 1e-9;
        let share = |name: &str, instructions: u64| {
            let per = |count: u64| (count > 0).then(|| instructions as f64 / count as f64);
            Share {
                name: name.to_owned(),
                instructions,
                per_second: instructions as f64 / length_s,
                per_sample: per(counted.samples),
                per_run: per(counted.runs),
                busy_fraction: instructions as f64
                    / (length_s * counted.instructions_per_second as f64),
            }
        };
        let mut parts: BTreeMap<&str, u64> = BTreeMap::new();
        let mut functions: BTreeMap<(&str, &str), u64> = BTreeMap::new();
        let mut tasks: BTreeMap<&str, (u64, BTreeSet<u16>)> = BTreeMap::new();
        for stack in stacks {
            let (part, function) = part_of(&stack.frames);
            *parts.entry(part).or_default() += stack.instructions;
            *functions.entry((part, function)).or_default() += stack.instructions;
            let (sum, exceptions) = tasks.entry(&stack.handler).or_default();
            *sum += stack.instructions;
            exceptions.insert(stack.exception);
        }
        let names = PARTS.iter().map(|part| part.name).chain([REST]);
        let functions = functions.iter();
        let functions =
            functions.map(|((part, name), sum)| share(&format!("{name} ({part})"), *sum));
        // Exceptions may share a handler.
        let entries = |exception| tally.entries.get(exception).copied().unwrap_or(0);
        let tasks = tasks.iter().map(|(handler, (sum, exceptions))| TaskShare {
            share: share(&task(handler), *sum),
            entries: exceptions.iter().map(entries).sum(),
        });
        let exceptions = tally.entries.iter().filter(|it| *it.0 != 0);
        let exceptions = exceptions.map(|it| it.1).sum();
        let all = share("all", tally.executed);
        let charged = tally.executed + exceptions * EXCEPTION_CYCLES;
        Self {
            from_s: tally.from_ns as f64 * 1e-9,
            length_s,
            samples: counted.samples,
            runs: counted.runs,
            core_hz: counted.instructions_per_second,
            exceptions,
            all,
            busy_with_exceptions: share("charged", charged).busy_fraction,
            parts: names
                .map(|name| share(name, parts.get(name).copied().unwrap_or(0)))
                .collect(),
            functions: dearest_first(functions, |function| function),
            tasks: dearest_first(tasks, |task| &task.share),
            floats: Arithmetic::ALL
                .iter()
                .map(|(it, name)| share(name, floats.get(it).copied().unwrap_or(0)))
                .collect(),
            subject,
        }
    }

    /// What was flown, in a line.
    #[must_use]
    pub fn title(&self) -> String {
        let Subject {
            flight,
            logic,
            policy,
            rate_hz,
            seed,
            ..
        } = &self.subject;
        let rate = rate_hz.map_or(String::new(), |rate_hz| format!(" at {rate_hz:.0} Hz"));
        format!("{flight}: {logic}, {policy}{rate}, seed {seed}")
    }

    /// Tables for people.
    #[must_use]
    pub fn tables(&self) -> String {
        let mut text = format!(
            "{}\n{:.3} s from {:.3} s after reset: {} samples, {} runs\n\
             {:.2} % of the processor at {} MHz, {:.2} % with {EXCEPTION_CYCLES} cycles for each of \
             {:.0} exceptions a second\n",
            self.title(),
            self.length_s,
            self.from_s,
            self.samples,
            self.runs,
            self.all.busy_fraction * 100.0,
            self.core_hz / 1_000_000,
            self.busy_with_exceptions * 100.0,
            self.exceptions as f64 / self.length_s,
        );
        text += &heading("part, instructions");
        text.extend(self.parts.iter().chain([&self.all]).map(Share::row));
        text += &heading(&format!("function, the {LISTED} dearest"));
        text.extend(self.functions.iter().take(LISTED).map(Share::row));
        text += &heading("task");
        text.extend(self.tasks.iter().map(|task| task.share.row()));
        text += &heading("arithmetic of floats among them");
        text.extend(self.floats.iter().map(Share::row));
        text
    }
}

impl Share {
    fn row(&self) -> String {
        let number = |value: Option<f64>, digits: usize| {
            value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
        };
        row(
            &self.name,
            [
                number(Some(self.per_second), 0),
                number(self.per_sample, 1),
                number(self.per_run, 0),
                number(Some(self.busy_fraction * 100.0), 3),
            ],
        )
    }
}

fn heading(what: &str) -> String {
    let columns = ["a second", "a sample", "a run", "% of time"];
    format!("\n{}", row(what, columns.map(str::to_owned)))
}

fn row(name: &str, [second, sample, run, time]: [String; 4]) -> String {
    format!("{second:>10} {sample:>9} {run:>8} {time:>9}  {name}\n")
}

/// A task's handler with what it is for.
fn task(handler: &str) -> String {
    let known = HANDLERS.iter().find(|(name, _)| *name == handler);
    known.map_or(handler.to_owned(), |(_, what)| format!("{handler}, {what}"))
}

fn dearest_first<T>(all: impl Iterator<Item = T>, share: impl Fn(&T) -> &Share) -> Vec<T> {
    let mut all: Vec<T> = all.collect();
    all.sort_by_key(|it| std::cmp::Reverse(share(it).instructions));
    all
}

//! A program on the emulated core, whose instructions between marks are counted.

use std::sync::Arc;

use anyhow::{Result, ensure};

use chip_models::{ChipOptions, SharedChips, Stimulus, StimulusSource};
use emulated_board::emulated::{EmulatedBoard, Sensors};
use emulated_board::{Board, Elf, Hit, Observer, Options, Watched};

/// Places that are watched, in the order of their numbers.
const MARK: usize = 0;
const DONE: usize = 1;

/// How far the program runs between two looks at it, and how far at most, ns.
const STEP_NS: u64 = 20_000_000;
const LONGEST_NS: u64 = 20_000_000_000;

/// Instructions at each mark.
#[derive(Default)]
struct Marks {
    at: Vec<u64>,
    done: bool,
}

impl Observer for Marks {
    fn hit(&mut self, hit: Hit) {
        match hit.watch {
            MARK => self.at.push(hit.instructions),
            DONE => self.done = true,
            _ => {}
        }
    }
}

/// A program that measures between marks.
pub(super) struct Program {
    elf: Arc<Elf>,
    options: Options,
}

impl Program {
    pub(super) fn new(elf: &Arc<Elf>) -> Result<Self> {
        let options = Options {
            watches: vec![
                Watched::Address(elf.function(&["marks", "mark"])?),
                Watched::Address(elf.function(&["marks", "done"])?),
            ],
            flies: false,
            ..Options::default()
        };
        Ok(Self {
            elf: Arc::clone(elf),
            options,
        })
    }

    /// Instructions between each pair of marks, once the program is done.
    pub(super) fn run(&self, sensors: Sensors) -> Result<Vec<u64>> {
        self.watch(sensors, |_| ())
    }

    /// As [`Self::run`], with a call after each look that gives the marks so far.
    pub(super) fn watch(
        &self,
        sensors: Sensors,
        mut report: impl FnMut(usize),
    ) -> Result<Vec<u64>> {
        let mut board = EmulatedBoard::boot(&self.elf, sensors, &self.options)?;
        let mut marks = Marks::default();
        while !marks.done && board.now_ns() < LONGEST_NS {
            board.run_until(board.now_ns() + STEP_NS, &mut marks)?;
            report(marks.at.len());
        }
        ensure!(
            marks.done,
            "the program was not done after {} s",
            LONGEST_NS / 1_000_000_000
        );
        Ok(marks
            .at
            .chunks_exact(2)
            .map(|pair| pair[1] - pair[0])
            .collect())
    }
}

/// Chips that the program leaves alone.
pub(crate) fn at_rest() -> Sensors {
    let source: Arc<dyn StimulusSource> = Arc::new(|_| Stimulus::default());
    Sensors::from(&SharedChips::feeling(&source, ChipOptions::default()))
}

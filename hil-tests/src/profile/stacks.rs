//! From counted addresses to stacks of functions.

use std::collections::BTreeMap;
use std::rc::Rc;

use anyhow::Result;

use super::frames::{Frame, Frames};
use emulated_board::{Came, Tally};

/// Functions that called one another, and the instructions of the innermost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stack {
    /// Number of the exception that they handle; 0 is the thread.
    pub exception: u16,
    /// Name of the exception's handler.
    pub handler: String,
    /// The functions, inlined ones too, the outermost first.
    pub frames: Vec<Rc<Frame>>,
    /// Instructions of the last of them alone.
    pub instructions: u64,
}

/// Every stack of a tally, with all of its instructions.
///
/// # Errors
/// A firmware without debug information.
pub(super) fn of(elf: &[u8], tally: &Tally) -> Result<Vec<Stack>> {
    let mut frames = Frames::of(elf)?;
    let mut merged: BTreeMap<(u16, Vec<Rc<Frame>>), u64> = BTreeMap::new();
    for ((way, address), instructions) in &tally.counts {
        let (exception, calls) = calls(tally, *way);
        let mut stack = Vec::new();
        for at in calls.iter().chain([address]) {
            stack.extend(frames.at(*at)?.iter().cloned());
        }
        *merged.entry((exception, stack)).or_default() += instructions;
    }
    let stacks = merged.into_iter();
    let stacks = stacks.map(|((exception, functions), instructions)| Stack {
        exception,
        handler: match exception {
            0 => "idle".to_owned(),
            _ => frames.handler(exception).unwrap_or("unknown").to_owned(),
        },
        frames: functions,
        instructions,
    });
    Ok(stacks.collect())
}

/// The exception that a way begins with, and the calls that it goes on with.
fn calls(tally: &Tally, way: usize) -> (u16, Vec<u32>) {
    let mut calls = Vec::new();
    let mut way = way;
    loop {
        match tally.ways[way] {
            Came::Exception(exception) => {
                calls.reverse();
                return (exception, calls);
            }
            Came::Call { caller, at } => {
                calls.push(at);
                way = caller;
            }
        }
    }
}

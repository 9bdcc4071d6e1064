//! Stacks as a flame graph, and as the lines that other tools draw one from.

use std::fmt::Write;

use anyhow::{Context, Result};
use inferno::flamegraph::{self, Options};

use super::{Profiled, Stack};

/// A line for each stack: task and functions, `;` between them, then instructions.
#[must_use]
pub fn folded(stacks: &[Stack]) -> String {
    let mut lines = String::new();
    for stack in stacks {
        let functions = stack.frames.iter().map(|frame| frame.function.as_str());
        let names: Vec<&str> = [stack.handler.as_str()]
            .into_iter()
            .chain(functions)
            .collect();
        let _ = writeln!(lines, "{} {}", names.join(";"), stack.instructions);
    }
    lines
}

/// The flame graph as SVG: tasks at the bottom, functions that they call above them.
///
/// # Errors
/// None in practice: every profile has stacks.
pub fn figure(profiled: &Profiled) -> Result<String> {
    let mut options = Options::default();
    "instructions".clone_into(&mut options.count_name);
    "function:".clone_into(&mut options.name_type);
    options.title = profiled.profile.title();
    // Colours by name: the same profile gives the same bytes.
    options.hash = true;
    let lines = folded(&profiled.stacks);
    let mut svg = Vec::new();
    flamegraph::from_lines(&mut options, lines.lines(), &mut svg)
        .context("the flame graph cannot be drawn")?;
    Ok(String::from_utf8(svg)?)
}

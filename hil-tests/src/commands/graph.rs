//! `cargo hil graph`: the picture of a control logic.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use reflex::graph::ControlLogic;

use crate::json::to_json;
use crate::logics::LogicName;
use crate::output_file::OutputFile;
use crate::picture::{GraphData, dot, svg};
use crate::toolchain;

/// Which logic is drawn, and where to.
#[derive(Clone, Debug, Args)]
pub(super) struct GraphArguments {
    /// Control logic to draw [default: that of config/selection.toml]
    logic: Option<LogicName>,

    /// Write it for Graphviz to this file [default: target/hil/graph_LOGIC.dot]
    #[arg(long, value_name = "FILE")]
    dot: Option<PathBuf>,

    /// Draw it to this file [default: target/hil/graph_LOGIC.svg]
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,

    /// Print one JSON object, and write only files that are named
    #[arg(long)]
    json: bool,
}

/// Writes the pictures, then says where they are, or prints the graph as data.
pub(super) fn run(arguments: &GraphArguments) -> Result<()> {
    let name = arguments.logic.unwrap_or_else(LogicName::configured);
    let graph = name.logic().description();
    let mut text = String::new();
    for (option, named, content) in [
        ("dot", &arguments.dot, dot(&graph)),
        ("svg", &arguments.svg, svg(&graph)),
    ] {
        let file = match named {
            Some(file) => file.clone(),
            None if arguments.json => continue,
            None => in_target(&format!("graph_{}.{option}", name.word()))?,
        };
        OutputFile::new(option, &file).write(&content)?;
        text += &format!("{option}: {}\n", file.display());
    }
    if arguments.json {
        text = to_json(&GraphData::of(&graph))?;
    }
    super::print(&text)
}

/// A file in the folder of what the commands write, which is made where it is missing.
fn in_target(name: &str) -> Result<PathBuf> {
    let folder = toolchain::root().join("target/hil");
    std::fs::create_dir_all(&folder)?;
    Ok(folder.join(name))
}

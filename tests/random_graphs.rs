//! Random graphs, compiled and run: propagation equals computing everything anew.
//!
//! Each graph is written to a file twice: as a declaration with its lines shuffled, and as plain
//! code in the order in which it was made up, which computes every node, and advances a state
//! when its clock ticks. `REFLEX_GRAPHS=200 REFLEX_GRAPHS_SEED=7` tries more, and others.

#[path = "random_graphs/generator.rs"]
mod generator;

use std::path::Path;
use std::{env, fs};

#[test]
fn propagation_equals_computing_everything_anew() {
    let number = |name: &str, default: u64| match env::var(name) {
        Ok(text) => text
            .parse()
            .unwrap_or_else(|_| panic!("{name}={text}: not a number")),
        Err(_) => default,
    };
    let program = generator::program(number("REFLEX_GRAPHS", 24), number("REFLEX_GRAPHS_SEED", 1));
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("random_graphs.rs");
    fs::write(&file, program).expect("the build's own folder is writable");
    trybuild::TestCases::new().pass(file);
}

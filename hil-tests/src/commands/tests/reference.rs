//! The pages of `docs/` that are written from the program's declarations.
//!
//! `REFLEX_BLESS=1 cargo test -p hil-tests --profile hil --ignore-rust-version reference` rewrites
//! them; without the variable each page must be what the program says.

mod commands;
mod reports;

use std::path::Path;

use clap::CommandFactory;

use crate::commands::Cli;

#[test]
fn the_page_of_commands_is_what_the_program_takes() {
    agree("commands.md", &commands::page(&Cli::command()));
}

#[test]
fn the_page_of_reports_is_what_the_program_prints_as_json() {
    agree("reports.md", &reports::page());
}

/// Compares a page with what the program says, or rewrites it.
fn agree(name: &str, page: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(name);
    if std::env::var_os("REFLEX_BLESS").is_some_and(|flag| flag == "1") {
        std::fs::write(&file, page).expect("docs/ is writable");
        return;
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        written == page,
        "docs/{name} differs from the program: look at it, then REFLEX_BLESS=1"
    );
}

/// Text that a table's cell can hold.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

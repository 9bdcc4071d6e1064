//! `cargo hil test`: everything that continuous integration runs, cheapest first.

mod budget;
mod structure;

use anyhow::{Context, Result};

use super::bar::Bar;
use super::{bench, fuzz};
use crate::progress::Progress;
use crate::toolchain::{self, TARGET};

/// A check with its name.
type Step = (&'static str, fn(&mut dyn Progress) -> Result<()>);

const STEPS: [Step; 10] = [
    ("structure of the sources", structure::check),
    ("formatting", formatting),
    ("lints on the host", lints_on_host),
    ("lints on the target", lints_on_target),
    ("tests of firmware, drivers and configuration", quick_tests),
    ("instructions and their limits", bench::check),
    ("firmware and its budgets", budget::check),
    ("inputs that nobody meant", fuzz::check),
    (
        "tests of emulated board, flights and replays",
        emulated_tests,
    ),
    ("documentation", documentation),
];

/// Runs every step, and stops at the first that fails.
pub(super) fn run() -> Result<()> {
    let mut bar = Bar::new();
    for (name, step) in STEPS {
        bar.stage(name);
        let result = step(&mut bar);
        bar.finish();
        let word = if result.is_ok() { "ok" } else { "FAILED" };
        super::print(&format!("{word:>6}  {name}\n"))?;
        result.with_context(|| name)?;
    }
    Ok(())
}

fn formatting(progress: &mut dyn Progress) -> Result<()> {
    toolchain::ensure_component("rustfmt", "fmt", progress)?;
    cargo(&["fmt", "--all", "--check"], progress)
}

/// One profile and one set of features with [`documentation`], so that the emulator is checked once.
fn lints_on_host(progress: &mut dyn Progress) -> Result<()> {
    toolchain::ensure_component("clippy", "clippy", progress)?;
    let line =
        "clippy --workspace --all-targets --profile hil --ignore-rust-version -- -D warnings";
    cargo(&words(line), progress)
}

fn lints_on_target(progress: &mut dyn Progress) -> Result<()> {
    toolchain::ensure_target(progress)?;
    let line = format!(
        "clippy -p reflex -p reflex-drivers -p reflex-bench --release --target {TARGET} -- -D warnings"
    );
    cargo(&words(&line), progress)
}

/// What plain `cargo test` runs: with checks of overflow, without the emulator.
fn quick_tests(progress: &mut dyn Progress) -> Result<()> {
    cargo(&["test"], progress)
}

fn emulated_tests(progress: &mut dyn Progress) -> Result<()> {
    let line = "test -p hil-tests -p chip-models -p emulated-board -p flight-dynamics -p recorded-flights \
                -p reflex-bench --profile hil --ignore-rust-version";
    cargo(&words(line), progress)
}

/// The libraries for their users, and the application with its private parts.
fn documentation(progress: &mut dyn Progress) -> Result<()> {
    let libraries = "doc --workspace --no-deps --profile hil --ignore-rust-version";
    let mut command = toolchain::cargo();
    command
        .args(words(libraries))
        .env("RUSTDOCFLAGS", "-D warnings");
    toolchain::run(&mut command, progress)?;
    let application = format!(
        "rustdoc -p reflex --bin reflex --release --target {TARGET} -- --document-private-items \
         -D warnings"
    );
    cargo(&words(&application), progress)
}

fn cargo(arguments: &[&str], progress: &mut dyn Progress) -> Result<()> {
    toolchain::run(toolchain::cargo().args(arguments), progress)?;
    Ok(())
}

fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

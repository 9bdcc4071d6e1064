//! The Rust toolchain that commands call: cargo, the cross target, components.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;

use anyhow::{Context, Result, anyhow};

use crate::progress::Progress;
use crate::refusal::Refusal;

/// The processor's target.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Variables of cargo that say where and how to fetch and to put things, not what to build.
const KEPT: [&str; 9] = [
    "CARGO_BUILD_JOBS",
    "CARGO_HOME",
    "CARGO_HTTP_",
    "CARGO_INCREMENTAL",
    "CARGO_NET_",
    "CARGO_REGISTR",
    "CARGO_SOURCE_",
    "CARGO_TARGET_DIR",
    "CARGO_TERM_",
];
/// Variables that would replace link arguments and log level of `.cargo/config.toml`, or the compiler.
const CONFUSING: [&str; 4] = [
    "RUSTFLAGS",
    "RUSTDOCFLAGS",
    "RUSTC_WORKSPACE_WRAPPER",
    "DEFMT_LOG",
];

/// The folder of the workspace.
#[must_use]
pub fn root() -> &'static Path {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.parent().unwrap_or(package)
}

/// Cargo in the workspace's folder, without what an outer cargo left in the environment.
#[must_use]
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).stdin(Stdio::null());
    for (name, _) in std::env::vars_os() {
        let name = name.to_string_lossy();
        let of_cargo =
            name.starts_with("CARGO_") && !KEPT.iter().any(|kept| name.starts_with(kept));
        if of_cargo || CONFUSING.contains(&name.as_ref()) {
            command.env_remove(name.as_ref());
        }
    }
    command
}

/// Runs a command to its end and returns its stdout, with its last line as the stage's detail.
///
/// # Errors
/// It cannot be started, or it fails; then everything it said has gone to `progress`.
pub fn run(command: &mut Command, progress: &mut dyn Progress) -> Result<Vec<u8>> {
    let name = spelled(command);
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("{name} cannot be started"))?;
    let stdout = child.stdout.take().context("stdout is piped")?;
    let stderr = child.stderr.take().context("stderr is piped")?;
    let (written, said) = drain(stdout, stderr, progress);
    let status = child.wait().with_context(|| format!("{name} got lost"))?;
    if status.success() {
        return Ok(written);
    }
    progress.output(&String::from_utf8_lossy(&written));
    progress.output(&said);
    Err(anyhow!("{name} failed ({status})"))
}

/// Reads both streams to their ends at once, as a full pipe would stop the command.
fn drain(
    mut stdout: impl Read + Send,
    stderr: impl Read,
    progress: &mut dyn Progress,
) -> (Vec<u8>, String) {
    thread::scope(|scope| {
        let reader = scope.spawn(move || {
            let mut written = Vec::new();
            // What was read before an error is still worth showing.
            let _ = stdout.read_to_end(&mut written);
            written
        });
        let mut said = String::new();
        let mut lines = BufReader::new(stderr);
        let mut line = Vec::new();
        while matches!(lines.read_until(b'\n', &mut line), Ok(1..)) {
            let text = String::from_utf8_lossy(&line);
            progress.detail(text.trim());
            if !is_status(&text) {
                said.push_str(&text);
            }
            line.clear();
        }
        (reader.join().unwrap_or_default(), said)
    })
}

/// Whether a line only says what cargo is busy with, as `   Compiling reflex v0.1.0`.
fn is_status(line: &str) -> bool {
    let busy = [
        "Blocking",
        "Checking",
        "Compiling",
        "Documenting",
        "Downloaded",
        "Downloading",
    ];
    let word = line.split_whitespace().next().unwrap_or_default();
    line.starts_with("  ") && busy.contains(&word)
}

/// A command as it would be typed.
#[must_use]
pub fn spelled(command: &Command) -> String {
    let program = Path::new(command.get_program());
    let name = program.file_stem().unwrap_or(program.as_os_str());
    let words = std::iter::once(name).chain(command.get_args());
    let words: Vec<_> = words.map(|word| word.to_string_lossy()).collect();
    words.join(" ")
}

/// Adds the processor's target where the toolchain lacks it.
///
/// # Errors
/// A refusal that says which command adds it, where rustup is absent or cannot.
pub fn ensure_target(progress: &mut dyn Progress) -> Result<()> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let asked = Command::new(rustc)
        .args(["--print", "target-libdir", "--target", TARGET])
        .current_dir(root())
        .stderr(Stdio::null())
        .output();
    let installed = asked.is_ok_and(|answer| {
        let folder = String::from_utf8_lossy(&answer.stdout).trim().to_owned();
        answer.status.success() && !folder.is_empty() && PathBuf::from(folder).is_dir()
    });
    if installed {
        return Ok(());
    }
    progress.stage(&format!("Adding the target {TARGET}"));
    add(&["target", "add", TARGET])
}

/// Adds a component of the toolchain (`clippy`, `rustfmt`) where its command is missing.
///
/// # Errors
/// A refusal that says which command adds it, where rustup is absent or cannot.
pub fn ensure_component(name: &str, command: &str, progress: &mut dyn Progress) -> Result<()> {
    let answer = cargo()
        .args([command, "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if answer.is_ok_and(|status| status.success()) {
        return Ok(());
    }
    progress.stage(&format!("Adding the component {name}"));
    add(&["component", "add", name])
}

/// `rustup` with these arguments, or a refusal that says to run it.
fn add(arguments: &[&str]) -> Result<()> {
    let answer = Command::new("rustup")
        .args(arguments)
        .current_dir(root())
        .output();
    let reason = match answer {
        Ok(answer) if answer.status.success() => return Ok(()),
        Ok(answer) => last_line(&answer.stderr),
        Err(error) => format!("rustup cannot be started: {error}"),
    };
    Err(Refusal::new(format!(
        "the Rust toolchain lacks {}, run `rustup {}` to add it ({reason})",
        arguments.last().unwrap_or(&"something"),
        arguments.join(" ")
    ))
    .into())
}

fn last_line(output: &[u8]) -> String {
    let output = String::from_utf8_lossy(output);
    let last = output.lines().map(str::trim).rfind(|line| !line.is_empty());
    last.unwrap_or("it did not say why").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    #[test]
    fn a_command_is_spelled_as_it_would_be_typed() {
        let mut command = Command::new("/usr/bin/cargo");
        command.args(["build", "--release"]);
        assert_eq!(spelled(&command), "cargo build --release");
    }

    #[test]
    fn an_inner_cargo_does_not_see_the_outer_one() {
        let command = cargo();
        let mut removed = command.get_envs().filter(|(_, value)| value.is_none());
        assert!(removed.any(|(name, _)| name == "CARGO_MANIFEST_DIR"));
    }

    #[test]
    fn a_missing_program_is_named() {
        let error = run(&mut Command::new("no-such-program"), &mut Silent).unwrap_err();
        assert_eq!(error.to_string(), "no-such-program cannot be started");
    }

    #[test]
    fn what_cargo_is_busy_with_is_no_output() {
        assert!(is_status("   Compiling reflex v0.1.0\n"));
        assert!(!is_status("error: Compiling is over\n"));
        assert!(!is_status("   --> src/lib.rs:1:1\n"));
    }

    #[test]
    fn the_last_line_with_words_is_the_reason() {
        assert_eq!(
            last_line(b"info: trying\nerror: no network\n\n"),
            "error: no network"
        );
        assert_eq!(last_line(b""), "it did not say why");
    }
}

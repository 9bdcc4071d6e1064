//! `docs/commands.md`: every command and option, as they are declared.

use std::fmt::Write;

use clap::{Arg, Command};

use super::cell;

const PREFACE: &str = "\
# Commands

This page is written from the program's own declarations, and a test keeps it so. Every command refuses
wrong input in one line on stderr with exit code 2, and ends with exit code 1 where it fails. With `--json`
a command prints one JSON object on stdout and nothing else there; [reports.md](reports.md) lists the fields.
";

pub(super) fn page(program: &Command) -> String {
    let mut text = vec![PREFACE.to_owned()];
    sections("", program, &mut text);
    text.join("\n")
}

/// The sections of all commands below one, and of those below them.
fn sections(path: &str, command: &Command, text: &mut Vec<String>) {
    let shown = |below: &&Command| !below.is_hide_set() && below.get_name() != "help";
    for below in command.get_subcommands().filter(shown) {
        let path = format!("{path} {}", below.get_name());
        text.push(section(&path, below));
        sections(&path, below, text);
    }
}

fn section(path: &str, command: &Command) -> String {
    let about = command.get_about();
    let mut text = format!("## `cargo hil{path}`\n\n");
    let _ = writeln!(
        text,
        "{}.",
        about.map(ToString::to_string).unwrap_or_default()
    );
    let shown = |argument: &&Arg| !argument.is_hide_set() && argument.get_id() != "help";
    let rows: Vec<String> = command.get_arguments().filter(shown).map(row).collect();
    if !rows.is_empty() {
        let _ = writeln!(text, "\n| option | meaning | default |\n|---|---|---|");
        text.extend(rows);
    }
    text
}

/// One row: the argument as it is typed, its help, its default.
fn row(argument: &Arg) -> String {
    let help = argument.get_help().map(ToString::to_string);
    let help = help.unwrap_or_default();
    let (meaning, default) = match help.split_once(" [default: ") {
        Some((meaning, default)) => (meaning, default.trim_end_matches(']').to_owned()),
        None => (help.as_str(), declared_default(argument)),
    };
    format!(
        "| `{}` | {} | {default} |\n",
        typed(argument),
        cell(meaning)
    )
}

fn declared_default(argument: &Arg) -> String {
    let takes_value = argument.get_action().takes_values();
    match argument.get_default_values() {
        [value] if takes_value => format!("`{}`", value.to_string_lossy()),
        _ => "-".to_owned(),
    }
}

/// The argument as it is typed: `--rate HZ`, `--policy reactive\|periodic`, `LOG`.
fn typed(argument: &Arg) -> String {
    let value = value_of(argument);
    match (argument.get_long(), argument.get_action().takes_values()) {
        (None, _) => value,
        (Some(long), false) => format!("--{long}"),
        (Some(long), true) => format!("--{long} {value}"),
    }
}

fn value_of(argument: &Arg) -> String {
    let choices = argument.get_possible_values();
    if !choices.is_empty() {
        let names: Vec<&str> = choices.iter().map(|choice| choice.get_name()).collect();
        return names.join("\\|");
    }
    let names = argument.get_value_names().unwrap_or_default();
    let names: Vec<String> = names.iter().map(|name| cell(name)).collect();
    names.join(" ")
}

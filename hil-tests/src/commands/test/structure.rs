//! Rules of the sources that no compiler knows, checked on parsed Rust.
//!
//! | file | rule |
//! |---|---|
//! | `naming` | who may name what: chips, clocks, chance, `unsafe`, the emulator |
//! | `layers` | which module may use which, by the layer that it stands in |
//! | `circles` | no two modules use each other, directly or by way of others |
//! | `crates` | which crate of the workspace may depend on which |
//! | `conventions` | headings, places of modules and of tests |
//!
//! An exception that excepts nothing is a fault itself.

mod circles;
mod conventions;
mod crates;
mod layers;
mod modules;
mod naming;
mod source;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use self::modules::Modules;
use self::source::Source;
use crate::progress::Progress;
use crate::toolchain;

/// Folders of Rust sources.
const FOLDERS: [&str; 9] = [
    "bench/",
    "config/",
    "dataflow-language/",
    "dataflow-macros/",
    "drivers/",
    "hil-tests/",
    "settings/",
    "src/",
    "tests/",
];

/// What tests read as text: programs with errors, and a piece of one.
const READ_BY_TESTS: [&str; 2] = ["tests/graph_errors", "tests/random_graphs/functions.rs"];

/// Checks every source file of the workspace, and what its crates depend on.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    let faults = faults(progress)?;
    if let Some(first) = faults.first() {
        progress.output(&format!("{}\n", faults.join("\n")));
        bail!("{first} ({} in all)", faults.len());
    }
    Ok(())
}

/// One line for each fault, with its place.
fn faults(progress: &mut dyn Progress) -> Result<Vec<String>> {
    let sources = sources()?;
    let mut faults = Vec::new();
    for source in &sources {
        faults.extend(conventions::faults(source));
    }
    faults.extend(naming::faults(&sources));
    for root in modules::roots(&sources) {
        let modules = Modules::of(root, &sources);
        faults.extend(circles::faults(&modules));
        faults.extend(layers::faults(&modules));
    }
    faults.extend(crates::faults(progress)?);
    Ok(faults)
}

/// All Rust files, parsed, in the order of their names.
fn sources() -> Result<Vec<Source>> {
    let mut paths = vec![toolchain::root().join("build.rs")];
    for folder in FOLDERS {
        gather(&toolchain::root().join(folder), &mut paths)?;
    }
    paths.sort();
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(toolchain::root()).unwrap_or(path);
        let name = name.to_string_lossy().replace('\\', "/");
        let text = fs::read_to_string(path).with_context(|| name.clone())?;
        Source::parse(&name, text)
    };
    paths.iter().map(read).collect()
}

/// Rust files below a folder, but for [`READ_BY_TESTS`].
fn gather(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<()> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry?.path();
        let name = path.strip_prefix(toolchain::root()).unwrap_or(&path);
        if READ_BY_TESTS.iter().any(|known| name == Path::new(known)) {
            continue;
        }
        if path.is_dir() {
            gather(&path, paths)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            paths.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    #[test]
    fn this_workspace_keeps_every_rule() {
        let faults = faults(&mut Silent).unwrap_or_else(|error| panic!("{error:#}"));
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    }
}

//! Which crate of the workspace may depend on which.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use cargo_metadata::{DependencyKind, MetadataCommand, Package};

use crate::progress::Progress;
use crate::toolchain;

/// Crates of the workspace, each with those of them that it may depend on; tests may use more.
const CRATES: [(&str, &str); 14] = [
    ("random-streams", ""),
    ("chip-models", "random-streams"),
    ("emulated-board", "chip-models"),
    ("flight-dynamics", "random-streams"),
    ("recorded-flights", "chip-models"),
    ("reflex-settings", ""),
    ("reflex-drivers", ""),
    ("reflex-dataflow-language", ""),
    ("reflex-dataflow-macros", "reflex-dataflow-language"),
    ("reflex-bench-macros", "reflex-dataflow-language"),
    ("reflex-config", "reflex-settings"),
    (
        "reflex",
        "reflex-config reflex-dataflow-macros reflex-drivers reflex-settings",
    ),
    ("reflex-bench", "reflex reflex-bench-macros reflex-settings"),
    (
        "hil-tests",
        "chip-models emulated-board flight-dynamics random-streams recorded-flights \
         reflex reflex-bench reflex-config reflex-drivers reflex-settings",
    ),
];
/// Those of `hil-tests/` below `hil-tests` itself: not even their tests may use the autopilot.
const HOST: [&str; 5] = [
    "chip-models",
    "emulated-board",
    "flight-dynamics",
    "random-streams",
    "recorded-flights",
];
/// The autopilot and its settings.
const AUTOPILOT: [&str; 2] = ["reflex", "reflex-config"];
/// The crate that alone may depend on the emulator.
const EMULATOR: (&str, &str) = ("rigless", "emulated-board");
/// Beginnings of the names of crates that only the board has.
const ON_BOARD: [&str; 4] = ["stm32", "cortex-m", "rtic", "defmt-rtt"];

/// A crate and what it depends on: names, and whether for tests only.
type Crates = BTreeMap<String, Vec<(String, bool)>>;

/// One line for each dependency that must not be, and for each entry that is out of date.
pub(super) fn faults(progress: &mut dyn Progress) -> Result<Vec<String>> {
    let manifest = toolchain::root().join("Cargo.toml");
    let mut command = MetadataCommand::new();
    let metadata = command.manifest_path(manifest).no_deps().exec();
    let metadata = metadata.context("the workspace's crates cannot be listed")?;
    let dependencies = |package: &Package| {
        let all = package.dependencies.iter();
        let named = all.map(|it| (it.name.clone(), it.kind == DependencyKind::Development));
        named.collect()
    };
    let packages = metadata.packages.iter();
    let crates = packages.map(|package| (package.name.to_string(), dependencies(package)));
    let mut faults = faults_of(&crates.collect());
    faults.extend(portable_dependencies(progress)?);
    Ok(faults)
}

fn faults_of(crates: &Crates) -> Vec<String> {
    let known = |name: &str| CRATES.iter().find(|(known, _)| *known == name);
    let mut faults = Vec::new();
    for (name, dependencies) in crates {
        let Some((_, allowed)) = known(name) else {
            faults.push(format!(
                "Cargo.toml: {name} has no entry in the table of crates"
            ));
            continue;
        };
        for (other, for_tests) in dependencies {
            let of_workspace = known(other).is_some() && !for_tests;
            let is_allowed = !of_workspace || allowed.split_whitespace().any(|name| name == other);
            let is_unknown = HOST.contains(&name.as_str()) && AUTOPILOT.contains(&other.as_str());
            let takes_emulator = other == EMULATOR.0 && name != EMULATOR.1;
            if !is_allowed || takes_emulator || is_unknown {
                faults.push(format!("Cargo.toml: {name} must not depend on {other}"));
            }
        }
    }
    let gone = CRATES
        .iter()
        .filter(|(name, _)| !crates.contains_key(*name));
    faults.extend(gone.map(|(name, _)| format!("Cargo.toml: there is no crate {name}")));
    faults
}

/// Crates of the board among those that the library brings to a computer.
fn portable_dependencies(progress: &mut dyn Progress) -> Result<Vec<String>> {
    let mut tree = toolchain::cargo();
    tree.args([
        "tree", "-p", "reflex", "--edges", "normal", "--prefix", "none",
    ]);
    let tree = toolchain::run(&mut tree, progress)?;
    let tree = String::from_utf8_lossy(&tree);
    let names = tree
        .lines()
        .filter_map(|line| line.split_whitespace().next());
    Ok(on_board(names))
}

fn on_board<'n>(names: impl Iterator<Item = &'n str>) -> Vec<String> {
    let is_on_board = |name: &&str| ON_BOARD.iter().any(|start| name.starts_with(start));
    names
        .filter(is_on_board)
        .map(|name| format!("Cargo.toml: {name} must not reach the library on a computer"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The workspace as the table has it, with one more dependency.
    fn with(name: &str, other: &str, for_tests: bool) -> Vec<String> {
        let mut crates: Crates = CRATES
            .iter()
            .map(|(name, _)| ((*name).to_owned(), Vec::new()))
            .collect();
        let dependencies = crates.entry(name.to_owned()).or_default();
        dependencies.push((other.to_owned(), for_tests));
        faults_of(&crates)
    }

    #[test]
    fn the_four_host_crates_know_no_autopilot() {
        for name in HOST {
            for for_tests in [false, true] {
                let expected = format!("Cargo.toml: {name} must not depend on reflex");
                assert_eq!(with(name, "reflex", for_tests), [expected]);
            }
        }
        assert!(with("chip-models", "reflex-drivers", true).is_empty());
        assert_eq!(with("chip-models", "reflex-drivers", false).len(), 1);
    }

    #[test]
    fn one_crate_alone_has_the_emulator() {
        assert!(with("emulated-board", "rigless", false).is_empty());
        assert_eq!(
            with("hil-tests", "rigless", false),
            ["Cargo.toml: hil-tests must not depend on rigless"]
        );
    }

    #[test]
    fn a_crate_without_an_entry_and_an_entry_without_a_crate_are_faults() {
        assert_eq!(with("new", "serde", false).len(), 1);
        assert_eq!(faults_of(&Crates::new()).len(), CRATES.len());
    }

    #[test]
    fn crates_of_the_board_are_found() {
        let faults = on_board(["libm", "rtic-time"].into_iter());
        assert_eq!(
            faults,
            ["Cargo.toml: rtic-time must not reach the library on a computer"]
        );
    }
}

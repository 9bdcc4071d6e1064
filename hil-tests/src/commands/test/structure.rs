//! Rules of the sources that no compiler knows: who may name what.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::source_line::{code_of, words_of};
use crate::progress::Progress;
use crate::toolchain;

/// Longest file, in lines.
const LONGEST_FILE: usize = 600;
/// Longest `src/main.rs`, in lines: its tasks only stamp, move bytes and call.
const LONGEST_MAIN: usize = 300;
/// Longest first line of a file, in characters after the `//! `.
const LONGEST_HEADING: usize = 80;

/// Something that code must not say, and where.
struct Rule {
    /// Why, as the message says it.
    reason: &'static str,
    /// Files whose path begins with one of these.
    within: &'static [&'static str],
    /// Of those, not the ones whose path begins with one of these.
    except: &'static [&'static str],
    /// True for code that breaks the rule.
    broken_by: fn(&str) -> bool,
}

const EVERYWHERE: &[&str] = &[
    "src/",
    "settings/",
    "drivers/",
    "config/",
    "dataflow-language/",
    "dataflow-macros/",
    "hil-tests/",
    "bench/",
];

const RULES: [Rule; 7] = [
    Rule {
        reason: "portable code names no chip, no HAL and no framework",
        within: &["src/"],
        except: &["src/main.rs", "src/board", "hil-tests/src/clock.rs"],
        broken_by: |code| words_of(code).any(|word| begins(word, &["stm32", "cortex_m", "rtic"])),
    },
    Rule {
        reason: "the dataflow library uses only core and itself",
        within: &["src/dataflow"],
        except: &["src/dataflow/tests"],
        broken_by: |code| {
            let own = code.replace("crate::dataflow", "");
            ["crate::", "std::", "alloc::", "libm::", "heapless::"]
                .iter()
                .any(|path| own.contains(path))
        },
    },
    Rule {
        reason: "time is an argument: only the application and a report's date read the clock",
        within: EVERYWHERE,
        except: &["src/main.rs", "src/board", "hil-tests/src/clock.rs"],
        broken_by: |code| code.contains("::now()") || code.contains("thread::sleep"),
    },
    Rule {
        reason: "chance has a seed",
        within: EVERYWHERE,
        except: &[],
        broken_by: |code| {
            let unseeded = [
                "rand::rng",
                "rand::random",
                "SysRng",
                "OsRng",
                "RandomState",
            ];
            unseeded.iter().any(|name| code.contains(name))
        },
    },
    Rule {
        reason: "unsafe code stays on the board",
        within: EVERYWHERE,
        except: &["src/board"],
        broken_by: |code| words_of(code).any(|word| word == "unsafe"),
    },
    Rule {
        reason: "only the emulated board names the emulator, so that another can take its place",
        within: EVERYWHERE,
        except: &["hil-tests/board/src/emulated"],
        broken_by: |code| words_of(code).any(|word| word == "rigless"),
    },
    Rule {
        reason: "dt is measured, never taken from a nominal rate",
        within: &["src/control", "src/estimate"],
        except: &[],
        broken_by: |code| {
            code.contains("1.0 / ") && words_of(code).any(|word| word.ends_with("_RATE"))
        },
    },
];

fn begins(word: &str, starts: &[&str]) -> bool {
    starts.iter().any(|start| word.starts_with(start))
}

/// Checks every source file of the workspace, and what the portable library depends on.
pub(super) fn check(progress: &mut dyn Progress) -> Result<()> {
    let mut faults = Vec::new();
    for folder in EVERYWHERE {
        for file in sources(&toolchain::root().join(folder))? {
            let name = file.strip_prefix(toolchain::root()).unwrap_or(&file);
            let name = name.to_string_lossy().replace('\\', "/");
            let text = fs::read_to_string(&file).with_context(|| name.clone())?;
            faults.extend(faults_of(&name, &text));
        }
    }
    faults.extend(portable_dependencies(progress)?);
    if let Some(first) = faults.first() {
        progress.output(&format!("{}\n", faults.join("\n")));
        bail!("{} ({} in all)", first, faults.len());
    }
    Ok(())
}

/// All Rust files below a folder, in the order of their names.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(sources(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// One line for each rule that a file breaks, with its place.
fn faults_of(name: &str, text: &str) -> Vec<String> {
    let mut faults = shape_faults(name, text);
    let rules = RULES
        .iter()
        .filter(|rule| begins(name, rule.within) && !begins(name, rule.except));
    for rule in rules {
        for (place, line) in text.lines().enumerate() {
            if (rule.broken_by)(&code_of(line)) {
                faults.push(format!("{name}:{}: {}", place + 1, rule.reason));
            }
        }
    }
    faults
}

/// Whether a file is short and says what it is.
fn shape_faults(name: &str, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let first = text.lines().next().unwrap_or_default();
    match first
        .strip_prefix("//! ")
        .map(|heading| heading.chars().count())
    {
        Some(..=LONGEST_HEADING) => {}
        Some(_) => faults.push(format!(
            "{name}:1: longer than {LONGEST_HEADING} characters"
        )),
        None => faults.push(format!(
            "{name}:1: must begin with a `//!` line that says what it is"
        )),
    }
    let longest = if name == "src/main.rs" {
        LONGEST_MAIN
    } else {
        LONGEST_FILE
    };
    let lines = text.lines().count();
    if lines > longest {
        faults.push(format!("{name}: {lines} lines, at most {longest}"));
    }
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
    let crates = tree
        .lines()
        .filter_map(|line| line.split_whitespace().next());
    let on_board = crates.filter(|name| begins(name, &["stm32", "cortex-m", "rtic", "defmt-rtt"]));
    Ok(on_board
        .map(|name| format!("Cargo.toml: {name} must not reach the library on a computer"))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(name: &str, line: &str) -> Vec<String> {
        faults_of(name, &format!("//! Heading.\n{line}\n"))
    }

    #[test]
    fn each_rule_holds_where_it_should() {
        for (name, line, expected) in [
            ("src/units.rs", "use stm32f4xx_hal as hal;", "names no chip"),
            (
                "src/dataflow/cell.rs",
                "use crate::units::Thrust;",
                "only core",
            ),
            (
                "src/app.rs",
                "let now = Instant::now();",
                "time is an argument",
            ),
            (
                "hil-tests/src/replay.rs",
                "thread::sleep(second);",
                "time is an argument",
            ),
            (
                "hil-tests/chips/src/noise.rs",
                "let rng = rand::rng();",
                "has a seed",
            ),
            (
                "drivers/src/mpu6050.rs",
                "unsafe { read() }",
                "on the board",
            ),
            (
                "hil-tests/src/replay.rs",
                "use rigless::Session;",
                "another can take its place",
            ),
            (
                "src/control/rate_law.rs",
                "let dt = 1.0 / IMU_RATE;",
                "dt is measured",
            ),
        ] {
            let faults = faults(name, line);
            assert_eq!(faults.len(), 1, "{line}: {faults:?}");
            assert!(faults[0].starts_with(&format!("{name}:2: ")), "{faults:?}");
            assert!(faults[0].contains(expected), "{faults:?}");
        }
    }

    #[test]
    fn what_is_allowed_is_not_reported() {
        for (name, line) in [
            (
                "src/board/spi.rs",
                "unsafe { stm32f4xx_hal::pac::Peripherals::steal() }",
            ),
            ("src/units.rs", "// An STM32 with rtic would be unsafe."),
            ("src/units.rs", "let vertical = particular;"),
            ("src/dataflow/cell.rs", "use crate::dataflow::Dirty;"),
            ("src/lib.rs", "#![forbid(unsafe_code)]"),
            ("hil-tests/board/src/emulated/part.rs", "use rigless::soc;"),
        ] {
            assert_eq!(faults(name, line), Vec::<String>::new(), "{line}");
        }
    }

    #[test]
    fn a_file_says_what_it_is_and_is_short() {
        let long = format!("//! Heading.\n{}", "\n".repeat(LONGEST_FILE));
        for (text, expected) in [
            ("fn main() {}\n", "must begin with"),
            (
                &format!("//! {}\n", "x".repeat(LONGEST_HEADING + 1)),
                "longer than 80",
            ),
            (&long, "601 lines, at most 600"),
        ] {
            let faults = faults_of("src/app.rs", text);
            assert!(faults[0].contains(expected), "{faults:?}");
        }
    }
}

//! Headings, and where modules and tests stand.

use syn::{Item, ItemMod};

use super::source::{Source, is_for_tests};

/// Longest `src/main.rs`, in lines: its tasks only stamp, move bytes and call.
const LONGEST_MAIN: usize = 300;
/// Longest first line of a file, in characters behind the `//! `.
const LONGEST_HEADING: usize = 80;

/// One line for each convention that a file breaks.
pub(super) fn faults(source: &Source) -> Vec<String> {
    let name = &source.name;
    let mut faults = Vec::new();
    match heading(&source.text).map(|heading| heading.chars().count()) {
        Some(..=LONGEST_HEADING) => {}
        Some(_) => faults.push(format!(
            "{name}:1: longer than {LONGEST_HEADING} characters"
        )),
        None => faults.push(format!(
            "{name}:1: must begin with a `//!` line that says what it is"
        )),
    }
    let lines = source.text.lines().count();
    if name == "src/main.rs" && lines > LONGEST_MAIN {
        faults.push(format!("{name}: {lines} lines, at most {LONGEST_MAIN}"));
    }
    // What the targets of `tests/` share needs a `mod.rs`: Cargo takes every file for a target.
    if name.ends_with("/mod.rs") && !name.contains("/tests/") {
        let folder = name.trim_end_matches("/mod.rs");
        faults.push(format!("{name}: must be {folder}.rs, beside its folder"));
    }
    faults.extend(test_faults(source));
    faults
}

fn heading(text: &str) -> Option<&str> {
    text.lines().next()?.strip_prefix("//! ")
}

/// Tests of a file are its module `tests`, at its end or in a file of that name.
fn test_faults(source: &Source) -> Vec<String> {
    let items = &source.file.items;
    let of_item = |(place, item): (usize, &Item)| {
        let Item::Mod(module) = item else {
            return None;
        };
        let line = module.ident.span().start().line;
        let reason = test_fault(module, place + 1 == items.len())?;
        Some(format!("{}:{line}: {reason}", source.name))
    };
    let for_tests = items
        .iter()
        .enumerate()
        .filter(|(_, item)| is_for_tests(item));
    for_tests.filter_map(of_item).collect()
}

fn test_fault(module: &ItemMod, is_last: bool) -> Option<&'static str> {
    let has_path = module.attrs.iter().any(|it| it.path().is_ident("path"));
    if module.ident != "tests" {
        Some("a module for tests is called `tests`")
    } else if has_path {
        Some("tests stand in NAME/tests.rs, without an attribute `path`")
    } else if module.content.is_some() && !is_last {
        Some("tests stand at the end of their file")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults_of(name: &str, text: &str) -> Vec<String> {
        faults(&Source::parse(name, text.to_owned()).expect("Rust"))
    }

    #[test]
    fn a_file_says_what_it_is() {
        let long = format!("//! {}\n", "x".repeat(LONGEST_HEADING + 1));
        for (text, expected) in [
            ("fn main() {}\n", "must begin with"),
            (&long, "longer than 80"),
        ] {
            let faults = faults_of("src/app.rs", text);
            assert!(faults[0].contains(expected), "{faults:?}");
        }
    }

    #[test]
    fn the_table_of_tasks_stays_short() {
        let long = format!("//! Heading.\n{}", "\n".repeat(LONGEST_MAIN));
        let faults = faults_of("src/main.rs", &long);
        assert_eq!(faults, ["src/main.rs: 301 lines, at most 300"]);
        assert!(faults_of("src/app.rs", &long).is_empty());
    }

    #[test]
    fn a_module_lies_beside_its_folder() {
        let faults = faults_of("src/app/mod.rs", "//! Heading.\n");
        assert_eq!(
            faults,
            ["src/app/mod.rs: must be src/app.rs, beside its folder"]
        );
        assert!(faults_of("drivers/tests/common/mod.rs", "//! Heading.\n").is_empty());
    }

    #[test]
    fn tests_stand_at_the_end_in_a_module_of_that_name() {
        for (code, expected) in [
            ("#[cfg(test)]\nmod checks;\n", "is called `tests`"),
            ("#[cfg(test)]\nmod tests {}\nfn f() {}\n", "at the end"),
            (
                "#[cfg(test)]\n#[path = \"a.rs\"]\nmod tests;\n",
                "attribute `path`",
            ),
        ] {
            let faults = faults_of("src/app.rs", &format!("//! Heading.\n{code}"));
            assert_eq!(faults.len(), 1, "{faults:?}");
            assert!(faults[0].contains(expected), "{faults:?}");
        }
        let good = "//! Heading.\n#[cfg(test)]\nmod tests;\nfn f() {}\n";
        assert!(faults_of("src/app.rs", good).is_empty());
    }
}

//! Who may name what.

use super::source::{Mention, Source};

/// Something that code must not name, and where.
struct Rule {
    /// Why, as the message says it.
    reason: &'static str,
    /// Files whose path begins with one of these.
    within: &'static [&'static str],
    /// Of those, not the ones whose path begins with one of these: each must except something.
    except: &'static [&'static str],
    /// True for a mention that breaks the rule.
    broken_by: fn(&Mention) -> bool,
}

const EVERYWHERE: &[&str] = &[""];

const RULES: [Rule; 7] = [
    Rule {
        reason: "portable code names no chip, no HAL and no framework",
        within: &["src/"],
        except: &["src/main.rs", "src/board"],
        broken_by: |mention| {
            let on_board = ["stm32", "cortex_m", "rtic"];
            let is_on_board = |word: &String| on_board.iter().any(|start| word.starts_with(start));
            mention.path.iter().any(is_on_board)
        },
    },
    Rule {
        reason: "the dataflow library uses only core and itself",
        within: &["src/dataflow"],
        except: &[],
        broken_by: |mention| match mention.path.first().map(String::as_str) {
            Some("crate") => mention.path.get(1).is_some_and(|next| next != "dataflow"),
            Some("std" | "alloc" | "libm" | "heapless") => mention.path.len() > 1,
            _ => false,
        },
    },
    Rule {
        reason: "time is an argument: only the application and a report's date read the clock",
        within: EVERYWHERE,
        except: &["src/main.rs", "src/board", "hil-tests/src/clock.rs"],
        broken_by: |mention| {
            let reads = mention.path.len() > 1 && mention.path.ends_with(&["now".to_owned()]);
            reads || ends(mention, &["thread", "sleep"])
        },
    },
    Rule {
        reason: "chance has a seed",
        within: EVERYWHERE,
        except: &[],
        broken_by: |mention| {
            let unseeded = ["SysRng", "OsRng", "RandomState"];
            let is_unseeded = |word: &String| unseeded.contains(&word.as_str());
            mention.path.iter().any(is_unseeded)
                || ends(mention, &["rand", "rng"])
                || ends(mention, &["rand", "random"])
        },
    },
    Rule {
        reason: "unsafe code stays on the board",
        within: EVERYWHERE,
        except: &[
            "src/board",
            "hil-tests/board/src/emulated/metered.rs",
            // Calls the compiler's library by its symbols.
            "bench/src/soft_floats.rs",
        ],
        broken_by: |mention| mention.path == ["unsafe"],
    },
    Rule {
        reason: "only the emulated board names the emulator, so that another can take its place",
        within: EVERYWHERE,
        except: &["hil-tests/board/src/emulated"],
        broken_by: |mention| mention.path.iter().any(|word| word == "rigless"),
    },
    Rule {
        reason: "dt is measured, never taken from a nominal rate",
        within: &["src/control", "src/estimate"],
        except: &[],
        broken_by: |mention| {
            let is_rate = |word: &String| word.ends_with("_RATE");
            mention.is_inverted && mention.path.last().is_some_and(is_rate)
        },
    },
];

fn ends(mention: &Mention, words: &[&str]) -> bool {
    let skipped = mention.path.len().checked_sub(words.len());
    skipped.is_some_and(|skipped| mention.path[skipped..] == *words)
}

/// One line for each mention that breaks a rule, and for each exception that excepts nothing.
pub(super) fn faults(sources: &[Source]) -> Vec<String> {
    RULES.iter().flat_map(|rule| rule.faults(sources)).collect()
}

impl Rule {
    fn faults(&self, sources: &[Source]) -> Vec<String> {
        let mut faults = Vec::new();
        let mut used = vec![false; self.except.len()];
        for source in sources {
            if !self
                .within
                .iter()
                .any(|start| source.name.starts_with(start))
            {
                continue;
            }
            for mention in &source.mentions {
                if !(self.broken_by)(mention) {
                    continue;
                }
                let mut exceptions = self.except.iter();
                match exceptions.position(|start| source.name.starts_with(start)) {
                    Some(exception) => used[exception] = true,
                    None => {
                        faults.push(format!("{}:{}: {}", source.name, mention.line, self.reason))
                    }
                }
            }
        }
        let unused = self.except.iter().zip(used).filter(|(_, used)| !used);
        faults.extend(unused.map(|(exception, _)| {
            format!(
                "{exception}: nothing is excepted there from: {}",
                self.reason
            )
        }));
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of one line of code, apart from exceptions that are not needed.
    fn faults_of(name: &str, line: &str) -> Vec<String> {
        let text = format!("//! Heading.\n{line}\n");
        let source = Source::parse(name, text).expect("Rust");
        let mut faults = faults(&[source]);
        faults.retain(|fault| fault.starts_with(name) && !fault.contains("nothing is excepted"));
        faults
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
                "fn f() { let now = Instant::now(); }",
                "time is an argument",
            ),
            (
                "hil-tests/src/replay.rs",
                "fn f() { thread::sleep(second); }",
                "time is an argument",
            ),
            (
                "hil-tests/chips/src/noise.rs",
                "fn f() { let rng = rand::rng(); }",
                "has a seed",
            ),
            (
                "drivers/src/mpu6050.rs",
                "fn f() { unsafe { read() } }",
                "on the board",
            ),
            (
                "hil-tests/src/replay.rs",
                "use rigless::Session;",
                "another can take its place",
            ),
            (
                "src/control/rate_law.rs",
                "fn f() { let dt = 1.0 / IMU_RATE; }",
                "dt is measured",
            ),
        ] {
            let faults = faults_of(name, line);
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
                "fn f() { unsafe { stm32f4xx_hal::pac::Peripherals::steal() }; }",
            ),
            ("src/units.rs", "// An STM32 with rtic would be unsafe."),
            ("src/units.rs", "fn f() { let vertical = particular; }"),
            ("src/dataflow/cell.rs", "use crate::dataflow::Dirty;"),
            ("src/lib.rs", "const UNSAFE: bool = unsafe_code;"),
            ("hil-tests/board/src/emulated/part.rs", "use rigless::soc;"),
        ] {
            assert_eq!(faults_of(name, line), Vec::<String>::new(), "{line}");
        }
    }

    #[test]
    fn an_exception_that_excepts_nothing_is_a_fault() {
        let used = Source::parse("src/main.rs", "use rtic::app;".to_owned()).expect("Rust");
        let faults = RULES[0].faults(&[used]);
        assert_eq!(
            faults,
            [
                "src/board: nothing is excepted there from: portable code names no chip, no HAL and \
              no framework"
            ]
        );
    }
}

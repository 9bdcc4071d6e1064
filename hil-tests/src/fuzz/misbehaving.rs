//! Targets that fail at one input of ten: they test the harness itself.

use std::hint::black_box;

use anyhow::Result;

use super::{Loaded, Source, Target};

/// One for each way.
pub(super) const MISBEHAVING: [Target; 4] = [
    failing("panics", || {
        loaded(|bad| {
            assert!(!bad, "a word for the user");
            true
        })
    }),
    failing("overflows", || loaded(|bad| !bad || deep(1) > 0)),
    failing("hoards", || {
        loaded(|bad| !black_box(vec![1_u8; if bad { 600 << 20 } else { 1 }]).is_empty())
    }),
    failing("hangs", || {
        loaded(|bad| {
            while black_box(bad) {}
            true
        })
    }),
];

const fn failing(name: &'static str, load: fn() -> Result<Loaded>) -> Target {
    Target {
        name,
        reads: "nothing",
        inputs: 100,
        load,
    }
}

/// One input of ten is bad.
fn loaded(check: fn(bool) -> bool) -> Result<Loaded> {
    let source = Source::Made(|from| Ok(vec![from.int_in_range(0..=9)?]));
    Ok(Loaded::new(source, move |input| check(input == [9])))
}

#[allow(unconditional_recursion, reason = "it is what is to be found")]
fn deep(level: u64) -> u64 {
    let page = black_box([level; 512]);
    black_box(deep(level + 1)) + page[7]
}

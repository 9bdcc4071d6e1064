//! Marks around what is measured: the watcher finds them by name.

use core::hint::black_box;

use crate::Part;

/// Measures a part as often as it asks for.
pub fn rounds(part: Part, each: impl FnMut(usize)) {
    (0..part.rounds).for_each(each);
}

/// Calls what is measured between two marks.
#[inline(always)]
pub fn measured<T>(call: impl FnOnce() -> T) -> T {
    mark();
    let result = black_box(call());
    mark();
    result
}

/// The instant that is watched.
#[inline(never)]
fn mark() {
    black_box(());
}

/// Nothing is measured any more.
#[inline(never)]
pub fn done() {
    black_box(true);
}

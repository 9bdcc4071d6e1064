//! Two measurements are equal, and a limit that is passed is named.

use super::table::{Cost, Costs, Memory};
use super::{CORE_HZ, measure};
use crate::progress::Silent;

#[test]
fn two_measurements_are_equal_and_within_their_limits() {
    let [first, second] = [(); 2].map(|()| measure(&[], &mut Silent).expect("measured"));
    assert_eq!(first, second);
    assert_eq!(first.over(), None);
}

#[test]
fn the_first_part_over_its_limit_is_named() {
    let cost = |name, counts: &[u64], limit| Cost::of(name, counts.to_vec(), limit, CORE_HZ);
    let mut costs = Costs {
        core_hz: CORE_HZ,
        parts: vec![cost("free", &[9], None), cost("test", &[60, 7], Some(60))],
        hover: Vec::new(),
        logics: Vec::new(),
        firmware: Memory {
            flash: 1,
            ram: 2,
            stack: 3,
        },
        locks: vec![cost("lock", &[840], Some(840))],
    };
    assert_eq!(costs.over(), None, "a limit may be used up");
    costs.locks[0].instructions += 1;
    let line = "lock takes 841 instructions, its limit is 840";
    assert_eq!(costs.over().as_deref(), Some(line));
}

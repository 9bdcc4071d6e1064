//! Every scenario that needs no wires ends as its file says, natively.

use hil_tests::closed_loop::Flyer;
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;
use hil_tests::scenarios::{Scenarios, fly_all, fly_random, read_all};

fn flown(seeds: &[u32]) -> Scenarios {
    let scenarios = read_all(true).unwrap();
    assert!(scenarios.len() >= 50, "{}", scenarios.len());
    let of = (LogicName::configured(), seeds);
    let scenarios = fly_all(&scenarios, of, Flyer::Native, &mut Silent).unwrap();
    Scenarios { scenarios }
}

#[test]
fn every_scenario_ends_as_its_file_says() {
    let flown = flown(&[1]);
    assert!(
        flown.surprises().is_empty(),
        "{:?}\n{}",
        flown.surprises(),
        flown.table()
    );
}

#[test]
fn no_command_is_out_of_range_and_no_run_missing_with_other_seeds() {
    let flown = flown(&[2, 3, 4, 5]).scenarios.into_iter();
    let missed = flown.flat_map(|report| report.missed);
    let failed =
        missed.filter(|line| line.contains("bad commands") || line.contains("without a run"));
    assert_eq!(failed.collect::<Vec<_>>(), Vec::<String>::new());
}

#[test]
fn random_scripts_break_no_promise_but_by_known_weaknesses() {
    let of = (LogicName::configured(), Flyer::Native);
    let random = fly_random((200, 1), of, &mut Silent).unwrap();
    assert_eq!(random.surprises(), 0, "{}", random.summary());
    assert!(
        random.told > 100 && random.harmless > 0,
        "{}",
        random.summary()
    );
}

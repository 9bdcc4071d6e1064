//! Scenarios end as their files say, and random scripts break no promise.

use hil_tests::closed_loop::{Core, Flyer};
use hil_tests::firmware::Firmware;
use hil_tests::logics::LogicName;
use hil_tests::progress::Silent;
use hil_tests::scenarios::{Scenarios, fly_all, fly_random, read_all};

#[test]
fn every_scenario_ends_natively_as_its_file_says() {
    let scenarios = read_all(true).unwrap();
    assert!(scenarios.len() >= 50, "{}", scenarios.len());
    let of = (LogicName::configured(), &[1][..]);
    let scenarios = fly_all(&scenarios, of, Flyer::Native, &mut Silent).unwrap();
    let flown = Scenarios { scenarios };
    assert!(
        flown.surprises().is_empty(),
        "{:?}\n{}",
        flown.surprises(),
        flown.table()
    );
}

/// With the bounds of sensors.toml, 30 degrees from level among them.
#[test]
fn no_fault_of_a_sensor_does_more_than_its_file_says_with_three_logics_under_five_seeds() {
    let mut scenarios = read_all(true).unwrap();
    scenarios.retain(|scenario| scenario.file() == "sensors");
    let seeds = [1, 2, 3, 4, 5];
    let logics = [
        LogicName::Cascade,
        LogicName::ArduCopter,
        LogicName::OpenPilot,
    ];
    let flown = logics
        .map(|logic| fly_all(&scenarios, (logic, &seeds[..]), Flyer::Native, &mut Silent).unwrap());
    let scenarios = flown.concat();
    assert!(scenarios.len() >= 450, "{}", scenarios.len());
    let flown = Scenarios { scenarios };
    assert!(flown.surprises().is_empty(), "{}", flown.table());
}

/// The whole of them is flown by hand: `cargo hil faults`.
#[test]
fn some_scenarios_end_on_the_emulated_board_as_their_files_say() {
    const SOME: [&str; 5] = [
        "gyro_axis_stuck",
        "imu_line_deaf_10",
        "accel_threshold_bit",
        "link_silent_2s",
        "data_held_50ms",
    ];
    let mut scenarios = read_all(false).unwrap();
    scenarios.retain(|scenario| SOME.contains(&scenario.name()));
    assert_eq!(scenarios.len(), SOME.len());
    let logic = LogicName::configured();
    let firmware = Firmware::build(logic, &mut Silent).unwrap();
    let flyer = Flyer::Emulated(Core::of(&firmware));
    let scenarios = fly_all(&scenarios, (logic, &[1][..]), flyer, &mut Silent).unwrap();
    let flown = Scenarios { scenarios };
    assert!(flown.surprises().is_empty(), "{}", flown.table());
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

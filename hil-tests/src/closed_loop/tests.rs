//! Whole flights in closed loop: they stay up, they repeat, and both tiers hold.

pub(crate) mod alarms;
mod physics;

use super::*;
use crate::firmware::Firmware;
use crate::logics::{GainSet, LogicName};
use crate::progress::Silent;
use clap::ValueEnum;
use reflex::settings::Policy;
use reflex::time::{Duration, micros};

/// A short flight of a logic, natively.
fn flown(environment: &str, options: &FlyOptions) -> FlightReport {
    let scene = Scene::load(environment, reflex::config::AIRFRAME, None).unwrap();
    let flown = fly(&scene, options, Flyer::Native, &mut Silent).unwrap();
    flown.report
}

fn options(logic: LogicName, policy: Policy, seed: u32) -> FlyOptions {
    FlyOptions {
        gains: logic.into(),
        settings: Settings {
            policy,
            // Of periodic control, where it is chosen.
            period: BY_THE_CLOCK,
            seed,
            ..reflex::config::SETTINGS
        },
        mission: Mission::Waypoints,
        duration_s: 30.0,
        scored_from_s: None,
        stress: Stress::default(),
        faults: Script::default(),
        record: None,
        contention: Contention::default(),
    }
}

const BY_THE_CLOCK: Duration = micros(2_500);

#[test]
fn every_logic_stays_up_in_wind_with_either_policy() {
    for logic in LogicName::value_variants() {
        for policy in [Policy::Reactive, Policy::Periodic] {
            let report = flown("arch", &options(*logic, policy, 3));
            assert_eq!(report.crash_text(), None, "{logic:?} {policy:?}");
            let pitch = report.attitude_error_deg.pitch.unwrap();
            assert!(pitch < 15.0, "{logic:?} {policy:?} pitch {pitch}");
            assert!(report.flight_time_s.unwrap() > 300.0);
        }
    }
}

#[test]
fn periodic_control_keeps_its_rate_and_reactive_control_spares_runs() {
    let periodic = flown("lab", &options(LogicName::Cascade, Policy::Periodic, 1));
    let rate_hz = periodic.control.rate_hz.unwrap();
    assert!((rate_hz - 400.0).abs() < 10.0, "{rate_hz}");
    let reactive = flown("lab", &options(LogicName::Cascade, Policy::Reactive, 1));
    let by_reason = reactive.control.by_reason;
    assert!(by_reason.trigger > 0 && by_reason.periodic == 0);
    assert!(reactive.control.rate_hz.unwrap() < 400.0);
}

#[test]
fn the_same_seed_flies_the_same_flight_and_another_seed_another() {
    let of = |seed| {
        flown(
            "rugby",
            &options(LogicName::ArduCopter, Policy::Reactive, seed),
        )
    };
    let first = of(5);
    assert_eq!(first, of(5));
    assert_ne!(first.digest, of(6).digest);
    let periodic = flown(
        "rugby",
        &options(LogicName::ArduCopter, Policy::Periodic, 5),
    );
    assert!(first.scored_from_s == periodic.scored_from_s);
    // Looked at within half a millisecond of the same instants; `world` compares the winds exactly.
    let [here, there] = [&first, &periodic].map(|report| report.wind_m_s.unwrap());
    assert!((here / there - 1.0).abs() < 1e-4, "{here} {there}");
}

/// A crash is no number: where the scored part would be, there is nothing.
#[test]
fn a_drone_that_cannot_lift_itself_crashes_or_stays_but_scores_no_lie() {
    let mut scene = Scene::load("arch", reflex::config::AIRFRAME, None).unwrap();
    // Half of the thrust that it takes to turn against the wind, and none to spare.
    scene.vehicle.rotors.full_thrust_n = 3.4;
    let mut options = options(LogicName::Cascade, Policy::Reactive, 2);
    options.duration_s = 60.0;
    let report = fly(&scene, &options, Flyer::Native, &mut Silent)
        .unwrap()
        .report;
    if report.crashed {
        let errors = report.attitude_error_deg;
        assert_eq!((errors.roll, errors.pitch, errors.yaw), (None, None, None));
        assert_eq!(
            (report.position_error_m, report.flight_time_s),
            (None, None)
        );
    } else {
        assert!(report.position_error_m.unwrap() > 1.0, "{report:?}");
    }
}

/// The firmware checks itself against the host on the way; see `emulated`.
#[test]
fn the_firmware_flies_in_closed_loop_and_comes_to_the_hosts_commands_bit_by_bit() {
    let scene = Scene::load("arch", reflex::config::AIRFRAME, None).unwrap();
    let mut options = options(LogicName::configured(), Policy::Reactive, 4);
    options.duration_s = 14.0;
    let firmware = Firmware::build(options.gains.logic(), &mut Silent).unwrap();
    let fly = || {
        let flyer = Flyer::Emulated(Core::of(&firmware));
        fly(&scene, &options, flyer, &mut Silent).unwrap().report
    };
    let report = fly();
    assert_eq!(report.crash_text(), None);
    assert!(report.control.by_reason.trigger > 0);
    let busy = report.cpu.unwrap().busy_fraction;
    assert!((0.005..0.9).contains(&busy), "{busy}");
    // Measured over the converter, whose calls the host made too.
    assert_eq!(report.battery.state, "good");
    assert_eq!(report, fly(), "the same flight again");
    // Natively samples differ by microseconds, and with them everything a little.
    let native = super::fly(&scene, &options, Flyer::Native, &mut Silent)
        .unwrap()
        .report;
    let (here, there) = (
        report.control.rate_hz.unwrap(),
        native.control.rate_hz.unwrap(),
    );
    assert!((here / there - 1.0).abs() < 0.25, "{here} {there}");
}

/// Airframe and gains reach it in the settings block; it checks itself against the host.
#[test]
fn the_same_firmware_flies_another_airframe_with_faster_loops() {
    let scene = Scene::load("lab", "hexa_x", None).unwrap();
    let mut options = options(LogicName::configured(), Policy::Reactive, 6);
    options.gains = GainSet::load(LogicName::configured(), None, 1.4).unwrap();
    options.duration_s = 11.0;
    let firmware = Firmware::build(options.gains.logic(), &mut Silent).unwrap();
    let flown = fly(
        &scene,
        &options,
        Flyer::Emulated(Core::of(&firmware)),
        &mut Silent,
    )
    .unwrap();
    assert_eq!(flown.report.crash_text(), None);
    assert_eq!(flown.report.airframe, "hexa_x");
    assert!(flown.report.control.by_reason.trigger > 0);
    assert!(flown.report.attitude_error_deg.roll.unwrap() < 5.0);
}

#[test]
fn control_at_a_low_rate_has_less_of_a_delay_margin_than_reactive_control() {
    let turning = |policy| {
        let mut options = options(LogicName::OpenPilot, policy, 1);
        options.settings.period = micros(40_000);
        options.mission = Mission::Hover;
        options.stress = Stress {
            gain: 3.0,
            ..Stress::default()
        };
        let report = flown("lab", &options);
        report.turning_rad_s.unwrap_or(f64::INFINITY)
    };
    let [reactive, slow] = [Policy::Reactive, Policy::Periodic].map(turning);
    assert!(reactive < 0.1 && slow > 0.5, "{reactive} {slow}");
}

//! Whole replays: the firmware on its board, fed with real flights.

mod load;

use std::path::PathBuf;

use reflex::sensors::{Input, Inputs};
use reflex::settings::{Feedback, MotorProtocol, Pairs, Policy, Reference, Settings, WarmUp};
use reflex::time::micros;

use super::replay;
use crate::progress::Silent;
use crate::replay::options::ReplayOptions;
use crate::scoring::Report;
use recorded_flights::recordings::recording;

fn fly(options: &ReplayOptions) -> Report {
    replay(options, &mut Silent).unwrap_or_else(|error| panic!("{error:#}"))
}

/// The flight that every machine has, cut short.
fn seconds(length: f64, settings: Settings) -> ReplayOptions {
    ReplayOptions {
        duration_s: Some(length),
        settings,
        ..ReplayOptions::default()
    }
}

/// What must hold of every flight that reaches reactive control.
fn check(report: &Report) {
    let (run, control) = (&report.run, &report.score.section.control);
    for sensor in run.sensors.iter().filter(|sensor| sensor.present) {
        // A chip that compares may rightly be silent.
        let speaks = sensor.interrupts > 0 || sensor.chip_threshold.is_some();
        assert!(speaks, "{}: {sensor:?}", run.log);
    }
    assert!(control.by_reason.trigger > 0, "{}", run.log);
    assert!(control.runs < report.score.hyperperiods, "{}", run.log);
    let lead = run.sensors.last().expect("what is owed");
    assert_eq!(lead.name, "impulse_owed");
    let whole_way = run.latency_parts_us.last().expect("parts");
    let micros = whole_way.micros.expect("runs that the gyro asked for");
    assert!(micros.max < 900.0, "{}: {micros:?}", run.log);
    // The gyroscope's model may ask before what is owed does.
    let asked = lead.triggers..=control.by_reason.trigger;
    assert!(asked.contains(&micros.count), "{}: runs unmatched", run.log);
    let unexpected = [
        "imu_bus",
        "imu_overrun",
        "imu_stale",
        "imu_configuration",
        "imu_glitch",
        "imu_line",
        "imu_edge",
        "chip_bus",
        "link_frame",
        "link_overrun",
    ];
    for counter in unexpected {
        assert_eq!(run.counters[counter], 0, "{}: {counter}", run.log);
    }
    assert_eq!(run.counters["log_frames_damaged"], 0, "{}", run.log);
}

#[test]
fn the_flight_that_comes_with_the_crates_is_flown_reactively() {
    let report = fly(&ReplayOptions::default());
    check(&report);
    assert!(report.score.duration_s > 68.0);
}

/// Where the foreseen command or the gyroscope reports first, the chips have nothing to say; and what
/// calls for a run with less certainty is finer than one of their codes.
fn led_by_the_angle() -> Settings {
    Settings {
        triggers: Inputs::NONE
            .with(Input::Turned)
            .with(Input::ChipAccel)
            .with(Input::ChipMag),
        p_run: 0.9,
        ..reflex::config::SETTINGS
    }
}

fn check_recording(name: &str) {
    let Some(log) = recording(name) else {
        return;
    };
    check(&fly(&ReplayOptions {
        log: Some(log),
        ..ReplayOptions::default()
    }));
}

/// One test per recording: they run side by side and fail by name.
macro_rules! recordings {
    ($($test:ident: $file:literal,)*) => {
        $(#[test]
        fn $test() {
            check_recording($file);
        })*
    };
}

recordings! {
    a_phantom_slalom_is_flown: "csv/ansfl_phantom4_h11.csv",
    a_solo_crash_is_flown: "csv/ap33_solo_acro_crash_mpu6000_lsm303d.csv",
    a_solo_loiter_is_flown: "csv/ap33_solo_loiter_mpu6000_lsm303d.csv",
    a_gecko_cruise_is_flown: "csv/bf42_gecko_cruise.csv",
    a_kakute_hover_is_flown: "csv/bf42_kakutef7_ar8_hover.csv",
    a_speedybee_freestyle_is_flown: "csv/bf45_speedybee_freestyle.csv",
    an_unfiltered_freestyle_is_flown: "csv/bf45_speedybee_freestyle_unfilt.csv",
    a_vibrating_hexarotor_is_flown: "csv/px4_v5_hexa_vib.csv",
    a_calm_hover_is_flown: "csv/px4_v6c_quad_calm.csv",
    a_hexarotor_s_ulog_is_flown: "raw/px4_v5_hexa_vib.ulg",
    a_calm_hover_s_ulog_is_flown: "raw/px4_v6c_quad_calm.ulg",
}

#[test]
fn thresholds_of_fitted_models_decide_when_the_chip_interrupts() {
    let Some(log) = recording("csv/ap33_solo_loiter_mpu6000_lsm303d.csv") else {
        return;
    };
    let report = fly(&ReplayOptions {
        log: Some(log),
        duration_s: Some(40.0),
        settings: led_by_the_angle(),
        ..ReplayOptions::default()
    });
    let chips = &report.run.sensors[2..4];
    assert!(
        chips
            .iter()
            .any(|sensor| sensor.chip_thresholds_set > 0 && sensor.chip_crossings > 0)
    );
}

#[test]
fn the_same_replay_writes_the_same_motors_at_the_same_instants() {
    let options = seconds(6.0, reflex::config::SETTINGS);
    assert_eq!(fly(&options), fly(&options));
}

#[test]
fn another_seed_is_another_flight() {
    let other = Settings {
        seed: 2,
        ..reflex::config::SETTINGS
    };
    let digests =
        [reflex::config::SETTINGS, other].map(|settings| fly(&seconds(4.0, settings)).run.digest);
    assert_ne!(digests[0], digests[1]);
}

#[test]
fn periodic_control_runs_at_its_rate_and_asks_no_model() {
    let report = fly(&seconds(
        5.0,
        Settings {
            policy: Policy::Periodic,
            period: micros(4_000),
            ..reflex::config::SETTINGS
        },
    ));
    let control = &report.score.section.control;
    assert_eq!(control.by_reason.trigger, 0);
    assert!(report.run.sensors.iter().all(|sensor| sensor.triggers == 0));
    let rate = control.by_reason.periodic as f64 / 5.0;
    assert!((rate - 250.0).abs() < 2.5, "{rate} Hz");
}

#[test]
fn no_option_needs_another_firmware() {
    let report = fly(&seconds(
        8.0,
        Settings {
            reference: Reference::PreviousSample,
            warm_up: WarmUp::Fixed(micros(4_000_000)),
            warm_up_period: micros(2_500),
            failsafe: micros(50_000),
            motors: MotorProtocol::Pwm,
            p_run: 0.4,
            quantum: 0.002,
            triggers: Inputs::OF_AXES,
            pairs: Pairs::WeightedLags,
            feedback: Feedback::Published,
            seed: 9,
            policy: Policy::Reactive,
            ..reflex::config::SETTINGS
        },
    ));
    assert!(
        (report.score.warm_up_s - 4.0).abs() < 0.6,
        "{}",
        report.score.warm_up_s
    );
    let options = serde_json::to_value(&report.run.options).expect("JSON");
    assert_eq!(
        (&options["motors"], &options["failsafe_s"]),
        (&"pwm".into(), &0.05.into())
    );
    assert_eq!(
        (&options["reference"], &options["p_run"]),
        (&"previous-sample".into(), &0.4.into())
    );
}

#[test]
fn a_log_that_is_not_there_is_refused_before_anything_is_built() {
    let options = ReplayOptions {
        log: Some(PathBuf::from("no/such.ulg")),
        ..ReplayOptions::default()
    };
    let error = replay(&options, &mut Silent).expect_err("no such file");
    assert!(format!("{error:#}").contains("no/such.ulg"));
}

//! A battery that runs empty; iron and motors near the magnetometer.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use reflex::app::Call;
use reflex::config::SETTINGS;
use reflex::sensors::Input;
use reflex_config::plant::Magnetometer;

use super::*;
use crate::closed_loop::bent_field::BentField;
use crate::logics::Start;
use crate::magnetometer::find;
use crate::native::NativeBoard;
use chip_models::{ChipOptions, Stimulus, StimulusSource};

fn hovering(scene: &Scene, settings: Settings, mission: Mission, duration_s: f64) -> FlightReport {
    let options = FlyOptions {
        settings,
        mission,
        duration_s,
        ..options(LogicName::Cascade, Policy::Reactive, 1)
    };
    fly(scene, &options, Flyer::Native, &mut Silent)
        .unwrap()
        .report
}

/// Of three cells and of four: the firmware counts them.
#[test]
fn a_battery_that_runs_empty_is_warned_of_and_ends_the_flight_on_the_ground() {
    for airframe in ["quad_x", "hexa_x"] {
        let mut scene = Scene::load("lab", airframe, None).unwrap();
        // Its voltage falls within the first tenth of its charge.
        scene.vehicle.battery.open_circuit = vec![[0.9, 3.3], [1.0, 4.2]];
        let report = hovering(&scene, SETTINGS, Mission::Hover, 600.0);
        assert_eq!(report.crash_text(), None, "{airframe}");
        let battery = &report.battery;
        assert_eq!(battery.state, "critical", "{battery}");
        let when = [battery.low_s, battery.critical_s, battery.ended_s];
        let when = when.map(|at_s| at_s.unwrap_or_else(|| panic!("{battery}")));
        assert!(when.is_sorted() && when[0] > 20.0, "{battery}");
        assert!((report.duration_s - when[2]).abs() < 0.1, "{report:?}");
        let text = report::summary(&report);
        assert!(text.contains("the flight ends there"), "{text}");
    }
}

/// It has its voltage to the last: nothing warns.
#[test]
fn a_drone_that_falls_with_an_empty_battery_is_said_to() {
    let mut scene = Scene::load("lab", "quad_x", None).unwrap();
    scene.vehicle.battery.capacity_ah = 0.1;
    scene.vehicle.battery.open_circuit = vec![[0.0, 4.1]];
    let report = hovering(&scene, SETTINGS, Mission::Hover, 600.0);
    let crash = report.crash_text().expect("it falls");
    assert!(crash.contains("the battery empty,"), "{crash}");
    assert_eq!(report.battery.charge, 0.0);
    let empty_s = report.battery.empty_s.expect("it is empty");
    assert!(
        (empty_s..empty_s + 3.0).contains(&report.duration_s),
        "{report:?}"
    );
}

/// The field as the firmware reads it of a board that is turned all round, motors off.
fn turned(magnetometer: &Magnetometer) -> Vec<[f64; 3]> {
    let bent = BentField::of(magnetometer);
    let source: Arc<dyn StimulusSource> = Arc::new(move |at_ns: u64| {
        // Two slow turns at once, whose rates have no common period.
        let at_s = at_ns as f64 * 1e-9;
        let attitude = UnitQuaternion::from_euler_angles(0.31 * at_s, 0.0, 0.0)
            * UnitQuaternion::from_euler_angles(0.0, 0.173 * at_s, 0.0);
        let body = attitude.inverse();
        Stimulus {
            specific_force: (body * Vector3::new(0.0, 0.0, -9.806_65)).into(),
            magnetic_field: bent
                .around(body * Vector3::new(0.21, 0.0, 0.43), 0.0)
                .into(),
            temperature_c: 25.0,
            ..Stimulus::default()
        }
    });
    let scene = Scene::load("lab", reflex::config::AIRFRAME, None).unwrap();
    let start = Start {
        settings: SETTINGS,
        airframe: scene.airframe.geometry(),
        gains: GainSet::from(LogicName::Cascade).values(),
    };
    let chips = ChipOptions {
        noise: true,
        seed: 1,
        ..ChipOptions::default()
    };
    let mut board = NativeBoard::boot(&start, &source, chips, Vec::new());
    board.run_until(150_000_000_000);
    let calls = board.take_calls();
    let fields = calls.iter().filter_map(|stamped| match stamped.call {
        Call::Chip(sample) if sample.input == Input::ChipMag => Some(sample.axes),
        _ => None,
    });
    fields.map(|axes| axes.to_array().map(f64::from)).collect()
}

fn in_the_lab(magnetometer: Magnetometer) -> Scene {
    let mut scene = Scene::load("lab", reflex::config::AIRFRAME, None).unwrap();
    scene.vehicle.magnetometer = magnetometer;
    scene
}

#[test]
fn iron_that_turning_the_board_shows_is_iron_no_more() {
    let magnetometer = Magnetometer {
        hard_iron_gauss: [0.08, 0.05, -0.04],
        ..Magnetometer::default()
    };
    let found = find(&turned(&magnetometer)).unwrap_or_else(|line| panic!("{line}"));
    let settings = Settings {
        hard_iron: found.hard.map(|axis| axis as f32).into(),
        soft_iron_diagonal: found.soft.diagonal().map(|axis| axis as f32).into(),
        ..SETTINGS
    };
    let yaw = |settings| {
        let report = hovering(&in_the_lab(magnetometer), settings, Mission::Turn, 70.0);
        report.attitude_error_deg.yaw.unwrap_or(f64::INFINITY)
    };
    let errors = [SETTINGS, settings].map(yaw);
    assert!(errors[0] > 10.0 && errors[1] < 2.0, "{errors:?}");
}

/// A weak one is followed, as drift is; a strong one would turn the drone by 45 degrees, and is not.
#[test]
fn the_field_of_motors_bends_the_heading_until_it_is_too_strong_to_be_earths() {
    let yaw = |gauss_per_a: f64| {
        let scene = in_the_lab(Magnetometer {
            motor_gauss_per_a: [0.0, gauss_per_a, 0.0],
            ..Magnetometer::default()
        });
        let report = hovering(&scene, SETTINGS, Mission::Hover, 20.0);
        report.attitude_error_deg.yaw.expect("it flies")
    };
    let [none, weak, strong] = [0.0, 0.002, 0.02].map(yaw);
    assert!(
        none < 2.0 && (3.0..12.0).contains(&weak) && strong < 2.0,
        "{none} {weak} {strong}"
    );
}

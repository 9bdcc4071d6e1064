//! What simulations read: shipped files are whole, wrong ones name the line.

use std::path::{Path, PathBuf};

use reflex_config::plant::{Environment, Tracking, Vehicle};

fn shipped() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn every_shipped_environment_and_vehicle_can_be_read() {
    let names = Environment::names(shipped()).unwrap();
    assert_eq!(names, ["arch", "lab", "rugby"]);
    for name in names {
        let environment =
            Environment::load(shipped(), &name).unwrap_or_else(|error| panic!("{error}"));
        Tracking::load(shipped(), &environment.position).unwrap_or_else(|error| panic!("{error}"));
    }
    let names = Vehicle::names(shipped()).unwrap();
    assert_eq!(names, ["hexa_x", "quad_x", "y6"]);
    for name in names {
        Vehicle::load(shipped(), &name).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn unknown_names_list_the_known_ones() {
    let error = Environment::load(shipped(), "moon").unwrap_err();
    assert_eq!(
        error.to_string(),
        "moon: environments/moon.toml does not exist, must be one of: arch, lab, rugby"
    );
    let error = Vehicle::load(shipped(), "kite").unwrap_err();
    assert!(
        error
            .to_string()
            .contains("must be one of: hexa_x, quad_x, y6")
    );
}

/// A copy of the shipped files in which one text is another, and what is said of it.
fn spoilt(file: &str, from: &str, to: &str) -> String {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(to.replace(['/', ' '], "_"));
    for folder in ["environments", "positions", "vehicles", "airframes"] {
        std::fs::create_dir_all(dir.join(folder)).unwrap();
        for entry in std::fs::read_dir(shipped().join(folder)).unwrap().flatten() {
            std::fs::copy(entry.path(), dir.join(folder).join(entry.file_name())).unwrap();
        }
    }
    let path = dir.join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{file} does not say {from}");
    std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
    let error = match file.split_once('/').unwrap().0 {
        "environments" => Environment::load(&dir, "arch").unwrap_err(),
        "positions" => Tracking::load(&dir, "satellites").unwrap_err(),
        _ => Vehicle::load(&dir, "y6").unwrap_err(),
    };
    error.to_string()
}

/// A file, a text of it, what stands there instead, and what is said of it.
const WRONG: [[&str; 4]; 9] = [
    [
        "environments/arch.toml",
        "mean_m_s = 5",
        "mean_m_s = 50",
        "wind.mean_m_s: 50.0 is out of range, must be 0 to 30 m/s",
    ],
    [
        "environments/arch.toml",
        "mean_m_s = 5",
        "mean_m_s = nan",
        "wind.mean_m_s: NaN is out of range",
    ],
    [
        "positions/satellites.toml",
        "delay_s = 0.12",
        "delay_s = 12",
        "delay_s: 12.0 is out of range, must be 0 to 0.5 s",
    ],
    [
        "environments/arch.toml",
        "area_m = 40",
        "aera_m = 40",
        "unknown field `aera_m`",
    ],
    [
        "vehicles/y6.toml",
        "mass_kg = 2.4",
        "mass_kg = 0",
        "mass_kg: 0.0 is out of range, must be 0.05 to 100 kg",
    ],
    [
        "vehicles/y6.toml",
        "lower = [2, 4, 6]",
        "lower = [2, 4, 7]",
        "rotors.lower.2: 7 is out of range, must be 1 to 6",
    ],
    [
        "vehicles/y6.toml",
        "[0.05, 3.55]",
        "[0.0, 3.55]",
        "battery.open_circuit: must be 1 to 64 pairs",
    ],
    [
        "vehicles/y6.toml",
        "turn_on_deg_s = 0",
        "turn_on_deg_s = 61",
        "gyroscope.turn_on_deg_s: 61.0 is out of range, must be 0 to 60 deg/s",
    ],
    [
        "vehicles/y6.toml",
        "motor_gauss_per_a = [0, 0, 0]",
        "motor_gauss_per_a = [0, 2, 0]",
        "magnetometer.motor_gauss_per_a: [0.0, 2.0, 0.0] is out of range, must be each -0.1 to 0.1",
    ],
];

#[test]
fn a_wrong_value_names_file_line_key_and_range() {
    for [file, from, to, expected] in WRONG {
        let line = spoilt(file, from, to);
        assert!(
            line.contains(expected),
            "{line:?} does not say {expected:?}"
        );
        let name = file.rsplit('/').next().unwrap();
        assert!(
            line.contains(&format!("{name}:")),
            "{line:?} names no file and line"
        );
    }
}

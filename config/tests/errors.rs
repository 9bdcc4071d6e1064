//! Every wrong value is one line that names file, line, key and range.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use reflex_config::load;

const FOLDERS: [&str; 4] = ["", "boards", "airframes", "logics"];

/// file | text in it | its replacement | key at fault | range said
const OUT_OF_RANGE: &str = r#"
reactive.toml | p_run = 0.8 | p_run = 1.0 | runs.p_run | above 0 and below 1
reactive.toml | p_run = 0.8 | p_run = nan | runs.p_run | above 0 and below 1
reactive.toml | failsafe_s = 0.1 | failsafe_s = 2 | runs.failsafe_s | at most 1 s
reactive.toml | failsafe_s = 0.1 | failsafe_s = 0.002 | runs.failsafe_s | 2 hyperperiods
reactive.toml | budget_s = 0.0125 | budget_s = 0.0001 | runs.budget_s | 0.0005 to 0.5 s
reactive.toml | periodic_rate_hz = 400 | periodic_rate_hz = 0 | runs.periodic_rate_hz | 1 to 1000
reactive.toml | quantum_steps = 255 | quantum_steps = 1 | runs.quantum_steps | 2 to 65535
reactive.toml | length = "automatic" | length = 31 | warm_up.length | 0 to 30 s
reactive.toml | shortest_s = 3 | shortest_s = -1 | warm_up.shortest_s | 0 to 30 s
reactive.toml | rate_hz = 1000 | rate_hz = 5 | warm_up.rate_hz | 10 to 1000 Hz
reactive.toml | window_s = 10 | window_s = 0 | fallback.window_s | 1 to 60 s
reactive.toml | fewest_runs = 100 | fewest_runs = 1 | fallback.fewest_runs | 10 to 10000
reactive.toml | false_positive_excess = 0.25 | false_positive_excess = 2 | fallback.false_positive_excess | 0 to 1
reactive.toml | late_runs = 10 | late_runs = 0 | fallback.late_runs | 1 to 10000
reactive.toml | aerobatics_rad_s = 30 | aerobatics_rad_s = nan | fallback.aerobatics_rad_s | at most 40 rad/s
reactive.toml | longest_s = 60 | longest_s = 0 | fallback.longest_s | 1 to 600 s
reactive.toml | longest_s = 30 | longest_s = 31 | warm_up.longest_s | at most 30 s
reactive.toml | labels_of_each_class = 30 | labels_of_each_class = 0 | warm_up.labels_of_each_class | 1 to 10000
reactive.toml | stable_change = 0.1 | stable_change = 0 | warm_up.stable_change | above 0
reactive.toml | forgetting_s = 20 | forgetting_s = 0.5 | learning.forgetting_s | 1 to 3600
reactive.toml | refit_interval_s = 0.5 | refit_interval_s = inf | learning.refit_interval_s | 0.05 to 60
reactive.toml | exploration_share = 0.00048828125 | exploration_share = 0.2 | learning.exploration_share | 0 to 0.1
reactive.toml | smallest_change = 0.005 | smallest_change = 0 | inputs.gyro.smallest_change | above 0
reactive.toml | angle_quantum_rad = 0.02 | angle_quantum_rad = 2 | setpoint.angle_quantum_rad | at most 1 rad
reactive.toml | position_quantum_m = 0.05 | position_quantum_m = 0 | setpoint.position_quantum_m | at most 10 m
boards/reflex_f427.toml | imu_rate_hz = 1000 | imu_rate_hz = 8000 | sensors.imu_rate_hz | one of 1000 500
boards/reflex_f427.toml | chip_accel_rate_hz = 100 | chip_accel_rate_hz = 1344 | sensors.chip_accel_rate_hz | one of 400 200
boards/reflex_f427.toml | gyro_cutoff_hz = 80 | gyro_cutoff_hz = 2 | filters.gyro_cutoff_hz | 5 to 450 Hz
boards/reflex_f427.toml | length_s = 0.5 | length_s = 11 | calibration.length_s | 0.1 to 10 s
boards/reflex_f427.toml | accel_trim_m_s2 = [0.0, | accel_trim_m_s2 = [1.5, | calibration.accel_trim_m_s2 | -1 to 1 m/s2
boards/reflex_f427.toml | baud = 460800 | baud = 9600 | link.baud | 460800
airframes/quad_x.toml | angle_deg = 315 | angle_deg = 360 | motors.2.angle_deg | 360 excluded
airframes/quad_x.toml | armed_minimum = 0.05 | armed_minimum = 0.5 | armed_minimum | 0 to 0.3
logics/cascade.toml | p = [6.0, 6.0, 3.0] | p = [6.0, -6.0, 3.0] | attitude.p | 0 to 30
logics/cascade.toml | rate_limit_rad_s = [4.0 | rate_limit_rad_s = [40.0 | attitude.rate_limit_rad_s | at most 35
logics/cascade.toml | d_cutoff_hz = 20 | d_cutoff_hz = 0 | rate.d_cutoff_hz | 1 to 200 Hz
logics/cascade.toml | accel_correction = 0.4 | accel_correction = nan | estimate.accel_correction | 0 to 10 1/s
logics/cleanflight.toml | max_lean_rad = 0.873 | max_lean_rad = 50 | level.max_lean_rad | above 0 and at most 1.5 rad
logics/cleanflight.toml | velocity_p = 0.375 | velocity_p = 375 | altitude.velocity_p | 0 to 2 share of full thrust per m/s
"#;

/// file | text in it | its replacement | what is said
const UNREADABLE: &str = r#"
reactive.toml | p_run = 0.8 | p_rum = 0.8 | unknown field `p_rum`, expected
reactive.toml | p_run = 0.8 | p_run = "often" | runs.p_run: invalid type
boards/reflex_f427.toml | imu = "none" | imu = "yaw45" | mounting.imu: unknown variant `yaw45`
reactive.toml | policy = "reactive" | policy = "lazy" | runs.policy: unknown variant `lazy`
reactive.toml | p_run = 0.8 |  | missing field `p_run`
reactive.toml | gates = true | gates = 1 | inputs.gyro.gates: invalid type
reactive.toml | p_run = 0.8 | p_run = | string values must be quoted
logics/cascade.toml | [6.0, 6.0, 3.0] | [6.0, 6.0] | attitude.p: invalid length
logics/cascade.toml | [6.0, 6.0, 3.0] | [6.0, "much", 3.0] | attitude.p.1: invalid type
logics/cascade.toml | d_cutoff_hz = 20 | d_cutoff_hz = [20] | rate.d_cutoff_hz: invalid type
logics/cascade.toml | d_cutoff_hz = 20 | cutoff = 20 | rate.cutoff: unknown field `cutoff`, expected one of p, i, d, d_cutoff_hz
logics/cascade.toml | d_cutoff_hz = 20 |  | rate: missing field `d_cutoff_hz`
logics/cascade.toml | [attitude] | [altitude] | altitude: unknown field `altitude`, expected one of estimate, attitude, rate
logics/cascade.toml | [estimate] | [[estimate]] | estimate.0: invalid type
logics/cascade.toml | d_cutoff_hz = 20 | d_cutoff_hz = | string values must be quoted
airframes/quad_x.toml | spin = "cw" | spin = "left" | motors.2.spin: unknown variant
"#;

/// file | text in it | its replacement | what is said
const UNFIT: &str = r#"
reactive.toml | longest_s = 30 | longest_s = 2 | warm_up.shortest_s: 3 is out of range, must be 0 to longest_s, 2 s
reactive.toml | smallest_change = 0.005 | smallest_change = 4 | inputs.gyro.smallest_change: must be below
safety.toml | most_thrust = 0.05 | most_thrust = 0.2 | arming.most_thrust: must be below ground.idle_thrust, 0.15
safety.toml | lifting_thrust = 0.25 | lifting_thrust = 0.1 | ground.idle_thrust: must be below ground.lifting_thrust, 0.1
boards/reflex_f427.toml | low_v = 3.5 | low_v = 3.3 | battery.critical_v: must be below battery.low_v, 3.3
boards/reflex_f427.toml | cells = 0 | cells = 1 | battery.least_v: must be below critical_v of all cells, 3.3 V
airframes/quad_x.toml | spin = "cw" | spin = "ccw" | motors: 1 of 4 spin cw, must be half
airframes/quad_x.toml | angle_deg = 315 | angle_deg = 300 | motors: equal thrust would roll: the mean lever is 0.04 of an arm
airframes/quad_x.toml | angle_deg = 315 | angle_deg = 45 | motors: equal thrust would roll: the mean lever is 0.35 of an arm
boards/reflex_f427.toml | imu_rate_hz = 1000 | imu_rate_hz = 125 | filters.gyro_cutoff_hz: 80 is out of range, must be 5 to 0.45 times imu_rate_hz, 56.25 Hz
boards/reflex_f427.toml | critical_v = 3.3 | critical_v = 2.9 | battery.collapsed_v: must be below battery.critical_v, 2.9
selection.toml | airframe = "quad_x" | airframe = "hexa" | airframe: airframes/hexa.toml does not exist, must be one of: hexa_x, quad_x
selection.toml | airframe = "quad_x" | airframe = "../boards/reflex_f427" | airframe: airframes
"#;

fn rows<const N: usize>(table: &'static str) -> impl Iterator<Item = [&'static str; N]> {
    table.trim().lines().map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        cells.try_into().expect(line)
    })
}

/// A copy of the shipped configuration that goes away with the value.
struct Copied(PathBuf);

impl Copied {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("config-{}", COUNT.fetch_add(1, Ordering::Relaxed));
        let copy = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        for folder in FOLDERS {
            fs::create_dir_all(copy.join(folder)).unwrap();
            for entry in fs::read_dir(shipped().join(folder)).unwrap() {
                let file = entry.unwrap().path();
                if file
                    .extension()
                    .is_some_and(|extension| extension == "toml")
                {
                    let name = file.file_name().unwrap();
                    fs::copy(&file, copy.join(folder).join(name)).unwrap();
                }
            }
        }
        Self(copy)
    }

    /// What `load` says once `old` in `file` is `new`, without the folder's name.
    fn error_with(&self, file: &str, old: &str, new: &str) -> String {
        let path = self.0.join(file);
        let before = fs::read_to_string(&path).unwrap();
        assert!(before.contains(old), "{file} has no {old:?}");
        fs::write(&path, before.replacen(old, new, 1)).unwrap();
        let message = load(&self.0).expect_err(new).to_string();
        fs::write(&path, before).unwrap();
        let folder = format!("{}/", self.0.display());
        message.strip_prefix(&folder).unwrap_or(&message).to_owned()
    }
}

impl Drop for Copied {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn shipped() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The line on which a shipped file has a text.
fn line_of(file: &str, text: &str) -> usize {
    let content = fs::read_to_string(shipped().join(file)).unwrap();
    content
        .lines()
        .position(|line| line.contains(text))
        .unwrap()
        + 1
}

#[test]
fn the_shipped_configuration_is_valid() {
    let configuration = load(shipped()).unwrap();
    assert_eq!(configuration.hyperperiod_us(), 1000);
    assert_eq!(configuration.airframe.motors.len(), 4);
}

#[test]
fn a_value_out_of_range_names_file_line_key_and_range() {
    let copied = Copied::new();
    for [file, old, new, key, range] in rows(OUT_OF_RANGE) {
        let message = copied.error_with(file, old, new);
        let place = format!("{file}:{}: {key}: ", line_of(file, old));
        assert!(
            message.starts_with(&place),
            "{message:?} does not start with {place:?}"
        );
        assert!(
            message.contains(range),
            "{message:?} does not say {range:?}"
        );
        assert_eq!(message.lines().count(), 1, "{message:?}");
    }
}

#[test]
fn an_unknown_key_a_wrong_type_and_a_missing_key_are_named() {
    let copied = Copied::new();
    for [file, old, new, expected] in rows(UNREADABLE) {
        let message = copied.error_with(file, old, new);
        assert!(message.starts_with(&format!("{file}:")), "{message:?}");
        assert!(
            message.contains(expected),
            "{message:?} does not say {expected:?}"
        );
        assert_eq!(message.lines().count(), 1, "{message:?}");
    }
}

#[test]
fn values_that_do_not_fit_each_other_are_named() {
    let copied = Copied::new();
    for [file, old, new, expected] in rows(UNFIT) {
        let message = copied.error_with(file, old, new);
        let line = message
            .strip_prefix(&format!("{file}:"))
            .unwrap_or_else(|| panic!("{message:?}"));
        assert!(
            line.starts_with(|first: char| first.is_ascii_digit()),
            "{message:?}"
        );
        assert!(
            message.contains(expected),
            "{message:?} does not say {expected:?}"
        );
    }
}

#[test]
fn a_gate_is_needed_and_sets_the_hyperperiod() {
    let copied = Copied::new();
    let path = copied.0.join("reactive.toml");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("gates = true", "gates = false")).unwrap();
    let message = load(&copied.0).unwrap_err().to_string();
    assert!(
        message.ends_with("inputs: at least one must have gates = true"),
        "{message:?}"
    );
    fs::write(
        &path,
        text.replace("gates = false", "gates = true")
            .replace("= 400", "= 50"),
    )
    .unwrap();
    let configuration = load(&copied.0).unwrap();
    assert_eq!(configuration.hyperperiod_us(), 10_000);
}

#[test]
fn rates_with_little_in_common_are_refused_with_their_hyperperiod() {
    let copied = Copied::new();
    let board = copied.0.join("boards/reflex_f427.toml");
    let text = fs::read_to_string(&board).unwrap();
    let (fast, slow) = ("chip_accel_rate_hz = 100", "chip_accel_rate_hz = 10");
    fs::write(&board, text.replace(fast, slow)).unwrap();
    let gates =
        "[inputs.chip_accel]     # LSM303AGR: compares in the chip, on its own clock\ngates = ";
    let message = copied.error_with(
        "reactive.toml",
        &format!("{gates}false"),
        &format!("{gates}true"),
    );
    assert!(
        message.ends_with(
            "inputs.chip_accel.gates: gyro 1000 Hz, accel 1000 Hz, chip_accel 10 Hz have a \
             hyperperiod of 100 ms, at most 20 ms: let one trigger without gating"
        ),
        "{message:?}"
    );
}

#[test]
fn five_motors_cannot_balance_and_three_are_too_few() {
    let copied = Copied::new();
    let file = "airframes/quad_x.toml";
    let fifth = "\n[[motors]]\nangle_deg = 0\nspin = \"cw\"\n\n[[motors]] # 1";
    let message = copied.error_with(file, "[[motors]] # 1", fifth);
    assert!(
        message.ends_with("motors: 3 of 5 spin cw, must be half of them"),
        "{message:?}"
    );
    let path = copied.0.join(file);
    let text = fs::read_to_string(&path).unwrap();
    let (three, _) = text.split_once("[[motors]] # 4").unwrap();
    fs::write(&path, three).unwrap();
    let message = load(&copied.0).unwrap_err().to_string();
    assert!(
        message.ends_with("motors: 3 motors are out of range, must be 4 to 8"),
        "{message:?}"
    );
}

#[test]
fn a_logic_without_a_table_of_gains_or_without_a_file_is_named() {
    let copied = Copied::new();
    let file = copied.0.join("logics/stranger.toml");
    fs::write(&file, "").unwrap();
    let message = load(&copied.0).unwrap_err().to_string();
    assert!(
        message.contains("logics/stranger.toml: no control logic of this name"),
        "{message:?}"
    );
    fs::remove_file(&file).unwrap();
    let selection = "logic = \"cascade\"";
    let message = copied.error_with("selection.toml", selection, "logic = \"stranger\"");
    assert!(
        message.contains("logics/stranger.toml does not exist, must be one of: "),
        "{message:?}"
    );
}

#[test]
fn a_missing_file_is_named() {
    let message = load(Path::new("nowhere")).unwrap_err().to_string();
    assert!(
        message.starts_with("nowhere/selection.toml: cannot be read: "),
        "{message:?}"
    );
}

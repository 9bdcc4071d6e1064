//! Environment variables come before `selection.toml`.

use std::path::Path;

use reflex_config::{ConfigError, Configuration, load_chosen};

/// The shipped configuration with one variable set.
fn with(variable: &str, value: &str) -> Result<Configuration, ConfigError> {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR"));
    load_chosen(shipped, |asked| (asked == variable).then(|| value.into()))
}

#[test]
fn a_variable_chooses_another_airframe() {
    for (name, motors) in [("quad_x", 4), ("hexa_x", 6), ("y6", 6)] {
        let configuration = with("REFLEX_AIRFRAME", name).unwrap();
        assert_eq!(configuration.selection.airframe, name);
        assert_eq!(configuration.airframe.motors.len(), motors);
    }
}

#[test]
fn an_empty_variable_leaves_the_choice_to_the_file() {
    for variable in ["REFLEX_BOARD", "REFLEX_AIRFRAME", "REFLEX_LOGIC"] {
        let unset = with("", "").unwrap();
        assert_eq!(with(variable, "").unwrap(), unset);
    }
}

#[test]
fn an_unknown_name_is_said_of_its_variable_with_those_that_are_known() {
    for (variable, folder, known) in [
        ("REFLEX_BOARD", "boards", "reflex_f427"),
        ("REFLEX_AIRFRAME", "airframes", "hexa_x, quad_x, y6"),
        ("REFLEX_LOGIC", "logics", "cascade"),
    ] {
        let message = with(variable, "kite").unwrap_err().to_string();
        let start = format!("{variable}: {folder}/kite.toml does not exist, must be one of: ");
        assert!(message.starts_with(&start), "{message:?}");
        assert!(
            message.contains(known),
            "{message:?} does not say {known:?}"
        );
    }
}

#[test]
fn a_bandwidth_multiplies_the_gains_of_attitude_and_rate_loops() {
    let gains = |factor: &str| {
        let source = with("REFLEX_BANDWIDTH", factor).unwrap().to_rust();
        let entry = |name: &str| {
            let line = source.lines().find(|line| line.contains(name)).unwrap();
            line.split('"').nth(3).unwrap().to_owned()
        };
        ["rate.p", "rate.i", "attitude.p", "rate.d_cutoff_hz"]
            .map(|gain| entry(&format!("[\"cascade.{gain}\"")))
    };
    assert_eq!(
        gains(""),
        [
            "[0.06, 0.06, 0.1]",
            "[0.06, 0.06, 0.05]",
            "[6.0, 6.0, 3.0]",
            "20.0"
        ]
    );
    assert_eq!(
        gains("2"),
        [
            "[0.12, 0.12, 0.2]",
            "[0.24, 0.24, 0.2]",
            "[12.0, 12.0, 6.0]",
            "20.0"
        ]
    );
}

#[test]
fn a_bandwidth_that_is_no_number_or_brings_a_gain_out_of_its_range_is_refused() {
    for (factor, expected) in [
        (
            "fast",
            "REFLEX_BANDWIDTH: fast is out of range, must be 0.25 to 4",
        ),
        (
            "nan",
            "REFLEX_BANDWIDTH: nan is out of range, must be 0.25 to 4",
        ),
        (
            "5",
            "REFLEX_BANDWIDTH: 5 is out of range, must be 0.25 to 4",
        ),
        (
            "4",
            "REFLEX_BANDWIDTH: 4 brings arducopter's angle.p to 18, must be above 0 and at most 12",
        ),
    ] {
        assert_eq!(
            with("REFLEX_BANDWIDTH", factor).unwrap_err().to_string(),
            expected
        );
    }
}

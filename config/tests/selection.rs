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

//! Environment variables come before `selection.toml`.

use std::path::Path;

use reflex_config::{ConfigError, Configuration, Logic, load_chosen};
use reflex_settings::gains::LOGICS;

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

fn quickened(logic: &str, bandwidth: f64) -> Result<Logic, String> {
    let declared = LOGICS.iter().find(|it| it.logic == logic).unwrap();
    let mut logic = Logic::load(Path::new(env!("CARGO_MANIFEST_DIR")), declared).unwrap();
    logic.quicken(bandwidth).map(|()| logic)
}

#[test]
fn a_bandwidth_multiplies_the_gains_of_attitude_and_rate_loops() {
    let gains = |bandwidth| {
        let Logic { declared, numbers } = quickened("cascade", bandwidth).unwrap();
        let each = declared.gains.iter();
        let places = each.flat_map(|gain| vec![gain.path().to_string(); gain.kind.numbers()]);
        let named = places.zip(numbers);
        let of = |key: &str| -> Vec<f64> {
            let named = named.clone().filter(|(path, _)| path == key);
            named.map(|(_, number)| number).collect()
        };
        ["rate.p", "rate.i", "attitude.p", "rate.d_cutoff_hz"].map(of)
    };
    let [p, i, attitude, cutoff] = gains(1.0);
    let times = |factor: f64, numbers: &[f64]| -> Vec<f64> {
        numbers.iter().map(|number| number * factor).collect()
    };
    let expected = [
        times(2.0, &p),
        times(4.0, &i),
        times(2.0, &attitude),
        cutoff,
    ];
    assert_eq!(gains(2.0), expected);
}

#[test]
fn a_bandwidth_that_brings_a_gain_out_of_its_range_is_refused() {
    assert_eq!(
        quickened("arducopter", 20.0),
        Err("20: brings arducopter's angle.p to 90, must be above 0 and at most 60".to_owned())
    );
}

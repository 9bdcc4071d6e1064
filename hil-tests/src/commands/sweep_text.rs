//! The text of `--sweep`: `p-run=0.2..0.9,failsafe=0.01..0.3/5`.

use super::quantities::number;
use reflex_settings::Value;

use crate::sweep::{Axis, Grid, Parameter};

/// Values of a range that names no number of them.
const VALUES: usize = 8;
/// Most values of a range.
const MOST_VALUES: usize = 100;

/// The grid that a text names.
///
/// # Errors
/// The first part that is refused, with what would be accepted.
pub(crate) fn grid(text: &str) -> Result<Grid, String> {
    let axes: Result<Vec<Axis>, String> = text.split(',').map(axis).collect();
    Grid::new(axes?)
}

fn axis(text: &str) -> Result<Axis, String> {
    let text = text.trim();
    let Some((name, values)) = text.split_once('=') else {
        return Err(format!(
            "`{text}` must be NAME=A..B, NAME=A..B/N or NAME=V, with NAME one of {}",
            names()
        ));
    };
    let name = name.trim();
    let parameter = Parameter::ALL.into_iter().find(|one| one.name() == name);
    let parameter = parameter.ok_or_else(|| format!("`{name}` is none of {}", names()))?;
    axis_of(parameter, values).map_err(|reason| format!("`{text}`: {reason}"))
}

fn axis_of(parameter: Parameter, values: &str) -> Result<Axis, String> {
    let Some((from, rest)) = values.split_once("..") else {
        return Axis::one(parameter, value(parameter, values)?);
    };
    let (to, count) = match rest.rsplit_once('/') {
        Some((to, count)) if !is_fraction(parameter, to) => (to, count_of(count)?),
        _ => (rest, VALUES),
    };
    let (from, to) = (value(parameter, from)?, value(parameter, to)?);
    Axis::range(parameter, from, to, count)
}

/// Whether `to` is the upper part of a quantum such as `1/64`: a quantum itself is below 1.
fn is_fraction(parameter: Parameter, to: &str) -> bool {
    parameter == Parameter::Quantum && number(to).is_ok_and(|number| number >= 1.0)
}

fn value(parameter: Parameter, text: &str) -> Result<f64, String> {
    match parameter.setting().1.parse(text) {
        Ok(Value::Number(number)) => Ok(number),
        Ok(_) => Err(format!("'{text}' must be a number")),
        Err(refusal) => Err(format!("'{text}' {refusal}")),
    }
}

fn count_of(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(count) if (2..=MOST_VALUES).contains(&count) => Ok(count),
        _ => Err(format!(
            "the number of values behind the slash must be 2 to {MOST_VALUES}"
        )),
    }
}

fn names() -> String {
    Parameter::ALL.map(Parameter::name).join(", ")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn values(text: &str) -> Vec<f64> {
        let grid = grid(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        grid.axes()[0].values().to_vec()
    }

    #[test]
    fn a_range_has_eight_values_or_as_many_as_it_says() {
        assert_eq!(
            values("p-run=0.2..0.9"),
            [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
        );
        assert_eq!(values("p-run=0.2..0.9/2"), [0.2, 0.9]);
        assert_eq!(values("p-run = 0.2 .. 0.4 / 3 ".trim()), [0.2, 0.3, 0.4]);
        assert_eq!(values("p-run=0.5"), [0.5]);
    }

    #[test]
    fn failsafe_and_quantum_are_spaced_by_their_logarithm() {
        assert_eq!(
            values("failsafe=0.01..0.16/5"),
            [0.01, 0.02, 0.04, 0.08, 0.16]
        );
        assert_eq!(
            values("quantum=1/256..1/64/3"),
            [0.00390625, 0.0078125, 0.015625]
        );
    }

    #[test]
    fn a_quantum_may_end_in_a_fraction_or_in_a_number_of_values() {
        assert_eq!(values("quantum=1/256..1/64").len(), 8);
        assert_eq!(values("quantum=0.004..0.02/5").len(), 5);
        assert_eq!(values("quantum=1/4"), [0.25]);
    }

    #[test]
    fn several_parameters_make_the_full_grid() {
        let grid = grid("p-run=0.2..0.9,failsafe=0.01..0.3/3,quantum=1/255").expect("a grid");
        let points = grid.settings(reflex::config::SETTINGS);
        assert_eq!(points.len(), 24);
        assert_eq!(points[0].p_run, points[2].p_run);
        assert!(points[0].failsafe < points[1].failsafe);
        let again = super::grid(&grid.to_string()).expect("what it displays");
        assert_eq!(again.to_string(), grid.to_string());
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_the_way_out() {
        for (text, expected) in [
            (
                "",
                "must be NAME=A..B, NAME=A..B/N or NAME=V, with NAME one of p-run, failsafe",
            ),
            ("p-run", "must be NAME=A..B"),
            (
                "p_run=0.2..0.9",
                "`p_run` is none of p-run, failsafe, quantum",
            ),
            ("seed=1..9", "`seed` is none of p-run, failsafe, quantum"),
            ("p-run=0.9..0.2", "must ascend, as in p-run=0.2..0.9"),
            ("p-run=0.5..0.5", "is a single value, which is p-run=0.5"),
            (
                "p-run=0..0.9",
                "0 is out of range, must be above 0 and below 1",
            ),
            (
                "p-run=0.2..1",
                "1 is out of range, must be above 0 and below 1",
            ),
            ("p-run=nan", "must be a finite number"),
            ("p-run=0.2..", "'' must be a finite number"),
            ("p-run=0.2..0.9/1", "must be 2 to 100"),
            ("p-run=0.2..0.9/101", "must be 2 to 100"),
            ("p-run=0.2..0.9/", "must be 2 to 100"),
            (
                "failsafe=0.001..0.3",
                "0.001 is out of range, must be above 2 hyperperiods",
            ),
            ("failsafe=0.1..2", "at most 1 s"),
            ("failsafe=0.1..0.100001/9", "too close to tell apart"),
            (
                "quantum=1/255..0.6/4",
                "0.6 is out of range, must be above 0 and at most 0.5",
            ),
            ("p-run=0.2..0.9,p-run=0.5", "p-run is named twice"),
            ("p-run=0.2..0.9,", "`` must be NAME=A..B"),
            (
                "p-run=0.2..0.9/100,failsafe=0.01..0.3/100,quantum=0.004..0.02/2",
                "20000 points are more than 10000",
            ),
        ] {
            let error = grid(text).expect_err(text);
            assert!(error.contains(expected), "{text}: {error:?}");
            assert!(!error.contains('\n'), "{error:?}");
        }
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "\\PC{0,40}") {
            let _ = grid(&text);
        }

        #[test]
        fn no_likely_text_panics_and_what_is_accepted_is_valid(
            text in "(p-run|failsafe|quantum|x)=[-0-9./e]{0,8}(\\.\\.[-0-9./e]{0,6})?(/[0-9]{0,3})?(,(p-run|quantum)=0?\\.[0-9]{1,3})?",
        ) {
            if let Ok(grid) = grid(&text) {
                for settings in grid.settings(reflex::config::SETTINGS) {
                    prop_assert!(settings.check(&reflex::config::LIMITS).is_ok(), "{}", text);
                }
            }
        }
    }
}

//! Values of the command line: finite numbers with their units, sets of inputs.

use reflex::sensors::{Input, Inputs};
use reflex::settings::WarmUp;
use reflex::time::{Duration, micros};

/// A finite number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("must be a finite number".to_owned()),
    }
}

/// A share of full scale, `0.004` or `1/255`.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let share = match text.split_once('/') {
        Some((part, whole)) => number(part)? / number(whole)?,
        None => number(text)?,
    };
    if share.is_finite() {
        Ok(share)
    } else {
        Err("must be a finite number".to_owned())
    }
}

/// `auto`, or a time in seconds.
pub(super) fn warm_up(text: &str) -> Result<WarmUp, String> {
    if text == "auto" {
        return Ok(WarmUp::Automatic);
    }
    match number(text) {
        Ok(seconds) if seconds >= 0.0 => Ok(WarmUp::Fixed(duration(seconds))),
        _ => Err("must be `auto` or a time in s, 0 or more".to_owned()),
    }
}

/// `all`, or names of inputs with commas between them.
pub(super) fn inputs(text: &str) -> Result<Inputs, String> {
    if text == "all" {
        return Ok(Inputs::ALL);
    }
    text.split(',').try_fold(Inputs::NONE, |all, name| {
        let input = Input::ALL.into_iter().find(|input| input.key() == name);
        input.map(|input| all.with(input)).ok_or_else(|| {
            let known: Vec<&str> = Input::ALL.iter().map(|input| input.key()).collect();
            format!("`{name}` is none of {}", known.join(", "))
        })
    })
}

/// Seconds as a span; negative ones are no time, too many are the longest time.
pub(super) fn duration(seconds: f64) -> Duration {
    micros((seconds * 1e6).round() as u64)
}

/// A span in seconds.
pub(super) fn seconds(span: Duration) -> f64 {
    span.ticks() as f64 * 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number("0.5"), Ok(0.5));
        for text in ["nan", "inf", "-inf", "1e999", "", "0,5", "1 s"] {
            assert!(number(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_share_may_be_a_fraction() {
        assert_eq!(share("1/4"), Ok(0.25));
        assert_eq!(share("0.25"), Ok(0.25));
        for text in ["1/0", "0/0", "1/", "/2", "1/2/3", "one"] {
            assert!(share(text).is_err(), "{text}");
        }
    }

    #[test]
    fn inputs_are_named_as_in_the_configuration() {
        let two = Inputs::NONE.with(Input::Gyro).with(Input::ChipMag);
        assert_eq!(inputs("gyro,chip-mag"), Ok(two));
        assert_eq!(inputs("all"), Ok(Inputs::ALL));
        let line = inputs("gyro,baro").unwrap_err();
        assert!(line.starts_with("`baro` is none of gyro, accel"), "{line}");
    }

    #[test]
    fn a_warm_up_is_automatic_or_a_time() {
        assert_eq!(warm_up("auto"), Ok(WarmUp::Automatic));
        assert_eq!(warm_up("2.5"), Ok(WarmUp::Fixed(micros(2_500_000))));
        for text in ["-1", "nan", "soon"] {
            assert!(warm_up(text).is_err(), "{text}");
        }
    }
}

//! Values of the command line that are no settings of the autopilot.

/// A finite number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("must be a finite number".to_owned()),
    }
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
}

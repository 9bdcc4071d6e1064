//! Threshold codes of the chips' comparators: rounded down from SI, never zero.
//!
//! A model's threshold falls between two codes of a chip. The lower one is taken: it interrupts a
//! little too often, which costs a control run, while the upper one would miss changes that the
//! model calls for. Code 0 would fire at every sample, so it is refused and the caller decides.

use core::fmt;

/// Why a value has no threshold code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ThresholdError {
    /// Less than one step of the comparator: it would fire at every sample.
    BelowOneStep,
    /// Not a number.
    NotANumber,
    /// A raw code that the register cannot hold.
    CodeTooLarge,
}

impl fmt::Display for ThresholdError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::BelowOneStep => "threshold below one step of the comparator: run at every sample",
            Self::NotANumber => "threshold is not a number: the model must be refitted",
            Self::CodeTooLarge => "threshold code does not fit the register",
        })
    }
}

impl core::error::Error for ThresholdError {}

/// The largest code up to `max` whose `level` does not exceed `value`.
///
/// `level` must be what turns a code back into SI, so that code, level, code is exact: division
/// alone may land just below a code that `level` reproduces.
pub(crate) fn round_down(
    value: f32,
    max: u16,
    level: impl Fn(u16) -> f32,
) -> Result<u16, ThresholdError> {
    if value.is_nan() {
        return Err(ThresholdError::NotANumber);
    }
    // `as` truncates and saturates: negative values end at 0, infinity at the largest code.
    let mut code = ((value / level(1)) as u16).min(max);
    if code < max && level(code + 1) <= value {
        code += 1;
    }
    if code > 0 && level(code) > value {
        code -= 1;
    }
    if code == 0 {
        Err(ThresholdError::BelowOneStep)
    } else {
        Ok(code)
    }
}

/// A raw code within `1..=max`.
pub(crate) fn checked_code(code: u16, max: u16) -> Result<u16, ThresholdError> {
    match code {
        0 => Err(ThresholdError::BelowOneStep),
        code if code > max => Err(ThresholdError::CodeTooLarge),
        code => Ok(code),
    }
}

//! What a number may be, and the words that say so.

use core::fmt;

/// What a number may be; NaN is in no range.
///
/// [`Display`](fmt::Display) writes the words that every refusal and every page uses:
/// "0 to 30", "above 0 and at most 12", "one of 100 50 20 10".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// From one number to another.
    Interval {
        /// The lower end.
        low: f64,
        /// The lower end itself is no value.
        low_excluded: bool,
        /// The upper end.
        high: f64,
        /// The upper end itself is no value.
        high_excluded: bool,
    },
    /// One of these numbers.
    OneOf(&'static [f64]),
}

/// From one number to another, both included.
#[must_use]
pub const fn within(low: f64, high: f64) -> Range {
    interval(low, false, high, false)
}

/// Above one number and at most another.
#[must_use]
pub const fn above(low: f64, high: f64) -> Range {
    interval(low, true, high, false)
}

/// Above one number and below another.
#[must_use]
pub const fn between(low: f64, high: f64) -> Range {
    interval(low, true, high, true)
}

/// From one number to below another.
#[must_use]
pub const fn from_below(low: f64, high: f64) -> Range {
    interval(low, false, high, true)
}

/// One of these numbers.
#[must_use]
pub const fn one_of(numbers: &'static [f64]) -> Range {
    Range::OneOf(numbers)
}

const fn interval(low: f64, low_excluded: bool, high: f64, high_excluded: bool) -> Range {
    Range::Interval {
        low,
        low_excluded,
        high,
        high_excluded,
    }
}

impl Range {
    /// True for a number of the range.
    ///
    /// Numbers are compared in single precision, the one that the firmware stores them in: so
    /// an end belongs to the range whatever its digits, and what is rounded to an excluded end
    /// does not.
    #[must_use]
    pub fn contains(&self, number: f64) -> bool {
        self.holds(f64::from(number as f32), |end| f64::from(end as f32))
    }

    /// As [`Self::contains`] for whole numbers, which single precision does not tell apart.
    #[must_use]
    pub fn contains_count(&self, number: f64) -> bool {
        self.holds(number, |end| end)
    }

    #[inline(never)] // In double precision, which the processor calculates in software.
    fn holds(&self, number: f64, rounded: fn(f64) -> f64) -> bool {
        match *self {
            Self::Interval {
                low,
                low_excluded,
                high,
                high_excluded,
            } => {
                let (low, high) = (rounded(low), rounded(high));
                (low..=high).contains(&number)
                    && !(low_excluded && number == low)
                    && !(high_excluded && number == high)
            }
            Self::OneOf(numbers) => numbers.contains(&number),
        }
    }

    /// The lowest number and the highest.
    #[must_use]
    pub fn ends(&self) -> (f64, f64) {
        match *self {
            Self::Interval { low, high, .. } => (low, high),
            Self::OneOf(numbers) => numbers
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
                    (low.min(*number), high.max(*number))
                }),
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Interval {
                low,
                low_excluded,
                high,
                high_excluded,
            } => match (low_excluded, high_excluded) {
                (false, false) => write!(f, "{low} to {high}"),
                (true, false) => write!(f, "above {low} and at most {high}"),
                (true, true) => write!(f, "above {low} and below {high}"),
                (false, true) => write!(f, "{low} to {high}, {high} excluded"),
            },
            Self::OneOf(numbers) => {
                f.write_str("one of")?;
                numbers.iter().try_for_each(|number| write!(f, " {number}"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excluded_ends_and_what_is_no_number_are_outside() {
        for (range, inside, outside) in [
            (within(0.0, 1.0), &[0.0, 1.0][..], &[-0.1, 1.1][..]),
            (above(0.0, 1.0), &[0.1, 1.0], &[0.0, 1.1]),
            (between(0.0, 1.0), &[0.1, 0.9], &[0.0, 1.0]),
            (from_below(0.0, 1.0), &[0.0, 0.9], &[1.0, -0.1]),
            (one_of(&[10.0, 20.0]), &[10.0, 20.0], &[15.0, 0.0]),
        ] {
            assert!(inside.iter().all(|&number| range.contains(number)));
            assert!(!outside.iter().any(|&number| range.contains(number)));
            let no_values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
            assert!(!no_values.iter().any(|&number| range.contains(number)));
        }
    }

    #[test]
    fn a_range_says_which_ends_belong_to_it() {
        for (range, words) in [
            (within(0.0, 30.0), "0 to 30"),
            (above(0.0, 0.5), "above 0 and at most 0.5"),
            (between(0.0, 1.0), "above 0 and below 1"),
            (from_below(0.0, 360.0), "0 to 360, 360 excluded"),
            (one_of(&[100.0, 50.0]), "one of 100 50"),
        ] {
            assert_eq!(range.to_string(), words);
        }
    }
}

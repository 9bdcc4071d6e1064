//! Means with their confidence intervals.

use schemars::JsonSchema;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// How sure an interval is to hold the mean.
pub const CONFIDENCE: f64 = 0.95;

/// A mean over seeds, and how far the true one may be from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Interval {
    /// Mean.
    pub mean: f64,
    /// Half of the 95 % confidence interval (Student's t); null for a single seed.
    pub half_width: Option<f64>,
    /// Values that it is of.
    pub count: usize,
}

impl Interval {
    /// Of independent values; none of none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        Self::at(CONFIDENCE, values)
    }

    /// The same, as sure as this instead of 95 %.
    #[must_use]
    pub fn at(confidence: f64, values: &[f64]) -> Option<Self> {
        let mean = mean(values)?;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Some(Self {
            mean,
            half_width: half_width(confidence, squares, values.len()),
            count: values.len(),
        })
    }

    /// Of cells that were measured with the same seeds: the mean of the cells' means.
    ///
    /// Seeds are independent, cells of one seed may not be. So each seed counts once, with the
    /// mean of its differences from its cells' means. The count is that of all values.
    #[must_use]
    pub fn over_cells(cells: &[Vec<(u32, f64)>]) -> Option<Self> {
        let of_cell = |cell: &Vec<(u32, f64)>| {
            let values: Vec<f64> = cell.iter().map(|(_, value)| *value).collect();
            mean(&values)
        };
        let means: Vec<f64> = cells.iter().filter_map(of_cell).collect();
        let mut off = std::collections::BTreeMap::<u32, f64>::new();
        for cell in cells {
            let Some(own) = of_cell(cell) else { continue };
            for (seed, value) in cell {
                *off.entry(*seed).or_default() += (value - own) / means.len() as f64;
            }
        }
        let squares: f64 = off.values().map(|off| off * off).sum();
        Some(Self {
            mean: mean(&means)?,
            half_width: half_width(CONFIDENCE, squares, off.len()),
            count: cells.iter().map(Vec::len).sum(),
        })
    }

    /// Lower and upper end; the mean itself without an interval.
    #[must_use]
    pub fn ends(&self) -> [f64; 2] {
        let half = self.half_width.unwrap_or_default();
        [self.mean - half, self.mean + half]
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// From a sum of squared deviations of so many values.
fn half_width(confidence: f64, squares: f64, count: usize) -> Option<f64> {
    let freedom = count.checked_sub(1).filter(|freedom| *freedom > 0)? as f64;
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
    let quantile = student.inverse_cdf(0.5 + confidence / 2.0);
    Some(quantile * (squares / freedom / count as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// By hand: mean 4, deviation sqrt(10), 5 values, t = 2.7764 at 4 degrees.
    #[test]
    fn an_interval_is_that_of_a_textbook() {
        let interval = Interval::of(&[0.0, 2.0, 4.0, 6.0, 8.0]).unwrap();
        assert_eq!((interval.mean, interval.count), (4.0, 5));
        let expected = 2.776_445 * (10.0f64 / 5.0).sqrt();
        assert!((interval.half_width.unwrap() - expected).abs() < 1e-5);
    }

    #[test]
    fn one_value_has_no_interval_and_none_no_mean() {
        let one = Interval::of(&[3.0]).unwrap();
        assert_eq!(
            (one.mean, one.half_width, one.ends()),
            (3.0, None, [3.0; 2])
        );
        assert_eq!(Interval::of(&[]), None);
        assert_eq!(Interval::over_cells(&[vec![]]), None);
    }

    /// Two cells, of seeds 1 and 2: means 2 and 12, off by -1 and +1 in both.
    #[test]
    fn cells_of_one_seed_count_as_one_value() {
        let cells = [vec![(1, 1.0), (2, 3.0)], vec![(1, 11.0), (2, 13.0)]];
        let interval = Interval::over_cells(&cells).unwrap();
        assert_eq!((interval.mean, interval.count), (7.0, 4));
        // t = 12.7062 at 1 degree of freedom, deviation sqrt(2), 2 seeds.
        assert!((interval.half_width.unwrap() - 12.7062).abs() < 1e-3);
    }

    proptest! {
        #[test]
        fn complete_cells_give_the_interval_of_the_seeds_means(
            rows in prop::collection::vec(prop::array::uniform3(-50.0..50.0f64), 2..9),
        ) {
            let cell = |place: usize| (1..).zip(rows.iter().map(|row| row[place])).collect();
            let cells = [0, 1, 2].map(cell);
            let means: Vec<f64> = rows.iter().map(|row| row.iter().sum::<f64>() / 3.0).collect();
            let expected = Interval::of(&means).unwrap();
            let interval = Interval::over_cells(&cells).unwrap();
            prop_assert!((interval.mean - expected.mean).abs() < 1e-9);
            let widths = interval.half_width.unwrap() - expected.half_width.unwrap();
            prop_assert!(widths.abs() < 1e-6);
        }
    }
}

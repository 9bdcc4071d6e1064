//! Time-stamped samples of one signal, read by linear interpolation.
//!
//! Invariants: time rises strictly, there is a value for each time stamp. An
//! empty track has no value at any time.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Nanoseconds per second.
pub(super) const SECOND_NS: i64 = 1_000_000_000;

/// Converts log time to seconds.
#[must_use]
pub fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 / SECOND_NS as f64
}

/// A span of log time, ns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Its first instant.
    pub from_ns: i64,
    /// Its last.
    pub to_ns: i64,
}

impl Span {
    /// Its length, ns.
    #[must_use]
    pub fn length_ns(self) -> i64 {
        self.to_ns.saturating_sub(self.from_ns)
    }

    /// What both have in common, if anything.
    pub(super) fn and(self, other: Self) -> Option<Self> {
        let both = Self {
            from_ns: self.from_ns.max(other.from_ns),
            to_ns: self.to_ns.min(other.to_ns),
        };
        (both.from_ns < both.to_ns).then_some(both)
    }
}

impl serde::Serialize for Span {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct;
        let mut span = serializer.serialize_struct("Span", 2)?;
        span.serialize_field("from_s", &seconds(self.from_ns))?;
        span.serialize_field("to_s", &seconds(self.to_ns))?;
        span.end()
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.1} to {:.1} s",
            seconds(self.from_ns),
            seconds(self.to_ns)
        )
    }
}

/// Samples of a signal of `N` components, in log time (ns).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track<const N: usize> {
    times_ns: Vec<i64>,
    values: Vec<[f64; N]>,
}

impl<const N: usize> Track<N> {
    /// A track without samples.
    #[must_use]
    pub fn new() -> Self {
        Self {
            times_ns: Vec::new(),
            values: Vec::new(),
        }
    }

    /// A track with the same value at every time.
    #[must_use]
    pub fn constant(value: [f64; N]) -> Self {
        let mut track = Self::new();
        track.push(0, value);
        track
    }

    /// Appends a sample; one that is not newer than the last is left out.
    pub fn push(&mut self, time_ns: i64, value: [f64; N]) {
        if self.last_time_ns().is_none_or(|last| time_ns > last) {
            self.times_ns.push(time_ns);
            self.values.push(value);
        }
    }

    /// Appends a sample, unless it repeats the last value: logs hold slow
    /// signals between their own samples.
    pub fn push_change(&mut self, time_ns: i64, value: [f64; N]) {
        if self.values.last() != Some(&value) {
            self.push(time_ns, value);
        }
    }

    /// Takes the newest sample away.
    pub(super) fn pop(&mut self) {
        self.times_ns.pop();
        self.values.pop();
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.times_ns.len()
    }

    /// True without any sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.times_ns.is_empty()
    }

    /// Time stamps, ns of log time.
    #[must_use]
    pub fn times_ns(&self) -> &[i64] {
        &self.times_ns
    }

    /// Values, one for each time stamp.
    #[must_use]
    pub fn values(&self) -> &[[f64; N]] {
        &self.values
    }

    /// Time of the first sample, ns.
    #[must_use]
    pub fn first_time_ns(&self) -> Option<i64> {
        self.times_ns.first().copied()
    }

    /// Time of the last sample, ns.
    #[must_use]
    pub fn last_time_ns(&self) -> Option<i64> {
        self.times_ns.last().copied()
    }

    /// Samples with their times.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (i64, [f64; N])> + '_ {
        self.times_ns
            .iter()
            .copied()
            .zip(self.values.iter().copied())
    }

    /// The same times, other values.
    #[must_use]
    pub fn map<const M: usize>(&self, change: impl FnMut([f64; N]) -> [f64; M]) -> Track<M> {
        Track {
            times_ns: self.times_ns.clone(),
            values: self.values.iter().copied().map(change).collect(),
        }
    }

    /// The samples all of whose components are numbers.
    pub(super) fn numbers(&self) -> Self {
        let is_number = |(_, value): &(i64, [f64; N])| value.iter().all(|part| part.is_finite());
        let (times_ns, values) = self.iter().filter(is_number).unzip();
        Self { times_ns, values }
    }

    /// The same values, `offset_ns` earlier.
    #[must_use]
    pub(super) fn earlier(mut self, offset_ns: i64) -> Self {
        for time in &mut self.times_ns {
            *time -= offset_ns;
        }
        self
    }

    /// The samples within a span, ends included.
    pub(super) fn within(&self, span: Span) -> Self {
        self.places(
            self.times_ns.partition_point(|&time| time < span.from_ns),
            self.times_ns.partition_point(|&time| time <= span.to_ns),
        )
    }

    /// As [`Track::within`], with the sample before and the one behind.
    pub(super) fn around(&self, span: Span) -> Self {
        let first = self.times_ns.partition_point(|&time| time <= span.from_ns);
        let end = self.times_ns.partition_point(|&time| time < span.to_ns);
        self.places(first.saturating_sub(1), (end + 1).min(self.len()))
    }

    fn places(&self, from: usize, to: usize) -> Self {
        Self {
            times_ns: self.times_ns.get(from..to).unwrap_or_default().to_vec(),
            values: self.values.get(from..to).unwrap_or_default().to_vec(),
        }
    }

    /// The samples of a span of log time, ends included.
    pub fn between(&self, from_ns: i64, to_ns: i64) -> &[[f64; N]] {
        let from = self.times_ns.partition_point(|&time| time < from_ns);
        let to = self.times_ns.partition_point(|&time| time <= to_ns);
        self.values.get(from..to).unwrap_or_default()
    }

    /// The median time between samples, ns; `None` with less than two samples.
    #[must_use]
    pub fn median_period_ns(&self) -> Option<i64> {
        let mut periods: Vec<i64> = self.times_ns.windows(2).map(|w| w[1] - w[0]).collect();
        if periods.is_empty() {
            return None;
        }
        let middle = periods.len() / 2;
        Some(*periods.select_nth_unstable(middle).1)
    }

    /// The sampling rate by the median period, Hz; 0 with less than two samples.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.median_period_ns()
            .map_or(0.0, |period| 1.0 / seconds(period))
    }

    /// The value at a time: exact at samples, linear between them, held
    /// before the first and after the last; `None` when empty.
    #[must_use]
    pub fn at(&self, time_ns: i64) -> Option<[f64; N]> {
        let after = self.times_ns.partition_point(|&time| time <= time_ns);
        self.interpolated(after, time_ns)
    }

    /// As [`Track::at`], in constant time for times that mostly rise.
    ///
    /// The cursor only makes it quick: any cursor gives the same value.
    #[must_use]
    pub fn at_cursor(&self, time_ns: i64, cursor: &Cursor) -> Option<[f64; N]> {
        let hint = cursor.0.load(Ordering::Relaxed);
        let after = self.index_after(time_ns, hint);
        if after != hint {
            cursor.0.store(after, Ordering::Relaxed);
        }
        self.interpolated(after, time_ns)
    }

    /// The latest sample not after a time, with its own time.
    #[must_use]
    pub fn latest(&self, time_ns: i64) -> Option<(i64, [f64; N])> {
        let index = self
            .times_ns
            .partition_point(|&time| time <= time_ns)
            .checked_sub(1)?;
        Some((*self.times_ns.get(index)?, *self.values.get(index)?))
    }

    /// The index of the first sample after a time, sought near a hint first.
    fn index_after(&self, time_ns: i64, hint: usize) -> usize {
        const STEPS: usize = 4;
        let is_after = |index: usize| self.times_ns.get(index).is_none_or(|&t| t > time_ns);
        let near = hint..=hint.saturating_add(STEPS).min(self.len());
        for index in near {
            let starts_before = index == 0 || !is_after(index - 1);
            if !starts_before {
                break;
            }
            if is_after(index) {
                return index;
            }
        }
        self.times_ns.partition_point(|&time| time <= time_ns)
    }

    /// The value between sample `after - 1` and sample `after`.
    fn interpolated(&self, after: usize, time_ns: i64) -> Option<[f64; N]> {
        let Some(before) = after.checked_sub(1) else {
            return self.values.first().copied();
        };
        let start = *self.values.get(before)?;
        let Some(end) = self.values.get(after) else {
            return Some(start);
        };
        let (start_ns, end_ns) = (self.times_ns[before], self.times_ns[after]);
        let part = (time_ns - start_ns) as f64 / (end_ns - start_ns) as f64;
        Some(std::array::from_fn(|i| {
            start[i] + (end[i] - start[i]) * part
        }))
    }
}

/// Where a track was read last.
#[derive(Debug, Default)]
pub struct Cursor(AtomicUsize);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ramp() -> Track<2> {
        let mut track = Track::new();
        track.push(10, [0.1, 5.0]);
        track.push(20, [0.3, 5.0]);
        track.push(40, [-0.7, 7.0]);
        track
    }

    #[test]
    fn samples_are_met_exactly_and_what_lies_between_is_linear() {
        let track = ramp();
        assert_eq!(track.at(20), Some([0.3, 5.0]));
        assert_eq!(track.at(40), Some([-0.7, 7.0]));
        assert_eq!(track.at(30).map(|v| v[1]), Some(6.0));
    }

    #[test]
    fn the_ends_are_held() {
        let track = ramp();
        assert_eq!(track.at(i64::MIN), Some([0.1, 5.0]));
        assert_eq!(track.at(i64::MAX), Some([-0.7, 7.0]));
        assert_eq!(Track::<1>::new().at(0), None);
    }

    #[test]
    fn a_sample_that_is_not_newer_is_left_out() {
        let mut track = ramp();
        track.push(40, [9.0, 9.0]);
        track.push(30, [9.0, 9.0]);
        assert_eq!(track, ramp());
    }

    #[test]
    fn a_held_value_is_one_sample() {
        let mut track = Track::new();
        for (time, value) in [(0, 1.0), (1, 1.0), (2, 1.0), (3, 2.0)] {
            track.push_change(time, [value]);
        }
        assert_eq!(track.times_ns(), [0, 3]);
    }

    #[test]
    fn the_latest_sample_is_never_from_the_future() {
        assert_eq!(ramp().latest(9), None);
        assert_eq!(ramp().latest(39).map(|(time, _)| time), Some(20));
    }

    proptest! {
        #[test]
        fn a_cursor_never_changes_a_value(
            times in prop::collection::btree_set(0_i64..1000, 1..50),
            asked in prop::collection::vec(-10_i64..1010, 1..50),
        ) {
            let mut track = Track::new();
            for time in times {
                track.push(time, [(time * 7919 % 101) as f64]);
            }
            let cursor = Cursor::default();
            for time in asked {
                prop_assert_eq!(track.at_cursor(time, &cursor), track.at(time));
            }
        }
    }
}

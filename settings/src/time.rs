//! Spans of time, in the unit that the firmware counts in.

/// A span of time, in microseconds.
pub type Duration = fugit::MicrosDurationU64;

/// A span from its count of microseconds.
#[must_use]
pub const fn micros(micros: u64) -> Duration {
    Duration::from_ticks(micros)
}

/// A span in seconds.
pub(crate) fn seconds(span: Duration) -> f64 {
    span.ticks() as f64 / 1e6
}

/// Seconds as a span, to the microsecond; negative ones are no time, too many the longest time.
pub(crate) fn from_seconds(seconds: f64) -> Duration {
    // Half a microsecond more, cut off, is rounded; `f64::round` is not in `core`.
    micros((seconds * 1e6 + 0.5) as u64)
}

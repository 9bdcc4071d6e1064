//! Spans of time, in the unit that the firmware counts in.

/// A span of time, in microseconds.
pub type Duration = fugit::MicrosDurationU64;

/// A span from its count of microseconds.
#[must_use]
pub const fn micros(micros: u64) -> Duration {
    Duration::from_ticks(micros)
}

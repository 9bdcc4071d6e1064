//! Time as the firmware sees it: 1 us ticks of one 64-bit monotonic clock.
//!
//! Nothing in the portable code reads a clock. Every instant is an argument, stamped by an
//! interrupt or by a timer, so that the same calls give the same bits on any machine.
//! The types are `fugit`'s, the ones the hardware abstraction layer's monotonic uses too.

pub use reflex_settings::{Duration, micros};

/// A point in time, in microseconds since the clock started.
pub type Instant = fugit::TimerInstantU64<1_000_000>;

/// The time from `earlier` to `later`; zero where the stamps go back.
#[must_use]
pub fn span(earlier: Instant, later: Instant) -> Duration {
    later
        .checked_duration_since(earlier)
        .unwrap_or(Duration::from_ticks(0))
}

/// A span in seconds, for arithmetic within one function.
///
/// Exact below 16.7 s, the longest span whose microseconds an `f32` holds; at most 71 minutes, since
/// the core converts words and a library longer numbers.
#[must_use]
pub fn seconds(span: Duration) -> f32 {
    u32::try_from(span.ticks()).unwrap_or(u32::MAX) as f32 * 1e-6
}

/// A point in time from its count of microseconds.
#[must_use]
pub const fn at_micros(micros: u64) -> Instant {
    Instant::from_ticks(micros)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_between_stamps_that_go_back_is_zero() {
        assert_eq!(span(at_micros(9), at_micros(5)), micros(0));
        assert_eq!(span(at_micros(5), at_micros(9)), micros(4));
    }

    #[test]
    fn the_clock_outlives_thirty_two_bits() {
        let before = at_micros(u64::from(u32::MAX) - 1);
        let after = at_micros(u64::from(u32::MAX) + 2);
        assert_eq!(span(before, after), micros(3));
    }
}

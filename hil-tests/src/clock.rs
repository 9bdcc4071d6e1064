//! The date of today, and how long something took: the only times read here.

use std::time::Duration;

use chrono::{DateTime, Utc};

/// As `2016-06-26`, in UTC. It stands in one line of a report and decides nothing.
#[expect(clippy::disallowed_methods, reason = "the one place that may")]
#[must_use]
pub fn today() -> String {
    let now: DateTime<Utc> = std::time::SystemTime::now().into();
    now.format("%Y-%m-%d").to_string()
}

/// How long it is since this call: for what a person gave so much time to, and for what may hang. It
/// stands in no result.
#[expect(clippy::disallowed_methods, reason = "the one place that may")]
pub fn stopwatch() -> impl Fn() -> Duration {
    let start = std::time::Instant::now();
    move || start.elapsed()
}

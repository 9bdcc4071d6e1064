//! The date of today: the only time that is read anywhere on the host.

use chrono::{DateTime, Utc};

/// As `2016-06-26`, in UTC. It stands in one line of a report and decides nothing.
#[expect(clippy::disallowed_methods, reason = "the one place that may")]
#[must_use]
pub fn today() -> String {
    let now: DateTime<Utc> = std::time::SystemTime::now().into();
    now.format("%Y-%m-%d").to_string()
}

//! Every report as JSON: one object, laid out for people too.

use serde::Serialize;

/// A report as one JSON object, ending with a new line; a number that is not finite is `null`.
///
/// # Errors
/// None in practice: every field of a report is plain data.
pub(crate) fn to_json(report: &impl Serialize) -> serde_json::Result<String> {
    serde_json::to_string_pretty(report).map(|json| json + "\n")
}

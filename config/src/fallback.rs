//! `[fallback]` of `reactive.toml`: when reactive control is left.

use serde::Deserialize;

use crate::range;

/// When reactive control is left for time-triggered control.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fallback {
    /// Length of the window in which limits are judged, in s.
    #[serde(deserialize_with = "range::window")]
    pub window_s: f64,
    /// Runs that a share is judged by.
    #[serde(deserialize_with = "range::fewest_runs")]
    pub fewest_runs: u32,
    /// False positives beyond what the models promise, as a share of triggered runs.
    #[serde(deserialize_with = "range::share")]
    pub false_positive_excess: f64,
    /// Missed changes beyond what the models promise, as a share of failsafe runs.
    #[serde(deserialize_with = "range::share")]
    pub missed_excess: f64,
    /// Runs in a window that may begin a hyperperiod late.
    #[serde(deserialize_with = "range::labels")]
    pub late_runs: u32,
    /// Setpoints that turn faster than this, in rad/s, are aerobatics.
    #[serde(deserialize_with = "range::aerobatics")]
    pub aerobatics_rad_s: f64,
    /// The longest that a fallback lasts at least, in s.
    #[serde(deserialize_with = "range::longest_fallback")]
    pub longest_s: f64,
}

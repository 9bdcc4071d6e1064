//! How long the motors waited for the newest gating sample.

use super::deviation::finite;
use super::flight_steps::FlightSteps;
use super::reason::ByReason;
use reflex::app::Reason;
use schemars::JsonSchema;
use serde::Serialize;

/// One run's latency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatencySample {
    /// When the motors were written, in microseconds of the firmware's clock.
    pub at_us: u64,
    /// Why control ran.
    pub reason: Reason,
    /// From the newest gating sample's interrupt to the write, in microseconds.
    pub micros: f64,
}

/// Percentiles by nearest rank: each one is a value that occurred.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Quantiles {
    /// How many values there were.
    pub count: u64,
    /// The median.
    pub p50: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

impl Quantiles {
    /// The percentiles of the finite ones among the values; `None` without any.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().filter_map(finite).collect();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        // Rank ceil(p n), counted from 1; whole numbers, so that no rounding moves a rank.
        let ranked = |percent: usize| sorted[(sorted.len() * percent).div_ceil(100) - 1];
        Some(Self {
            count: sorted.len() as u64,
            p50: ranked(50),
            p99: ranked(99),
            max,
        })
    }
}

/// Percentiles of each reason's runs after warm-up; null for a reason without any.
#[must_use]
pub fn latencies(flight: &FlightSteps, samples: &[LatencySample]) -> ByReason<Option<Quantiles>> {
    let end_us = flight.warm_up_end_us().unwrap_or(u64::MAX);
    let mut by_reason = ByReason::<Vec<f64>>::default();
    for sample in samples.iter().filter(|sample| sample.at_us > end_us) {
        by_reason.get_mut(sample.reason).push(sample.micros);
    }
    by_reason.map(Quantiles::of)
}

//! The load in emulated flights, and the rate of equal processor time.
//!
//! Time-triggered control keeps the processor busy for `a + c * rate`: `a` for samples and the
//! link, `c` for a run. Two emulated flights give both. Where reactive control is as busy as that
//! at some rate, the two take equal processor time.

use schemars::JsonSchema;
use serde::Serialize;

use super::journal::Records;
use super::plan::{LOAD_RATES_HZ, Plan};
use super::role::Role;
use super::sortie::{CellName, PERIODS_US, Sortie, Tier};
use crate::closed_loop::report::FlightReport;

/// What a policy takes of the processor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PolicyLoad {
    /// Busy share without any run.
    pub idle: f64,
    /// Busy share of a run a second, s.
    pub per_run_s: f64,
}

/// How busy reactive control keeps the processor.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Load {
    /// Environment, airframe and control logic.
    #[serde(flatten)]
    pub cell: CellName,
    /// Busy share of the processor, 0 to 1.
    pub busy: f64,
    /// Runs per second in that flight.
    pub rate_hz: f64,
    /// Share of these runs that were time-triggered: to learn, or because models were not trusted.
    pub learning: f64,
    /// What time-triggered control takes.
    pub periodic: PolicyLoad,
    /// What reactive control takes, where it was flown with another budget too.
    pub reactive: Option<PolicyLoad>,
    /// The rate of time-triggered control that is as busy, Hz; may be out of its range.
    pub equal_time_hz: f64,
    /// The rate that is flown: 11 to 1000 Hz.
    pub flown_hz: f64,
}

impl PolicyLoad {
    /// Through two points of rate and load; none where more runs are not more work.
    fn through([(rate, busy), (more, busier)]: [(f64, f64); 2]) -> Option<Self> {
        let per_run_s = (busier - busy) / (more - rate);
        (per_run_s.is_finite() && per_run_s > 0.0).then_some(Self {
            idle: busy - per_run_s * rate,
            per_run_s,
        })
    }

    /// How busy it is at a rate in Hz.
    #[must_use]
    pub fn busy(self, rate_hz: f64) -> f64 {
        self.idle + self.per_run_s * rate_hz
    }

    /// The rate at which it is so busy, Hz.
    fn rate_hz(self, busy: f64) -> f64 {
        (busy - self.idle) / self.per_run_s
    }
}

impl Load {
    /// The period of the rate that is flown, us.
    #[must_use]
    pub fn period_us(&self) -> u64 {
        period_us(self.equal_time_hz)
    }

    /// Whether equal processor time is out of reach of time-triggered control.
    #[must_use]
    pub fn is_clamped(&self) -> bool {
        (self.flown_hz / self.equal_time_hz - 1.0).abs() > 1e-3
    }
}

/// The whole microseconds of a rate, within what time-triggered control can keep.
#[must_use]
pub fn period_us(rate_hz: f64) -> u64 {
    let [shortest, longest] = PERIODS_US;
    if rate_hz > 0.0 {
        ((1e6 / rate_hz).round() as u64).clamp(shortest, longest)
    } else {
        longest
    }
}

/// The load of reactive control in a flight's cell; none where flights lack.
#[must_use]
pub fn measured(plan: &Plan, records: &Records, sortie: &Sortie) -> Option<Load> {
    let needs = plan.needs(sortie);
    let point = |role: Role| {
        let emulated = needs.iter().find(|need| need.role == role)?;
        seen(records, emulated)
    };
    let [slow, fast] = LOAD_RATES_HZ.map(|hz| point(Role::Periodic(hz)));
    let periodic = PolicyLoad::through([slow?, fast?])?;
    let reactive = needs.iter().find(|need| need.role == Role::Reactive)?;
    let (rate_hz, busy) = seen(records, reactive)?;
    let report = &records.flights.get(reactive)?.report;
    let finest = plan.trade.finest().and_then(point);
    let equal_time_hz = periodic.rate_hz(busy);
    Some(Load {
        cell: sortie.cell(),
        busy,
        rate_hz,
        learning: learning_share(report).unwrap_or_default(),
        periodic,
        reactive: finest.and_then(|finest| PolicyLoad::through([(rate_hz, busy), finest])),
        equal_time_hz,
        flown_hz: 1e6 / period_us(equal_time_hz) as f64,
    })
}

/// Rate and busy share of an emulated flight.
fn seen(records: &Records, emulated: &Sortie) -> Option<(f64, f64)> {
    let report = &records.flights.get(emulated)?.report;
    Some((report.control.rate_hz?, report.cpu?.busy_fraction))
}

/// Everything that was measured, in the order of the flights.
#[must_use]
pub fn all(plan: &Plan, records: &Records) -> Vec<Load> {
    let sorties = records.flights.keys();
    let reactive =
        sorties.filter(|sortie| sortie.tier == Tier::Emulated && sortie.role == Role::Reactive);
    reactive
        .filter_map(|sortie| measured(plan, records, sortie))
        .collect()
}

/// Share of the scored runs in which reactive control was time-triggered.
pub fn learning_share(report: &FlightReport) -> Option<f64> {
    let control = &report.control;
    let by_clock = control.by_reason.warm_up + control.by_reason.fallback;
    (control.runs > 0 && !report.crashed).then(|| by_clock as f64 / control.runs as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn equal_time_is_where_the_line_is_as_busy() {
        let line = PolicyLoad::through([(100.0, 0.03), (400.0, 0.06)]).unwrap();
        assert!((line.idle - 0.02).abs() < 1e-12 && (line.per_run_s - 1e-4).abs() < 1e-15);
        assert!((line.rate_hz(0.045) - 250.0).abs() < 1e-9);
        assert_eq!(PolicyLoad::through([(100.0, 0.03), (400.0, 0.03)]), None);
    }

    #[test]
    fn a_rate_that_cannot_be_kept_becomes_the_nearest_that_can() {
        for (rate_hz, period) in [
            (250.0, 4_000),
            (5000.0, 1_000),
            (1.0, 90_909),
            (-3.0, 90_909),
            (f64::NAN, 90_909),
        ] {
            assert_eq!(period_us(rate_hz), period, "{rate_hz}");
        }
    }

    proptest! {
        #[test]
        fn a_period_is_that_of_its_rate(rate_hz in 11.0..1000.0f64) {
            let period = period_us(rate_hz) as f64;
            prop_assert!((period * rate_hz / 1e6 - 1.0).abs() < 1e-3);
        }
    }
}

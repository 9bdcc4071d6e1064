//! Tuning to equal margins: how fast each policy may make its loops.
//!
//! Everybody's attitude and rate loops are made faster by the same factors, and each policy keeps the
//! fastest that still bear a drone which answers twice as strongly (6 dB) and commands that apply
//! late, hovering in the wind of the environment that they are for; all slower ones must bear it too.
//! How late, and how much the drone may turn, is the [`Rule`]: a result that only one rule shows is
//! one of the rule.

use schemars::JsonSchema;
use serde::Serialize;

use super::journal::Records;
use super::margins::{BANDWIDTHS, bandwidths, strained, tuned_roles};
use super::plan::Plan;
use super::role::Role;
use super::rule::{Contender, Rule};
use super::sortie::{CellName, Sortie};

/// How fast a policy may make the loops of one cell.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tuning {
    /// Environment, airframe and control logic.
    #[serde(flatten)]
    pub cell: CellName,
    /// The role that is flown with it.
    pub role: String,
    /// In % of the configured bandwidth.
    pub bandwidth_percent: u32,
}

/// The fastest loops that bear every strain, in %; the slowest where none do, none unflown.
#[must_use]
pub fn fastest(records: &Records, cell: &Sortie, rule: Rule, of: Contender) -> Option<u32> {
    let [mut fastest, _] = BANDWIDTHS;
    for percent in bandwidths() {
        for flight in strained(cell, rule.tempo(of), percent, &rule.strains()) {
            let report = &records.flights.get(&flight)?.report;
            let turning = report.turning_rad_s.filter(|_| !report.crashed);
            if !turning.is_some_and(|turning| rule.allows(turning)) {
                return Some(fastest);
            }
        }
        fastest = percent;
    }
    Some(fastest)
}

/// Runs per second of tuned reactive control, the mean of a cell's flights.
#[must_use]
pub fn reactive_rate_hz(plan: &Plan, records: &Records, cell: &Sortie, rule: Rule) -> Option<f64> {
    let role = Role::Tuned(rule, Contender::Reactive);
    let flights = (1..=plan.tuned_seeds).map(|seed| plan.tuned(cell, role, seed));
    let rates: Vec<f64> = flights
        .filter_map(|flight| records.flights.get(&flight)?.report.control.rate_hz)
        .collect();
    (!rates.is_empty()).then(|| rates.iter().sum::<f64>() / rates.len() as f64)
}

/// The bandwidths of every cell that is tuned.
#[must_use]
pub fn all(plan: &Plan, records: &Records) -> Vec<Tuning> {
    if plan.tuned_seeds == 0 {
        return Vec::new();
    }
    let mut tunings = Vec::new();
    for cell in plan.cells() {
        for (rule, of) in tuned_roles() {
            if let Some(bandwidth_percent) = fastest(records, &cell, rule, of) {
                tunings.push(Tuning {
                    cell: cell.cell(),
                    role: Role::Tuned(rule, of).to_string(),
                    bandwidth_percent,
                });
            }
        }
    }
    tunings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::journal::Landed;
    use crate::campaign::tests::made_up::landed;

    /// Flights under every strain, which turn the drone as the bandwidth in % says, in mrad/s.
    fn seen(rule: Rule, of: Contender, turning_mrad_s: impl Fn(u32) -> u32) -> (Records, Sortie) {
        let cell = landed(Role::Reactive, 1, 1.0).job.sortie;
        let mut records = Records::default();
        for percent in bandwidths() {
            for flight in strained(&cell, rule.tempo(of), percent, &rule.strains()) {
                let mut flown: Landed = landed(flight.role, flight.seed, 1.0);
                flown.report.turning_rad_s = Some(f64::from(turning_mrad_s(percent)) / 1e3);
                records.flights.insert(flight, flown);
            }
        }
        (records, cell)
    }

    #[test]
    fn loops_are_as_fast_as_they_and_all_slower_ones_bear() {
        let island = |percent| match percent {
            0..=140 | 240 => 50,
            160 => 200,
            _ => 2000,
        };
        let [strict, lax] = [150, 300].map(|limit_mrad_s| Rule {
            limit_mrad_s,
            ..Rule::MIDDLE
        });
        for (rule, expected) in [(strict, 140), (lax, 160)] {
            let (records, cell) = seen(rule, Contender::Reactive, island);
            let fastest = fastest(&records, &cell, rule, Contender::Reactive);
            assert_eq!(fastest, Some(expected));
        }
    }

    #[test]
    fn without_a_flight_that_decides_there_is_no_bandwidth() {
        let rule = Rule::MIDDLE;
        let (mut records, cell) = seen(rule, Contender::EqualRuns, |_| 0);
        let full = fastest(&records, &cell, rule, Contender::EqualRuns);
        assert_eq!(full, Some(BANDWIDTHS[1]));
        assert_eq!(fastest(&records, &cell, rule, Contender::Usual), None);
        records
            .flights
            .retain(|flight, _| !matches!(flight.role, Role::Margin(_, 80, _)));
        assert_eq!(fastest(&records, &cell, rule, Contender::EqualRuns), None);
    }
}

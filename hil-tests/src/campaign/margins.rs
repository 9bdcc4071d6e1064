//! The flights that show how fast a policy's loops may be before they oscillate.

use super::role::Role;
use super::rule::{Contender, Rule, Strain, Tempo};
use super::sortie::Sortie;

/// Seeds that margins are seen with, 1 to this.
pub const SEEDS: u32 = 2;
/// From take-off to the end of a flight that margins are seen in, s.
pub const DURATION_S: u32 = 20;

/// Slowest and fastest loops that are tried, in % of the configured bandwidth.
pub const BANDWIDTHS: [u32; 2] = [50, 500];

/// Bandwidths from slow to fast, in %: steps of 20 through 100.
pub fn bandwidths() -> impl Iterator<Item = u32> {
    let [slowest, fastest] = BANDWIDTHS;
    [slowest].into_iter().chain((60..=fastest).step_by(20))
}

/// Every contender under every rule.
pub fn tuned_roles() -> impl Iterator<Item = (Rule, Contender)> {
    let rules = Rule::ALL.into_iter();
    rules.flat_map(|rule| Contender::ALL.map(|of| (rule, of)))
}

/// The flights that show every margin of a cell, given any flight of it.
#[must_use]
pub fn margins(cell: &Sortie, tempo: Tempo) -> Vec<Sortie> {
    let strains = tempo.strains();
    bandwidths()
        .flat_map(|percent| strained(cell, tempo, percent, &strains))
        .collect()
}

/// The flights under some strains, with loops of one bandwidth in %.
#[must_use]
pub fn strained(cell: &Sortie, tempo: Tempo, percent: u32, strains: &[Strain]) -> Vec<Sortie> {
    let flight = |(strain, seed)| Sortie {
        duration_s: DURATION_S,
        role: Role::Margin(tempo, percent, strain),
        seed,
        ..cell.clone()
    };
    let seeds = |strain: &Strain| {
        let strain = *strain;
        (1..=SEEDS).map(move |seed| (strain, seed))
    };
    strains.iter().flat_map(seeds).map(flight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logics::{GainSet, LogicName};
    use clap::ValueEnum;

    #[test]
    fn bandwidths_go_from_half_to_five_times_in_steps_of_a_fifth_at_most() {
        let percents: Vec<u32> = bandwidths().collect();
        assert_eq!([percents[0], *percents.last().unwrap()], BANDWIDTHS);
        assert!(
            percents
                .windows(2)
                .all(|pair| (1..=20).contains(&(pair[1] - pair[0])))
        );
        assert!(percents.contains(&100));
    }

    #[test]
    fn every_gain_stays_in_its_range_at_every_bandwidth() {
        for logic in LogicName::value_variants() {
            let varied = logic.variations();
            let names = [None]
                .into_iter()
                .chain(varied.iter().map(|name| Some(&**name)));
            for name in names {
                for percent in BANDWIDTHS {
                    GainSet::load(*logic, name, f64::from(percent) / 100.0).unwrap();
                }
            }
        }
    }
}

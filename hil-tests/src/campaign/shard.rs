//! Parts of a campaign, for computers that share a folder.

use std::collections::BTreeSet;
use std::str::FromStr;

use super::plan::{Plan, Unit};
use super::role::Role;
use super::sortie::{Sortie, Tier};

/// How much longer a second of emulated flight takes than a native one.
const EMULATED_WEIGHT: u64 = 150;

/// One of a campaign's equal parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which, from 1.
    pub index: u32,
    /// Of how many.
    pub of: u32,
}

impl Plan {
    /// The flights of a part, with those that they wait for, whoever owns these.
    #[must_use]
    pub fn part(&self, shard: Option<Shard>) -> BTreeSet<Sortie> {
        let own: BTreeSet<Sortie> = match shard {
            None => self.units().into_iter().flat_map(|unit| unit.0).collect(),
            Some(shard) => shard.of(self.units()).flat_map(|unit| unit.0).collect(),
        };
        let waiting = own.iter().filter(|sortie| sortie.role == Role::EqualTime);
        let needed: BTreeSet<Sortie> = waiting.flat_map(|sortie| self.needs(sortie)).collect();
        own.into_iter().chain(needed).collect()
    }
}

impl Unit {
    fn weight(&self) -> u64 {
        let weights = self.0.iter().map(|sortie| {
            let seconds = u64::from(sortie.duration_s);
            match sortie.tier {
                Tier::Emulated => seconds * EMULATED_WEIGHT,
                Tier::Native => seconds,
            }
        });
        weights.sum()
    }
}

impl Shard {
    /// Its units, which are neighbours.
    ///
    /// Every unit is of exactly one part: that in which the middle of its weight falls.
    fn of(self, units: Vec<Unit>) -> impl Iterator<Item = Unit> {
        let total: u64 = units.iter().map(Unit::weight).sum();
        let mut before = 0;
        units.into_iter().filter(move |unit| {
            let middle = 2 * before + unit.weight();
            before += unit.weight();
            let place = u128::from(middle) * u128::from(self.of) / u128::from(2 * total.max(1));
            place == u128::from(self.index - 1)
        })
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(index, of)| {
            let number = |text: &str| {
                text.bytes()
                    .all(|c| c.is_ascii_digit())
                    .then(|| text.parse().ok())?
            };
            Some((number(index)?, number(of)?))
        });
        match numbers {
            Some((index, of)) if (1..=of).contains(&index) && of <= 10_000 => {
                Ok(Self { index, of })
            }
            _ => Err("must be I/N with I from 1 to N, and N at most 10000".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_no_part_is_refused() {
        for text in [
            "", "1", "0/3", "4/3", "1/0", "-1/3", "a/b", "1/3/5", "+1/3", " 1/3", "1/10001",
        ] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, of: 3 }));
    }

    proptest! {
        #[test]
        fn parts_are_disjoint_and_complete(of in 1..60u32, seeds in 1..6u32, smoke: bool) {
            let name = if smoke { "smoke" } else { "paper" };
            let plan = Plan::named(name, Some(seeds)).unwrap();
            let mut parts = Vec::new();
            for index in 1..=of {
                parts.extend(Shard { index, of }.of(plan.units()).flat_map(|unit| unit.0));
            }
            let count = parts.len();
            let all: BTreeSet<Sortie> = parts.into_iter().collect();
            prop_assert_eq!(all.len(), count, "no flight is of two parts");
            prop_assert_eq!(all, plan.part(None));
        }

        #[test]
        fn a_part_holds_what_its_flights_wait_for(index in 1..=7u32) {
            let plan = Plan::named("paper", Some(2)).unwrap();
            let part = plan.part(Some(Shard { index, of: 7 }));
            let waits = part.iter().filter(|sortie| sortie.role == Role::EqualTime);
            for need in waits.flat_map(|sortie| plan.needs(sortie)) {
                prop_assert!(part.contains(&need));
            }
        }
    }
}

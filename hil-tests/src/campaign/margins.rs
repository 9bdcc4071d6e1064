//! The flights that show how fast a policy's loops may be before they oscillate.

use super::role::{Contender, Role, Strain};
use super::sortie::Sortie;

/// Seeds that margins are seen with, 1 to this.
pub const SEEDS: u32 = 2;
/// From take-off to the end of a flight that margins are seen in, s.
pub const DURATION_S: u32 = 20;

/// Bandwidths in % of the configured one, from slow to fast.
pub const BANDWIDTHS: [u32; 5] = [50, 70, 100, 140, 200];

/// The flights that show the margins of a cell, given any flight of it.
#[must_use]
pub fn margins(cell: &Sortie, of: Contender) -> Vec<Sortie> {
    BANDWIDTHS
        .into_iter()
        .flat_map(|percent| strained(cell, of, percent))
        .collect()
}

/// The flights under every strain, with loops of one bandwidth in %.
#[must_use]
pub fn strained(cell: &Sortie, of: Contender, percent: u32) -> Vec<Sortie> {
    let flight = |(strain, seed)| Sortie {
        duration_s: DURATION_S,
        role: Role::Margin(of, percent, strain),
        seed,
        ..cell.clone()
    };
    let strains = Strain::ALL.into_iter();
    let pairs = strains.flat_map(|strain| (1..=SEEDS).map(move |seed| (strain, seed)));
    pairs.map(flight).collect()
}

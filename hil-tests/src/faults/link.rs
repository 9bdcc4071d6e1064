//! What a broken link makes of a ground station's messages.

use mavlink::dialects::common::MavMessage;
use rand_distr::{Distribution, StandardUniform};
use random_streams::{Generator, generator};

use super::kinds::{Effect, Said};
use super::script::{Fault, Script};

/// Keeps garbage apart from other chance of the same seed.
const STREAM: u64 = 0x4C49_4E4B;

/// The link of a flight.
#[derive(Clone, Debug)]
pub struct BrokenLink {
    faults: Script,
    garbage: Generator,
}

impl BrokenLink {
    /// That of a script.
    #[must_use]
    pub fn of(faults: &Script) -> Self {
        let noisy = |fault: &&Fault| matches!(fault.effect, Effect::Said(Said::Garbage(_)));
        let seed = faults.iter().find(noisy).map_or(0, |fault| fault.seed);
        Self {
            faults: faults.clone(),
            garbage: generator(seed.into(), STREAM),
        }
    }

    /// How often a message is sent: once, unless the link has a fault.
    #[must_use]
    pub fn times(&self, at_ns: u64, message: &MavMessage) -> usize {
        let is_place = matches!(message, MavMessage::ODOMETRY(_));
        let is_demand = matches!(
            message,
            MavMessage::SET_ATTITUDE_TARGET(_) | MavMessage::SET_POSITION_TARGET_LOCAL_NED(_)
        );
        self.said(at_ns).fold(1, |times, said| match said {
            Said::Silent => 0,
            Said::NoSetpoints if is_demand => 0,
            Said::NoPlaces if is_place => 0,
            Said::Storm(count) if is_demand => times * count as usize,
            _ => times,
        })
    }

    /// Random bytes, where they come; it is asked for them so many times a second.
    pub fn noise(&mut self, at_ns: u64, asked_hz: usize) -> Option<Vec<u8>> {
        let rate = self.said(at_ns).find_map(|said| match said {
            Said::Garbage(rate) => Some(rate),
            _ => None,
        });
        let count = rate? as usize / asked_hz;
        let even = StandardUniform;
        Some((0..count).map(|_| even.sample(&mut self.garbage)).collect())
    }

    fn said(&self, at_ns: u64) -> impl Iterator<Item = Said> {
        self.faults
            .now(at_ns)
            .filter_map(|fault| match fault.effect {
                Effect::Said(said) => Some(said),
                _ => None,
            })
    }
}

//! Fuzzing: inputs that nobody meant, made from a seed, for all that reads.
//!
//! A [`Target`] is something that takes bytes, with what must hold of it whatever they are. Its inputs are sound ones
//! (`hil-tests/corpus/`, `config/`) spoilt by a few edits, or made from random numbers by the rules of its
//! format. Input `n` of a seed is the same on any machine, whichever came before it.
//!
//! Inputs are tried in a process of their own ([`worker`]), so that one that takes all memory, overflows the stack or
//! never ends is found like one that panics.

mod autopilot;
mod configuration;
mod flyer;
mod journals;
mod link;
mod logs;
mod misbehaving;
mod records;
mod samples;
mod spoil;
mod store;
pub mod worker;

use anyhow::Result;
use arbitrary::Unstructured;
use rand_chacha::rand_core::Rng;
use random_streams::generator;

use samples::Sample;

/// Random bytes that an input is made from.
const ENTROPY: usize = 4096;

/// Something to be fuzzed.
#[derive(Clone, Copy)]
pub struct Target {
    /// As on the command line.
    pub name: &'static str,
    /// What it reads.
    pub reads: &'static str,
    /// Inputs of a run of continuous integration: some seconds.
    pub inputs: u64,
    load: fn() -> Result<Loaded>,
}

/// A target at hand.
pub struct Loaded {
    source: Source,
    check: Check,
}

/// Where inputs come from.
enum Source {
    /// Sound inputs, to be spoilt.
    Spoilt(Vec<Sample>),
    /// Made from random numbers.
    Made(fn(&mut Unstructured<'_>) -> arbitrary::Result<Vec<u8>>),
}

/// Tries an input, and panics where something does not hold; whether the input was accepted.
type Check = Box<dyn Fn(&[u8]) -> bool>;

/// Everything that is fuzzed.
pub const TARGETS: [Target; 17] = [
    logs::ULOG,
    logs::BLACKBOX,
    logs::DATAFLASH,
    logs::USD,
    logs::CSV,
    logs::PACKED,
    configuration::CONFIGURATION,
    configuration::GAINS,
    configuration::OPTIONS,
    journals::FAULTS,
    journals::JOURNAL,
    records::SETTINGS,
    store::STORE,
    records::CALLS,
    records::LOG,
    link::LINK,
    autopilot::AUTOPILOT,
];

impl Target {
    /// The target of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let mut all = TARGETS.into_iter().chain(misbehaving::MISBEHAVING);
        all.find(|target| target.name == name)
    }

    /// Gets what its inputs are made from, and what tries them.
    ///
    /// # Errors
    /// A sound input cannot be had.
    pub fn load(self) -> Result<Loaded> {
        (self.load)()
    }
}

impl Loaded {
    fn new(source: Source, check: impl Fn(&[u8]) -> bool + 'static) -> Self {
        let check = Box::new(check);
        Self { source, check }
    }

    /// Tries one input; whether it was accepted.
    ///
    /// # Panics
    /// Something that must hold does not.
    #[must_use]
    pub fn accepts(&self, input: &[u8]) -> bool {
        (self.check)(input)
    }

    /// The input of a number: sound ones come first, as they are.
    #[must_use]
    pub fn input(&self, seed: u64, number: u64) -> Vec<u8> {
        let mut entropy = [0; ENTROPY];
        generator(seed, number).fill_bytes(&mut entropy);
        let mut from = Unstructured::new(&entropy);
        match &self.source {
            Source::Made(make) => make(&mut from).unwrap_or_default(),
            Source::Spoilt(samples) => match samples.get(number as usize) {
                Some(sound) => sound.bytes.clone(),
                None => spoil::spoilt(samples, &mut from).unwrap_or_default(),
            },
        }
    }

    /// How many inputs are sound: the first.
    #[must_use]
    pub fn sound(&self) -> u64 {
        match &self.source {
            Source::Made(_) => 0,
            Source::Spoilt(samples) => samples.len() as u64,
        }
    }
}

/// Holds a refusal to what every one must be: one line, not too long.
fn is_one_line(refusal: &str) {
    let long = refusal.chars().count() > 1000;
    assert!(
        !refusal.contains(['\n', '\r']) && !long,
        "refused with {refusal:?}"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_follows_from_seed_and_number_alone() {
        let csv = Target::named("csv").unwrap().load().unwrap();
        let later = csv.sound() + 7;
        assert_eq!(csv.input(1, later), csv.input(1, later));
        assert_ne!(csv.input(1, later), csv.input(2, later));
        assert_ne!(csv.input(1, later), csv.input(1, later + 1));
    }

    #[test]
    fn every_sound_input_is_accepted() {
        for target in TARGETS.into_iter().filter(|target| target.name != "log") {
            let loaded = target.load().unwrap();
            for number in 0..loaded.sound() {
                let input = loaded.input(1, number);
                assert!(loaded.accepts(&input), "{} {number}", target.name);
            }
        }
    }
}

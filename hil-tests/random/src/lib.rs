//! Random numbers of a seed: noise, oscillators and wind each have a stream.

#![forbid(unsafe_code)]

pub use rand_chacha::ChaCha8Rng as Generator;
use rand_chacha::rand_core::SeedableRng;

/// The numbers of one stream of a seed: drawing from it moves no other stream.
pub fn generator(seed: u64, stream: u64) -> Generator {
    let mut generator = Generator::seed_from_u64(seed);
    generator.set_stream(stream);
    generator
}

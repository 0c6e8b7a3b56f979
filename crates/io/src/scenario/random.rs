//! Seeded random numbers, the same on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Streams of the random numbers, so that one seed used twice does not make one quantity follow another.
#[derive(Clone, Copy)]
pub(super) enum Stream {
    Position,
    Velocity,
    /// The reference velocity, and its derivatives.
    Reference(usize),
    /// States of a chain beyond its velocity.
    Higher,
    /// What filters hold.
    Filter,
    /// Parameters of robots.
    Spread,
}

impl Stream {
    fn number(self) -> u64 {
        match self {
            Stream::Position => 0,
            Stream::Velocity => 1,
            Stream::Reference(derivative) => 2 + derivative as u64,
            Stream::Filter => u64::MAX - 2,
            Stream::Higher => u64::MAX - 1,
            Stream::Spread => u64::MAX,
        }
    }
}

/// `length` numbers from 0 up to 1 for the agent `index` of those that share a draw.
///
/// Every agent has its place in one stream of numbers, so that adding agents leaves the others where they were.
pub(super) fn draws(seed: u64, stream: Stream, index: usize, length: usize) -> impl Iterator<Item = f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream.number());
    // A draw of 64 bits takes two words.
    generator.set_word_pos(2 * index as u128 * length as u128);
    (0..length).map(move |_| (generator.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64))
}

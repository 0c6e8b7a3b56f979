//! Graphs drawn at random.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Dwell, Extent, KnownSwitching, Schedule, Segment, Segments, SwitchingSignal, check_dwell};
use crate::graph::Edge;
use crate::quantity::{QuantityError, such};

/// A seeded random draw: at every switch one of the graphs, equally likely, for a dwell time drawn uniformly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomSwitching {
    /// Shortest and longest dwell, s.
    pub dwell_s: [f64; 2],
    /// Seed of the draw.
    pub seed: u64,
}

impl Schedule {
    /// One of `graphs` drawn at every switch, for a time drawn between the two of `dwell_s`, s.
    pub fn random(graphs: Vec<Vec<Edge>>, dwell_s: [f64; 2], seed: u64) -> Schedule {
        Schedule::new(graphs, RandomSwitching { dwell_s, seed })
    }
}

impl SwitchingSignal for RandomSwitching {
    fn words(&self) -> &'static str {
        "random switching"
    }

    fn validate(&self, _: usize) -> Result<(), QuantityError> {
        check_dwell(&self.dwell_s)?;
        let [low, high] = self.dwell_s;
        such(high >= low, "", "dwell_s", high, "the longest must not be below the shortest")
    }

    fn segments(&self, graphs: usize) -> Segments<'_> {
        let mut draw = ChaCha8Rng::seed_from_u64(self.seed);
        let ([low, high], mut start_s) = (self.dwell_s, 0.0);
        Segments::new(std::iter::from_fn(move || {
            // There is none to draw among none.
            let graph = (graphs > 0).then(|| draw.random_range(0..graphs))?;
            let share: f64 = draw.random();
            let end_s = start_s + low + share * (high - low);
            let segment = Segment { start_s, end_s, graph };
            start_s = end_s;
            Some(segment)
        }))
    }

    fn known(&self) -> KnownSwitching {
        KnownSwitching { extent: Extent::Horizon, dwell: Dwell::Drawn(self.dwell_s[0]) }
    }
}

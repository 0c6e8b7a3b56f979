//! Graphs drawn at random.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Dwell, Extent, KnownSwitching, Schedule, Segment, Segments, SwitchingSignal};
use crate::graph::Edge;
use crate::quantity::{MOST_EVENTS, Path, QuantityError, at_most, each, few, positive};

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

    fn validate(&self, _: usize, end_s: f64) -> Result<(), QuantityError> {
        let (at, [low, high]) = (Path::from("switching.random"), self.dwell_s);
        each(at.clone(), "dwell_s", &self.dwell_s, positive)?;
        at_most(at.clone().key("dwell_s").index(0), "", low, ("the longest", high))?;
        few(at, "dwell_s", low, ("switches", 2.0 * end_s / (low + high), MOST_EVENTS))
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
        KnownSwitching { extent: Extent::Drawn, dwell: Dwell::Drawn(self.dwell_s[0]) }
    }
}

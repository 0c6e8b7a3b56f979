//! Graphs that take turns again and again.

use super::{Dwell, Extent, KnownSwitching, Phase, Schedule, Segment, Segments, SwitchingSignal, check_dwell, split};
use crate::quantity::{MOST_EVENTS, QuantityError, few};

/// The graphs in turn, again and again.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// How long each lasts, s.
    pub dwell_s: Vec<f64>,
}

impl Schedule {
    /// The phases in turn, again and again.
    pub fn periodic(phases: Vec<Phase>) -> Schedule {
        let (graphs, dwell_s) = split(phases);
        Schedule::new(graphs, Periodic { dwell_s })
    }
}

impl SwitchingSignal for Periodic {
    fn words(&self) -> &'static str {
        "periodic switching"
    }

    fn validate(&self, graphs: usize, end_s: f64) -> Result<(), QuantityError> {
        check_dwell(&self.dwell_s, graphs)?;
        let round_s: f64 = self.dwell_s.iter().sum();
        few("phases", "", round_s, ("switches", end_s / round_s * graphs as f64, MOST_EVENTS))
    }

    fn segments(&self, _: usize) -> Segments<'_> {
        let sums = self.dwell_s.iter().scan(0.0, |sum_s, dwell_s| {
            *sum_s += dwell_s;
            Some(*sum_s)
        });
        let ends_s: Vec<f64> = sums.collect();
        let period_s = ends_s.last().copied().unwrap_or(0.0);
        let mut start_s = 0.0;
        let graphs = ends_s.len();
        let rounds = (0_u64..).flat_map(move |round| (0..graphs).map(move |graph| (round, graph)));
        Segments::new(rounds.map(move |(round, graph)| {
            // Summed within the period and multiplied across periods, so that rounding does not pile up.
            let end_s = round as f64 * period_s + ends_s[graph];
            let segment = Segment { start_s, end_s, graph };
            start_s = end_s;
            segment
        }))
    }

    fn known(&self) -> KnownSwitching {
        let shortest_s = self.dwell_s.iter().copied().fold(f64::INFINITY, f64::min);
        KnownSwitching { extent: Extent::Period(self.dwell_s.len()), dwell: Dwell::Shortest(shortest_s) }
    }
}

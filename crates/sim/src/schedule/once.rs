//! Graphs that take turns once.

use super::{Dwell, Extent, KnownSwitching, Phase, Schedule, Segment, Segments, SwitchingSignal, check_dwell, split};
use crate::graph::Edge;
use crate::quantity::QuantityError;

/// The graphs in turn; the last one stays for ever.
#[derive(Clone, Debug, PartialEq)]
pub struct Once {
    /// How long each lasts but the last, s.
    pub dwell_s: Vec<f64>,
}

impl Schedule {
    /// One graph for ever.
    pub fn fixed(edges: Vec<Edge>) -> Schedule {
        Schedule::new(vec![edges], Once { dwell_s: Vec::new() })
    }

    /// The phases in turn; the last one stays for ever.
    pub fn once(phases: Vec<Phase>) -> Schedule {
        let (graphs, mut dwell_s) = split(phases);
        dwell_s.pop();
        Schedule::new(graphs, Once { dwell_s })
    }
}

impl SwitchingSignal for Once {
    fn words(&self) -> &'static str {
        "switching once through"
    }

    fn validate(&self, graphs: usize, _: f64) -> Result<(), QuantityError> {
        check_dwell(&self.dwell_s, graphs.saturating_sub(1))
    }

    fn segments(&self, graphs: usize) -> Segments<'_> {
        let mut start_s = 0.0;
        Segments::new((0..graphs).map(move |graph| {
            let end_s = self.dwell_s.get(graph).map_or(f64::INFINITY, |dwell_s| start_s + dwell_s);
            let segment = Segment { start_s, end_s, graph };
            start_s = end_s;
            segment
        }))
    }

    fn known(&self) -> KnownSwitching {
        let dwell = match &self.dwell_s[..] {
            [] => Dwell::NeverSwitches,
            dwell_s => Dwell::Shortest(dwell_s.iter().copied().fold(f64::INFINITY, f64::min)),
        };
        KnownSwitching { extent: Extent::Whole, dwell }
    }
}

//! Graphs that take turns as a table says.

use super::{Dwell, Extent, KnownSwitching, Schedule, Segment, Segments, SwitchingSignal};
use crate::graph::Edge;
use crate::quantity::{Path, QuantityError, as_many, at_least, filled, more_than, such, within};

/// From `starts_s[k]` on graph `graphs[k]` is in force, as it was drawn or observed up to `until_s`.
#[derive(Clone, Debug, PartialEq)]
pub struct Logged {
    /// Rising, the first is zero, s.
    pub starts_s: Vec<f64>,
    /// As many graphs, by their indices.
    pub graphs: Vec<usize>,
    /// The end of the last of them, s.
    pub until_s: f64,
}

impl Schedule {
    /// These graphs as a table says.
    pub fn logged(graphs: Vec<Vec<Edge>>, log: Logged) -> Schedule {
        Schedule::new(graphs, log)
    }
}

impl SwitchingSignal for Logged {
    fn words(&self) -> &'static str {
        "logged switching"
    }

    fn validate(&self, graphs: usize, end_s: f64) -> Result<(), QuantityError> {
        let at = || Path::from("switching.log");
        filled(at(), "starts_s", &self.starts_s)?;
        such(self.starts_s[0] == 0.0, at().key("starts_s").index(0), "", self.starts_s[0], "must begin at 0")?;
        let ends_s = self.starts_s[1..].iter().copied().chain([self.until_s]);
        for (k, (start_s, end_s)) in self.starts_s.iter().zip(ends_s).enumerate() {
            more_than(at().key("starts_s").index(k + 1), "", end_s, ("the one before", *start_s))?;
        }
        as_many(at(), "starts_s", &self.starts_s, ("graphs", self.graphs.len()))?;
        for (k, graph) in self.graphs.iter().enumerate() {
            within(at().key("graphs").index(k), "", *graph as f64, 0.0, graphs as f64 - 1.0)?;
        }
        at_least(at(), "until_s", self.until_s, ("the end of the run", end_s))
    }

    fn segments(&self, _: usize) -> Segments<'_> {
        let ends_s = self.starts_s.iter().skip(1).copied().chain([self.until_s]);
        let each = self.starts_s.iter().zip(ends_s).zip(&self.graphs);
        Segments::new(each.map(|((start_s, end_s), graph)| Segment { start_s: *start_s, end_s, graph: *graph }))
    }

    /// The last may be cut short by the end of the table.
    fn known(&self) -> KnownSwitching {
        let dwell_s = self.starts_s.windows(2).map(|pair| pair[1] - pair[0]);
        let shortest_s = dwell_s.fold(f64::INFINITY, f64::min);
        let dwell = if shortest_s.is_finite() { Dwell::Shortest(shortest_s) } else { Dwell::NeverSwitches };
        KnownSwitching { extent: Extent::Horizon, dwell }
    }
}

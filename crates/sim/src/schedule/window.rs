//! The smallest uniform window of a schedule.

use std::collections::HashMap;

use super::{Extent, Schedule, Segment};
use crate::graph::{Edge, SpanningTree, spanning_tree};

/// Segments of a run that are looked at.
pub(super) const MOST_SEGMENTS: usize = 10_000_000;

/// The smallest uniform window of a schedule: the hypothesis of Theorems 2–5 made quantitative.
#[derive(Clone, Debug, PartialEq)]
pub enum Window {
    /// From every switching instant (up to the horizon, for schedules without a period) a run of whole phases no longer
    /// than this has a union with a directed spanning tree.
    Uniform {
        /// In s; zero when one graph stays for ever.
        length_s: f64,
        /// Switching instant from which the longest run was needed, s.
        worst_start_s: f64,
        /// Agents that can be the root of the union over that run.
        roots: Vec<usize>,
        /// Whether this is shown for all time, or only up to the horizon.
        for_all_time: bool,
    },
    /// From `start_s` on (up to the horizon, for schedules without a period) no union has a directed spanning tree.
    Missing {
        /// In s.
        start_s: f64,
        /// Groups that hear nobody outside themselves in the union of all that follows.
        closed_groups: Vec<Vec<usize>>,
    },
}

impl Schedule {
    /// Looks for the smallest uniform window. `agents` is the number of vertices; schedules without a period are judged
    /// on [0, `end_s`].
    ///
    /// A run of phases that the horizon cuts off is not held against a random schedule: it is only asked of switching
    /// instants from which a union was complete before the end, and at least of t = 0.
    pub fn window(&self, agents: usize, end_s: f64) -> Window {
        // One period from every phase, twice over, is all a periodic schedule can show; a finite one ends by itself.
        let segments: Vec<Segment> = match self.known().extent {
            Extent::Whole => self.segments().collect(),
            Extent::Period(segments) => self.segments().take(2 * segments).collect(),
            Extent::Horizon => self
                .segments()
                .take_while(|s| s.start_s < end_s && s.graph < self.graphs.len())
                .take(MOST_SEGMENTS)
                .collect(),
        };
        let (starts, for_all_time) = match self.known().extent {
            Extent::Whole => (segments.len(), true),
            Extent::Period(segments) => (segments, true),
            Extent::Horizon => (segments.len(), false),
        };
        let last_for_ever = segments.last().is_some_and(|s| s.end_s.is_infinite());
        let (mut length_s, mut worst_start_s, mut worst_roots) = (-1.0, 0.0, Vec::new());
        // The run from a later phase never ends earlier, so both ends of it only move forwards.
        let (mut union, mut next) = (Union::new(self, agents), 0);
        for first in 0..starts {
            while next < segments.len() && (next <= first || union.roots().is_none()) {
                union.add(segments[next].graph);
                next += 1;
            }
            let start_s = segments[first].start_s;
            let Some(roots) = union.roots() else {
                if !for_all_time && first > 0 {
                    break;
                }
                let SpanningTree::Missing { closed_groups } = spanning_tree(agents, union.edges()) else { break };
                return Window::Missing { start_s, closed_groups };
            };
            let last = segments[next - 1];
            // A last graph that stays for ever can be cut into windows as short as one likes.
            let end = if last.end_s.is_infinite() { last.start_s } else { last.end_s };
            if end - start_s > length_s {
                (length_s, worst_start_s, worst_roots) = (end - start_s, start_s, roots.to_vec());
            }
            union.remove(segments[first].graph);
        }
        // A schedule that ends needs infinitely many windows in its last graph.
        if last_for_ever
            && let Some(last) = segments.last()
            && let SpanningTree::Missing { closed_groups } = spanning_tree(agents, self.graph(last.graph))
        {
            return Window::Missing { start_s: last.start_s, closed_groups };
        }
        Window::Uniform { length_s, worst_start_s, roots: worst_roots, for_all_time }
    }
}

/// Unions that are remembered.
const MOST_UNIONS: usize = 4096;

/// The union of the graphs of a run of phases.
struct Union<'a> {
    schedule: &'a Schedule,
    agents: usize,
    /// How many phases of the run have each graph.
    count: Vec<u32>,
    /// The graphs that some phase has, as bits, and the roots of every such union seen so far, if it has a spanning tree:
    /// a schedule of a million switches shows a few unions again and again.
    present: Vec<u64>,
    known: HashMap<Vec<u64>, Option<Vec<usize>>>,
}

impl<'a> Union<'a> {
    fn new(schedule: &'a Schedule, agents: usize) -> Self {
        let graphs = schedule.graphs.len();
        let (count, present) = (vec![0; graphs], vec![0; graphs.div_ceil(64)]);
        Union { schedule, agents, count, present, known: HashMap::new() }
    }

    fn add(&mut self, graph: usize) {
        self.count[graph] += 1;
        self.present[graph / 64] |= 1 << (graph % 64);
    }

    fn remove(&mut self, graph: usize) {
        self.count[graph] -= 1;
        if self.count[graph] == 0 {
            self.present[graph / 64] &= !(1 << (graph % 64));
        }
    }

    fn edges(&self) -> impl Iterator<Item = &'a Edge> {
        let present = self.count.iter().enumerate().filter(|(_, count)| **count > 0);
        present.flat_map(|(graph, _)| self.schedule.graph(graph))
    }

    /// The agents that can be the root of a spanning tree.
    fn roots(&mut self) -> Option<&[usize]> {
        if !self.known.contains_key(&self.present) {
            if self.known.len() >= MOST_UNIONS {
                self.known.clear();
            }
            let roots = match spanning_tree(self.agents, self.edges()) {
                SpanningTree::Rooted { roots } => Some(roots),
                SpanningTree::Missing { .. } => None,
            };
            self.known.insert(self.present.clone(), roots);
        }
        self.known.get(&self.present)?.as_deref()
    }
}

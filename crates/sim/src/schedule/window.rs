//! The smallest uniform window of a schedule.

use super::union::Union;
use super::{Extent, Schedule, Segment};
use crate::graph::{SpanningTree, spanning_tree};

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
    /// Every graph that can be drawn has a directed spanning tree by itself: any window will do, whatever the draws.
    EveryGraph,
    /// There are runs of phases with a directed spanning tree, but the horizon is not more than twice as long as one waits for the phase that
    /// completes one, or waits in vain up to its end: nothing is seen to come back.
    Once {
        /// How long one waits, s.
        wait_s: f64,
        /// The switching instant from which on, s.
        start_s: f64,
    },
    /// From `start_s` on no union has a directed spanning tree.
    Missing {
        /// In s.
        start_s: f64,
        /// Whether that is so for ever, or only up to the horizon, after which an edge may come that was not there before.
        for_ever: bool,
        /// Groups that hear no agent outside themselves in the union of all that follows.
        closed_groups: Vec<Vec<usize>>,
    },
}

impl Schedule {
    /// Looks for the smallest uniform window. `agents` is the number of vertices; schedules without a period are judged
    /// on [0, `end_s`].
    ///
    /// What can be in force altogether is looked at first: where the union of all graphs has no spanning tree, no window has one.
    /// A graph that has a tree by itself can be cut into windows as short as one likes, so where each that can be drawn has one,
    /// nothing is left to the draws.
    ///
    /// A run of phases that the horizon cuts off is not complete, and it tells how long a window is at least.
    pub fn window(&self, agents: usize, end_s: f64) -> Window {
        let extent = self.known().extent;
        if extent != Extent::Horizon
            && let Some(graph) = self.constant_graph()
        {
            return match spanning_tree(agents, graph) {
                SpanningTree::Rooted { roots } => {
                    Window::Uniform { length_s: 0.0, worst_start_s: 0.0, roots, for_all_time: true }
                }
                SpanningTree::Missing { closed_groups } => {
                    Window::Missing { start_s: 0.0, for_ever: true, closed_groups }
                }
            };
        }
        if extent != Extent::Whole
            && let SpanningTree::Missing { closed_groups } = spanning_tree(agents, self.graphs.iter().flatten())
        {
            return Window::Missing { start_s: 0.0, for_ever: true, closed_groups };
        }
        let rooted = |graph| matches!(spanning_tree(agents, graph), SpanningTree::Rooted { .. });
        if extent == Extent::Drawn && self.graphs.iter().all(rooted) {
            return Window::EveryGraph;
        }
        // One period from every phase, twice over, is all a periodic schedule can show; a finite one ends by itself.
        let segments: Vec<Segment> = match extent {
            Extent::Whole => self.segments().collect(),
            Extent::Period(segments) => self.segments().take(2 * segments).collect(),
            Extent::Drawn | Extent::Horizon => self
                .segments()
                .take_while(|s| s.start_s < end_s && s.graph < self.graphs.len())
                .take(MOST_SEGMENTS)
                .collect(),
        };
        let (starts, for_all_time) = match extent {
            Extent::Whole => (segments.len(), true),
            Extent::Period(segments) => (segments, true),
            Extent::Drawn | Extent::Horizon => (segments.len(), false),
        };
        // A schedule that ends needs infinitely many windows in its last graph; what was there before never comes back.
        let cut_at_last = || {
            let last = segments.last().filter(|last| last.end_s.is_infinite())?;
            match spanning_tree(agents, self.graph(last.graph)) {
                SpanningTree::Rooted { .. } => None,
                SpanningTree::Missing { closed_groups } => {
                    Some(Window::Missing { start_s: last.start_s, for_ever: true, closed_groups })
                }
            }
        };
        if let Some(cut) = cut_at_last().filter(|_| for_all_time) {
            return cut;
        }
        let (mut length_s, mut worst_start_s, mut worst_roots) = (-1.0, 0.0, Vec::new());
        // How long one waits for the phase that completes a union, and from when on.
        let (mut wait_s, mut waits_from_s) = (0.0, 0.0);
        // The run from a later phase never ends earlier, so both ends of it only move forwards.
        let (mut union, mut next) = (Union::new(self, agents), 0);
        for first in 0..starts {
            while next < segments.len() && (next <= first || !union.is_rooted()) {
                union.add(segments[next].graph);
                next += 1;
            }
            let start_s = segments[first].start_s;
            if !union.is_rooted() {
                if !for_all_time && first > 0 {
                    if end_s - start_s > wait_s {
                        (wait_s, waits_from_s) = (end_s - start_s, start_s);
                    }
                    break;
                }
                let SpanningTree::Missing { closed_groups } = union.spanning_tree() else { break };
                return Window::Missing { start_s, for_ever: for_all_time, closed_groups };
            }
            let last = segments[next - 1];
            if last.start_s - start_s > wait_s {
                (wait_s, waits_from_s) = (last.start_s - start_s, start_s);
            }
            // A last graph that stays for ever can be cut into windows as short as one likes; what is drawn for after the horizon is not there.
            let end = match last.end_s {
                end if end.is_infinite() => last.start_s,
                end if for_all_time => end,
                end => end.min(end_s),
            };
            if end - start_s > length_s
                && let SpanningTree::Rooted { roots } = union.spanning_tree()
            {
                (length_s, worst_start_s, worst_roots) = (end - start_s, start_s, roots);
            }
            union.remove(segments[first].graph);
        }
        if let Some(cut) = cut_at_last() {
            return cut;
        }
        if !for_all_time && wait_s > 0.0 && 2.0 * wait_s >= end_s {
            return Window::Once { wait_s, start_s: waits_from_s };
        }
        // No window is shorter than what the horizon cuts off.
        if wait_s > length_s {
            (length_s, worst_start_s) = (wait_s, waits_from_s);
        }
        Window::Uniform { length_s, worst_start_s, roots: worst_roots, for_all_time }
    }
}

//! Which graph is in force when.

use std::collections::HashMap;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::graph::{Edge, SpanningTree, spanning_tree};

/// A graph that stays in force for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its edges; at most one from any agent to any other.
    pub edges: Vec<Edge>,
    /// How long it lasts, s. Ignored for the last phase of [`Schedule::Once`].
    pub dwell_s: f64,
}

/// A switching signal.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// One graph for ever.
    Fixed(Vec<Edge>),
    /// The phases in turn, again and again.
    Periodic(Vec<Phase>),
    /// The phases in turn; the last one stays for ever.
    Once(Vec<Phase>),
    /// A seeded random draw: at every switch one of the graphs, equally likely, for a dwell time drawn uniformly.
    Random {
        /// The graphs to draw from.
        graphs: Vec<Vec<Edge>>,
        /// Shortest and longest dwell, s.
        dwell_s: [f64; 2],
        /// Seed of the draw.
        seed: u64,
    },
}

/// One stretch of time with one graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// From here on, s.
    pub start_s: f64,
    /// Until here, s; infinite when the graph stays for ever.
    pub end_s: f64,
    /// Index of the graph, see [`Schedule::graph`].
    pub graph: usize,
}

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
    /// The distinct graphs, in the order in which they were given.
    pub fn graphs(&self) -> Vec<&[Edge]> {
        match self {
            Schedule::Fixed(edges) => vec![edges],
            Schedule::Periodic(phases) | Schedule::Once(phases) => phases.iter().map(|p| &p.edges[..]).collect(),
            Schedule::Random { graphs, .. } => graphs.iter().map(|g| &g[..]).collect(),
        }
    }

    /// The edges of one graph; empty for an index that does not exist.
    pub fn graph(&self, index: usize) -> &[Edge] {
        match self {
            Schedule::Fixed(edges) => edges,
            Schedule::Periodic(phases) | Schedule::Once(phases) => phases.get(index).map_or(&[], |p| &p.edges),
            Schedule::Random { graphs, .. } => graphs.get(index).map_or(&[], |g| g),
        }
    }

    /// The stretches of time in order, from t = 0; endless unless the last graph stays for ever.
    pub fn segments(&self) -> Segments<'_> {
        let draw = match self {
            Schedule::Random { seed, .. } => Some(ChaCha8Rng::seed_from_u64(*seed)),
            _ => None,
        };
        Segments { schedule: self, draw, count: 0, start_s: 0.0 }
    }

    /// How long one repetition lasts, s; `None` when the schedule does not repeat.
    pub fn period_s(&self) -> Option<f64> {
        match self {
            Schedule::Periodic(phases) => Some(phases.iter().map(|p| p.dwell_s).sum()),
            _ => None,
        }
    }

    /// Looks for the smallest uniform window. `agents` is the number of vertices; schedules without a period are judged
    /// on [0, `end_s`].
    ///
    /// A run of phases that the horizon cuts off is not held against a random schedule: it is only asked of switching
    /// instants from which a union was complete before the end, and at least of t = 0.
    pub fn window(&self, agents: usize, end_s: f64) -> Window {
        // One period from every phase, twice over, is all a periodic schedule can show; a finite one ends by itself.
        let (segments, starts, for_all_time): (Vec<Segment>, usize, bool) = match self {
            Schedule::Fixed(_) => (self.segments().collect(), 1, true),
            Schedule::Periodic(phases) => (self.segments().take(2 * phases.len()).collect(), phases.len(), true),
            Schedule::Once(phases) => (self.segments().collect(), phases.len(), true),
            Schedule::Random { .. } => {
                let segments: Vec<Segment> = self.segments().take_while(|s| s.start_s < end_s).collect();
                let count = segments.len();
                (segments, count, false)
            }
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
        let graphs = schedule.graphs().len();
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

/// Iterator over the stretches of a schedule.
#[derive(Clone, Debug)]
pub struct Segments<'a> {
    schedule: &'a Schedule,
    draw: Option<ChaCha8Rng>,
    count: u64,
    start_s: f64,
}

impl Iterator for Segments<'_> {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        let start_s = self.start_s;
        let (end_s, graph) = match (self.schedule, &mut self.draw) {
            (Schedule::Fixed(_), _) => {
                if self.count > 0 {
                    return None;
                }
                (f64::INFINITY, 0)
            }
            (Schedule::Periodic(phases), _) => {
                // Summed within the period and multiplied across periods, so that rounding does not pile up.
                let (period, index) = (self.count / phases.len() as u64, (self.count % phases.len() as u64) as usize);
                let period_s: f64 = phases.iter().map(|p| p.dwell_s).sum();
                let within: f64 = phases[..=index].iter().map(|p| p.dwell_s).sum();
                (period as f64 * period_s + within, index)
            }
            (Schedule::Once(phases), _) => {
                let index = self.count as usize;
                let phase = phases.get(index)?;
                (if index + 1 == phases.len() { f64::INFINITY } else { start_s + phase.dwell_s }, index)
            }
            (Schedule::Random { graphs, dwell_s: [low, high], .. }, Some(draw)) => {
                let graph = draw.random_range(0..graphs.len());
                let share: f64 = draw.random();
                (start_s + low + share * (high - low), graph)
            }
            (Schedule::Random { .. }, None) => return None,
        };
        self.count += 1;
        self.start_s = end_s;
        Some(Segment { start_s, end_s, graph })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phase(dwell_s: f64, pairs: &[(usize, usize)]) -> Phase {
        Phase {
            dwell_s,
            edges: pairs.iter().map(|&(from, to)| Edge { from, to, weight: 1.0.into(), delay: 0 }).collect(),
        }
    }

    #[test]
    fn periodic_window_is_made_of_whole_phases() {
        let schedule = Schedule::Periodic(vec![phase(1.0, &[(0, 1)]), phase(2.0, &[(1, 2)]), phase(0.5, &[])]);
        let Window::Uniform { length_s, roots, worst_start_s, for_all_time } = schedule.window(3, 10.0) else {
            panic!()
        };
        // From the second phase: 2 + 0.5 + 1.
        assert_eq!((length_s, worst_start_s, for_all_time), (3.5, 1.0, true));
        assert_eq!(roots, vec![0]);
    }

    #[test]
    fn once_needs_a_tree_in_its_last_graph() {
        let schedule = Schedule::Once(vec![phase(1.0, &[(0, 1), (1, 2)]), phase(1.0, &[(0, 1)])]);
        assert_eq!(schedule.window(3, 10.0), Window::Missing { start_s: 1.0, closed_groups: vec![vec![0], vec![2]] });
        let turned = Schedule::Once(vec![phase(1.0, &[(0, 1)]), phase(1.0, &[(0, 1), (1, 2)])]);
        assert!(matches!(turned.window(3, 10.0), Window::Uniform { length_s: 1.0, for_all_time: true, .. }));
    }

    /// The length of the longest run that was needed, found the long way round.
    fn longest_run_s(schedule: &Schedule, agents: usize, end_s: f64) -> f64 {
        let segments: Vec<Segment> = schedule.segments().take_while(|s| s.start_s < end_s).collect();
        let run_s = |first: usize| {
            (first..segments.len()).find_map(|last| {
                let union: Vec<Edge> =
                    segments[first..=last].iter().flat_map(|s| schedule.graph(s.graph)).copied().collect();
                let rooted = matches!(spanning_tree(agents, &union), SpanningTree::Rooted { .. });
                rooted.then(|| segments[last].end_s - segments[first].start_s)
            })
        };
        (0..segments.len()).map_while(run_s).fold(0.0, f64::max)
    }

    #[test]
    fn windows_are_those_found_the_long_way_round() {
        let graphs: Vec<Vec<Edge>> =
            [&[(0, 1)][..], &[(1, 2), (2, 1)], &[(2, 3)], &[], &[(3, 0)]].map(|pairs| phase(0.0, pairs).edges).into();
        for seed in 0..20 {
            let schedule = Schedule::Random { graphs: graphs.clone(), dwell_s: [0.5, 1.5], seed };
            let Window::Uniform { length_s, .. } = schedule.window(4, 100.0) else { panic!("{seed}") };
            assert_eq!(length_s, longest_run_s(&schedule, 4, 100.0), "{seed}");
        }
    }

    #[test]
    fn regress_a_million_switches_are_judged_at_once() {
        let graphs: Vec<Vec<Edge>> = vec![phase(0.0, &[(0, 1)]).edges, phase(0.0, &[]).edges];
        let schedule = Schedule::Random { graphs, dwell_s: [1.0, 1.0], seed: 3 };
        let began = std::time::Instant::now();
        assert_eq!(schedule.window(3, 1e6), Window::Missing { start_s: 0.0, closed_groups: vec![vec![0], vec![2]] });
        assert!(matches!(schedule.window(2, 1e6), Window::Uniform { for_all_time: false, .. }));
        let took_s = began.elapsed().as_secs_f64();
        assert!(took_s < 10.0, "{took_s} s");
    }

    #[test]
    fn periodic_times_do_not_drift() {
        let schedule = Schedule::Periodic(vec![phase(0.1, &[]), phase(0.2, &[])]);
        let late = schedule.segments().nth(200_000).unwrap();
        assert!((late.start_s - 30_000.0).abs() < 1e-9);
    }

    #[test]
    fn random_draws_are_reproducible_and_only_judged_on_the_horizon() {
        let graphs: Vec<Vec<Edge>> = vec![phase(0.0, &[(0, 1)]).edges, phase(0.0, &[(1, 2)]).edges];
        let schedule = Schedule::Random { graphs, dwell_s: [0.5, 1.5], seed: 3 };
        let first: Vec<Segment> = schedule.segments().take(50).collect();
        assert_eq!(first, schedule.segments().take(50).collect::<Vec<_>>());
        assert!(first.iter().all(|s| (0.5..=1.5).contains(&(s.end_s - s.start_s))));
        assert!(matches!(schedule.window(3, 50.0), Window::Uniform { for_all_time: false, .. }));
    }
}

//! The union of the graphs of a run of phases, as phases join and leave it.

use std::collections::HashMap;

use super::Schedule;
use crate::graph::{SpanningTree, spanning_tree_of};

/// Unions that are remembered.
const MOST_UNIONS: usize = 4096;
/// Graphs of which a union is remembered by its members, as bits.
const MOST_BITS: usize = 64;

/// The union of the graphs of a run of phases.
///
/// An edge counts once however many phases have it. The graphs may be as many as the phases: then a union has few of their
/// edges, and what is looked at is that.
pub(super) struct Union {
    agents: usize,
    /// For each graph its edges, by their numbers in `pairs`.
    graphs: Vec<Vec<u32>>,
    /// All edges (from, to) of all graphs, each once.
    pairs: Vec<(usize, usize)>,
    /// How many phases of the run have each graph, and how many of its graphs have each edge.
    phases: Vec<u32>,
    holders: Vec<u32>,
    /// The edges that the union has, in any order, and where each stands among them.
    present: Vec<u32>,
    place: Vec<u32>,
    /// How many agents each agent hears, and how many hear no other: two of those, and there is no tree.
    hears: Vec<u32>,
    deaf: usize,
    /// Whether there is a spanning tree, if that was looked for since the union changed.
    current: Option<bool>,
    /// That of unions seen before, by the graphs they are of, where these are few: a schedule of a million switches shows a few
    /// unions again and again.
    members: u64,
    known: HashMap<u64, bool>,
    search: Search,
}

/// Where messages go, and a search along them; kept, since it is made for every phase.
#[derive(Default)]
struct Search {
    /// For each agent where those who hear it begin in `hearers`.
    first: Vec<usize>,
    hearers: Vec<usize>,
    reached: Vec<bool>,
    stack: Vec<usize>,
}

impl Search {
    fn load(&mut self, agents: usize, pairs: impl Iterator<Item = (usize, usize)> + Clone) {
        self.first.clear();
        self.first.resize(agents + 2, 0);
        let mut count = 0;
        for (from, _) in pairs.clone() {
            self.first[from + 2] += 1;
            count += 1;
        }
        for agent in 2..agents + 2 {
            self.first[agent] += self.first[agent - 1];
        }
        self.hearers.resize(count, 0);
        for (from, to) in pairs {
            self.hearers[self.first[from + 1]] = to;
            self.first[from + 1] += 1;
        }
    }

    fn forget(&mut self, agents: usize) {
        self.reached.clear();
        self.reached.resize(agents, false);
    }

    /// Adds what `root` reaches; how many that are.
    fn reach(&mut self, root: usize) -> usize {
        let mut count = 0;
        self.stack.push(root);
        while let Some(agent) = self.stack.pop() {
            if !std::mem::replace(&mut self.reached[agent], true) {
                count += 1;
                self.stack.extend_from_slice(&self.hearers[self.first[agent]..self.first[agent + 1]]);
            }
        }
        count
    }

    /// Whether somebody reaches all. Of searches that each start where none before has been, the last starts at a root if there is
    /// one: a root reaches every later start, and is not reached by what comes before it unless that is a root too.
    fn has_root(&mut self, agents: usize) -> bool {
        self.forget(agents);
        let mut last = 0;
        for agent in 0..agents {
            if !self.reached[agent] {
                self.reach(agent);
                last = agent;
            }
        }
        self.forget(agents);
        self.reach(last) == agents
    }
}

impl Union {
    /// Of no phase.
    pub(super) fn new(schedule: &Schedule, agents: usize) -> Self {
        let mut numbers = HashMap::new();
        let mut pairs = Vec::new();
        let mut number = |pair| {
            *numbers.entry(pair).or_insert_with(|| {
                pairs.push(pair);
                pairs.len() as u32 - 1
            })
        };
        let mut graphs = Vec::with_capacity(schedule.graphs.len());
        for graph in &schedule.graphs {
            graphs.push(graph.iter().map(|edge| number((edge.from, edge.to))).collect());
        }
        Union {
            agents,
            phases: vec![0; graphs.len()],
            holders: vec![0; pairs.len()],
            place: vec![0; pairs.len()],
            graphs,
            pairs,
            present: Vec::new(),
            hears: vec![0; agents],
            deaf: agents,
            current: None,
            members: 0,
            known: HashMap::new(),
            search: Search::default(),
        }
    }

    /// A phase with this graph joins.
    pub(super) fn add(&mut self, graph: usize) {
        self.phases[graph] += 1;
        if self.phases[graph] > 1 {
            return;
        }
        self.members ^= bit(graph);
        for &pair in &self.graphs[graph] {
            let at = pair as usize;
            self.holders[at] += 1;
            if self.holders[at] == 1 {
                self.place[at] = self.present.len() as u32;
                self.present.push(pair);
                let hears = &mut self.hears[self.pairs[at].1];
                self.deaf -= usize::from(*hears == 0);
                *hears += 1;
                self.current = None;
            }
        }
    }

    /// A phase with this graph, which has joined, leaves.
    pub(super) fn remove(&mut self, graph: usize) {
        self.phases[graph] -= 1;
        if self.phases[graph] > 0 {
            return;
        }
        self.members ^= bit(graph);
        for &pair in &self.graphs[graph] {
            let at = pair as usize;
            self.holders[at] -= 1;
            if self.holders[at] == 0 {
                let place = self.place[at];
                self.present.swap_remove(place as usize);
                if let Some(moved) = self.present.get(place as usize) {
                    self.place[*moved as usize] = place;
                }
                let hears = &mut self.hears[self.pairs[at].1];
                *hears -= 1;
                self.deaf += usize::from(*hears == 0);
                self.current = None;
            }
        }
    }

    /// Whether it has a spanning tree, and what shows it.
    pub(super) fn spanning_tree(&self) -> SpanningTree {
        let pairs: Vec<(usize, usize)> = self.present.iter().map(|pair| self.pairs[*pair as usize]).collect();
        spanning_tree_of(self.agents, &pairs)
    }

    /// Whether it has a spanning tree.
    pub(super) fn is_rooted(&mut self) -> bool {
        if self.deaf > 1 {
            return false;
        }
        let rooted = self.current.unwrap_or_else(|| self.look());
        self.current = Some(rooted);
        rooted
    }

    fn look(&mut self) -> bool {
        let few = self.graphs.len() <= MOST_BITS;
        if few && let Some(rooted) = self.known.get(&self.members) {
            return *rooted;
        }
        self.search.load(self.agents, self.present.iter().map(|pair| self.pairs[*pair as usize]));
        let rooted = self.search.has_root(self.agents);
        if few {
            if self.known.len() >= MOST_UNIONS {
                self.known.clear();
            }
            self.known.insert(self.members, rooted);
        }
        rooted
    }
}

/// The bit of a graph; of many graphs several share one.
fn bit(graph: usize) -> u64 {
    1 << (graph % MOST_BITS)
}

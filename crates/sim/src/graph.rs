//! Weighted digraphs in which an edge says who hears whom.

use std::collections::BTreeSet;

use petgraph::algo::{dominators, kosaraju_scc};
use petgraph::graph::{DiGraph, NodeIndex};

use crate::formula::BoundedFormula;
use crate::quantity::{QuantityError, Sign, positive};

/// "`to` hears `from` with weight w": the entry w_ij of the adjacency matrix with i = `to`, j = `from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The sender j.
    pub from: usize,
    /// The receiver i.
    pub to: usize,
    /// w_ij > 0.
    pub weight: Weight,
    /// Index into [`crate::network::Network::delays`].
    pub delay: usize,
}

/// The weight of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    /// Always the same.
    Constant(f64),
    /// A formula in t: index into [`crate::network::Network::weights`].
    Formula(usize),
}

impl Weight {
    /// The weight, if it never changes.
    pub fn constant(self) -> Option<f64> {
        match self {
            Weight::Constant(weight) => Some(weight),
            Weight::Formula(_) => None,
        }
    }

    /// Checks that it is positive; `weights` are those that follow a formula.
    ///
    /// # Errors
    /// [`QuantityError`] if it is not, or could not be shown to be.
    pub fn check(self, weights: &[BoundedFormula]) -> Result<(), QuantityError> {
        match self {
            Weight::Constant(weight) => positive("", "weight", weight),
            Weight::Formula(index) => {
                weights.get(index).map_or(Ok(()), |weight| weight.stays("weight", Sign::Positive))
            }
        }
    }
}

impl From<f64> for Weight {
    fn from(weight: f64) -> Self {
        Weight::Constant(weight)
    }
}

/// The answer to "does this graph contain a directed spanning tree?", with a certificate or a witness.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SpanningTree {
    /// What any of these agents says reaches everybody.
    Rooted {
        /// All the agents that can be the root: one strongly connected component.
        roots: Vec<usize>,
    },
    /// At least two groups hear no agent outside themselves, so nothing one says reaches the other.
    Missing {
        /// The closed groups, each sorted, in order of their first agent.
        closed_groups: Vec<Vec<usize>>,
    },
}

/// Whether some agent's messages reach all others along `edges`, on `agents` vertices.
///
/// In the paper's words a root k* is a vertex that every other has a directed path to, along edges (i, j) "i hears j".
pub fn spanning_tree<'a>(agents: usize, edges: impl IntoIterator<Item = &'a Edge>) -> SpanningTree {
    let edges: Vec<(usize, usize)> = edges.into_iter().map(|edge| (edge.from, edge.to)).collect();
    spanning_tree_of(agents, &edges)
}

/// The same along pairs (from, to).
pub(crate) fn spanning_tree_of(agents: usize, edges: &[(usize, usize)]) -> SpanningTree {
    let components = strong_components(agents, edges);
    let mut home = vec![0; agents];
    for (index, component) in components.iter().enumerate() {
        for &agent in component {
            home[agent] = index;
        }
    }
    let mut closed = vec![true; components.len()];
    for &(from, to) in edges {
        if home[from] != home[to] {
            closed[home[to]] = false;
        }
    }
    let mut closed_groups: Vec<Vec<usize>> =
        components.into_iter().zip(closed).filter(|(_, closed)| *closed).map(|(component, _)| component).collect();
    closed_groups.sort();
    match closed_groups.len() {
        1 => SpanningTree::Rooted { roots: closed_groups.swap_remove(0) },
        _ => SpanningTree::Missing { closed_groups },
    }
}

/// The edges without each of which no agent reaches all others any more, as (from, to) in order; several from one agent to another are one.
/// Empty where there is no spanning tree anyway.
///
/// A root needs no edge that leads to it: no path from it has to come back to it, so without that edge it reaches all as before. Any other
/// agent v has to be reached from the roots, which count as one vertex here. It hears what v dominates through v alone, that is, what is
/// reached on no path around v; so an edge to v is needed if it is the only one from anywhere else.
pub fn needed_edges<'a>(agents: usize, edges: impl IntoIterator<Item = &'a Edge>) -> Vec<(usize, usize)> {
    let pairs: BTreeSet<(usize, usize)> = edges.into_iter().map(|edge| (edge.from, edge.to)).collect();
    let pairs: Vec<(usize, usize)> = pairs.into_iter().collect();
    let SpanningTree::Rooted { roots } = spanning_tree_of(agents, &pairs) else { return Vec::new() };
    let Some(&root) = roots.first() else { return Vec::new() };
    let mut place: Vec<usize> = (0..agents).collect();
    roots.iter().for_each(|&one| place[one] = root);
    let merged: Vec<(usize, usize)> = pairs.iter().map(|&(from, to)| (place[from], place[to])).collect();
    let tree = dominators::simple_fast(&digraph(agents, &merged), NodeIndex::new(root));
    let mut dominated = vec![Vec::new(); agents];
    for agent in 0..agents {
        if let Some(parent) = tree.immediate_dominator(NodeIndex::new(agent)) {
            dominated[parent.index()].push(agent);
        }
    }
    // What v dominates was numbered between when v was met and when it was left.
    let (mut met, mut left, mut count) = (vec![0; agents], vec![0; agents], 0);
    let mut waiting = vec![(root, false)];
    while let Some((agent, is_done)) = waiting.pop() {
        if is_done {
            left[agent] = count;
        } else {
            met[agent] = count;
            count += 1;
            waiting.push((agent, true));
            waiting.extend(dominated[agent].iter().map(|&other| (other, false)));
        }
    }
    let dominates = |v: usize, other: usize| (met[v]..left[v]).contains(&met[other]);
    let enters = |&(from, to): &(usize, usize)| place[to] != root && !dominates(to, place[from]);
    let entering: Vec<(usize, usize)> = pairs.into_iter().filter(enters).collect();
    let mut entries = vec![0; agents];
    entering.iter().for_each(|&(_, to)| entries[to] += 1);
    entering.into_iter().filter(|&(_, to)| entries[to] == 1).collect()
}

fn digraph(agents: usize, edges: &[(usize, usize)]) -> DiGraph<(), (), usize> {
    let mut graph = DiGraph::with_capacity(agents, edges.len());
    for _ in 0..agents {
        graph.add_node(());
    }
    for &(from, to) in edges {
        graph.add_edge(NodeIndex::new(from), NodeIndex::new(to), ());
    }
    graph
}

/// The strongly connected components, each sorted, in order of their first agent. Without recursion: a path may be as long as
/// there are agents.
pub fn strong_components(agents: usize, edges: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut components: Vec<Vec<usize>> = kosaraju_scc(&digraph(agents, edges))
        .into_iter()
        .map(|component| {
            let mut agents: Vec<usize> = component.into_iter().map(|vertex| vertex.index()).collect();
            agents.sort_unstable();
            agents
        })
        .collect();
    components.sort();
    components
}

/// The Laplacian L_w, row by row: Σ_k w_ik on the diagonal, −w_ij elsewhere; `None` when a weight changes with time.
pub fn laplacian(agents: usize, edges: &[Edge]) -> Option<Vec<f64>> {
    let mut l = vec![0.0; agents * agents];
    for edge in edges {
        let weight = edge.weight.constant()?;
        l[edge.to * agents + edge.to] += weight;
        l[edge.to * agents + edge.from] -= weight;
    }
    Some(l)
}

/// 𝒩_i: those that agent `i` hears, in the order of the edges.
pub fn neighbours(edges: &[Edge], i: usize) -> impl Iterator<Item = usize> + '_ {
    edges.iter().filter(move |edge| edge.to == i).map(|edge| edge.from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(pairs: &[(usize, usize)]) -> Vec<Edge> {
        pairs.iter().map(|&(from, to)| Edge { from, to, weight: 2.0.into(), delay: 0 }).collect()
    }

    #[test]
    fn spanning_tree_names_all_roots() {
        let graph = edges(&[(0, 1), (1, 0), (1, 2), (2, 3)]);
        assert_eq!(spanning_tree(4, &graph), SpanningTree::Rooted { roots: vec![0, 1] });
        assert_eq!(spanning_tree(1, &[]), SpanningTree::Rooted { roots: vec![0] });
    }

    #[test]
    fn missing_tree_names_the_closed_groups() {
        let graph = edges(&[(0, 1), (3, 2), (2, 3), (3, 1)]);
        assert_eq!(spanning_tree(4, &graph), SpanningTree::Missing { closed_groups: vec![vec![0], vec![2, 3]] });
    }

    #[test]
    fn regress_a_path_of_a_million_needs_no_stack() {
        let n = 1_000_000;
        let path: Vec<(usize, usize)> = (1..n).map(|k| (k - 1, k)).collect();
        assert_eq!(strong_components(n, &path).len(), n);
        let ring: Vec<(usize, usize)> = (0..n).map(|k| (k, (k + 1) % n)).collect();
        assert_eq!(strong_components(n, &ring), [(0..n).collect::<Vec<_>>()]);
    }

    #[test]
    fn prop_needed_edges_are_those_without_which_no_tree_is_left() {
        let mut state = 1_u64;
        let mut draw = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        let mut sizes = [0; 4];
        for _ in 0..3000 {
            let agents = 1 + draw(7) as usize;
            let vertex = |draw: u64| draw as usize % agents;
            let drawn: Vec<(usize, usize)> =
                (0..draw(16)).map(|_| (vertex(draw(7)), vertex(draw(7)))).filter(|(from, to)| from != to).collect();
            let all = edges(&drawn);
            let is_rooted =
                |edges: &[(usize, usize)]| matches!(spanning_tree_of(agents, edges), SpanningTree::Rooted { .. });
            let is_needed = |link: &(usize, usize)| {
                !is_rooted(&drawn.iter().copied().filter(|other| other != link).collect::<Vec<_>>())
            };
            let mut expected: Vec<(usize, usize)> = drawn.iter().copied().filter(is_needed).collect();
            expected.sort_unstable();
            expected.dedup();
            if !is_rooted(&drawn) {
                expected.clear();
            }
            assert_eq!(needed_edges(agents, &all), expected, "{agents} {drawn:?}");
            sizes[expected.len().min(3)] += 1;
        }
        assert!(sizes.iter().all(|count| *count > 100), "{sizes:?}");
    }

    #[test]
    fn of_a_hundred_thousand_agents_the_needed_edges_are_found() {
        let n = 100_000;
        let path: Vec<(usize, usize)> = (1..n).map(|k| (k - 1, k)).collect();
        assert_eq!(needed_edges(n, &edges(&path)), path);
        let both_ways: Vec<(usize, usize)> = (2..n).flat_map(|k| [(k - 1, k), (k, k - 1)]).chain([(0, 1)]).collect();
        assert_eq!(needed_edges(n, &edges(&both_ways)), path, "behind a leader");
        let ring: Vec<(usize, usize)> = (0..n).map(|k| (k, (k + 1) % n)).collect();
        assert_eq!(needed_edges(n, &edges(&ring)), []);
    }

    #[test]
    fn laplacian_rows_sum_to_zero() {
        let graph = edges(&[(0, 1), (2, 1), (1, 2)]);
        let l = laplacian(3, &graph).unwrap();
        assert_eq!(l, vec![0.0, 0.0, 0.0, -2.0, 4.0, -2.0, 0.0, -2.0, 2.0]);
        assert_eq!(neighbours(&graph, 1).collect::<Vec<_>>(), vec![0, 2]);
    }
}

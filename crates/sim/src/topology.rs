//! Graphs by rule: rings, paths, stars, complete graphs and random ones, as pairs (from, to) of vertices 0 … n − 1.

use std::collections::BTreeSet;

use rand::{RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thiserror::Error;

/// A rule that says who hears whom among any number of agents.
///
/// ```
/// use forwardstep_sim::topology::{Along, Topology};
///
/// assert_eq!(Topology::Ring(Along::Forward).edges(3)?, [(0, 1), (1, 2), (2, 0)]);
/// # Ok::<(), forwardstep_sim::topology::TopologyError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    /// Everybody is heard by the next, and the last by the first.
    Ring(Along),
    /// Everybody is heard by the next.
    Path(Along),
    /// One agent in the middle of all others.
    Star {
        /// The agent in the middle.
        centre: usize,
        /// Who hears whom.
        spokes: Spokes,
    },
    /// Everybody hears everybody else.
    Complete,
    /// Everybody hears as many others, drawn at random; all sets of that many others are equally likely.
    Random {
        /// How many.
        in_degree: usize,
        /// Seed of the draw.
        seed: u64,
    },
}

/// The direction of the edges along a ring or a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Each is heard by the next.
    Forward,
    /// Neighbours hear each other.
    Both,
}

/// The direction of the edges of a star.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spokes {
    /// All others hear the centre.
    Out,
    /// The centre hears all others.
    In,
    /// Both.
    Both,
}

/// Why a rule has no meaning for so many agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TopologyError {
    /// The centre of a star does not exist.
    #[error("the centre of the star is agent {centre}, but there are {agents} agents, counted from 0")]
    Centre {
        /// The centre.
        centre: usize,
        /// How many agents there are.
        agents: usize,
    },
    /// Somebody would have to hear an agent twice, or itself.
    #[error("every agent is to hear {in_degree} others, but there are only {others}")]
    InDegree {
        /// How many are to be heard.
        in_degree: usize,
        /// How many others there are.
        others: usize,
    },
}

impl Topology {
    /// How many edges there are among so many agents, without listing them.
    ///
    /// # Errors
    /// [`TopologyError`] when the rule has no meaning for so many agents.
    pub fn edge_count(&self, agents: usize) -> Result<u64, TopologyError> {
        let others = agents.saturating_sub(1);
        let (all, rest) = (agents as u64, others as u64);
        match *self {
            // A ring of two is the same in both directions, and one agent hears no other.
            Topology::Ring(_) if agents <= 2 => Ok(2 * rest),
            Topology::Ring(Along::Forward) => Ok(all),
            Topology::Ring(Along::Both) => Ok(2 * all),
            Topology::Path(Along::Forward) => Ok(rest),
            Topology::Path(Along::Both) => Ok(2 * rest),
            Topology::Star { centre, .. } if centre >= agents => Err(TopologyError::Centre { centre, agents }),
            Topology::Star { spokes: Spokes::Out | Spokes::In, .. } => Ok(rest),
            Topology::Star { spokes: Spokes::Both, .. } => Ok(2 * rest),
            Topology::Complete => Ok(all.saturating_mul(rest)),
            Topology::Random { in_degree, .. } if in_degree > others => {
                Err(TopologyError::InDegree { in_degree, others })
            }
            Topology::Random { in_degree, .. } => Ok(all.saturating_mul(in_degree as u64)),
        }
    }

    /// The edges among so many agents, as (from, to): no self-loop, and none twice.
    ///
    /// # Errors
    /// [`TopologyError`] when the rule has no meaning for so many agents.
    pub fn edges(&self, agents: usize) -> Result<Vec<(usize, usize)>, TopologyError> {
        let mut edges = Vec::with_capacity(usize::try_from(self.edge_count(agents)?).unwrap_or(0));
        match *self {
            Topology::Ring(along) => {
                chain(&mut edges, agents, along);
                // Of two agents a path in both directions is the ring already.
                if agents > 2 || (agents == 2 && along == Along::Forward) {
                    link(&mut edges, (agents - 1, 0), along);
                }
            }
            Topology::Path(along) => chain(&mut edges, agents, along),
            Topology::Star { centre, spokes } => {
                for other in (0..agents).filter(|other| *other != centre) {
                    if spokes != Spokes::In {
                        edges.push((centre, other));
                    }
                    if spokes != Spokes::Out {
                        edges.push((other, centre));
                    }
                }
            }
            Topology::Complete => {
                for to in 0..agents {
                    edges.extend((0..agents).filter(|from| *from != to).map(|from| (from, to)));
                }
            }
            Topology::Random { in_degree, seed } => {
                for to in 0..agents {
                    // One stream of numbers per receiver.
                    let mut generator = ChaCha8Rng::seed_from_u64(seed);
                    generator.set_stream(to as u64);
                    let heard = draw(&mut generator, in_degree, agents - 1);
                    edges.extend(heard.into_iter().map(|other| (other + usize::from(other >= to), to)));
                }
            }
        }
        Ok(edges)
    }
}

fn link(edges: &mut Vec<(usize, usize)>, (from, to): (usize, usize), along: Along) {
    edges.push((from, to));
    if along == Along::Both {
        edges.push((to, from));
    }
}

fn chain(edges: &mut Vec<(usize, usize)>, agents: usize, along: Along) {
    for next in 1..agents {
        link(edges, (next - 1, next), along);
    }
}

/// A set of `count` of the numbers below `below`, each such set equally likely (Floyd's algorithm).
fn draw(generator: &mut ChaCha8Rng, count: usize, below: usize) -> BTreeSet<usize> {
    let mut drawn = BTreeSet::new();
    for last in below.saturating_sub(count)..below {
        // Uniform up to 2⁻⁶⁴, and always one draw of 64 bits, which no version of a library can change.
        let choices = last as u128 + 1;
        let number = ((u128::from(generator.next_u64()) * choices) >> 64) as usize;
        if !drawn.insert(number) {
            drawn.insert(last);
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Edge, SpanningTree, spanning_tree};

    fn every_kind(agents: usize) -> Vec<Topology> {
        let mut kinds = vec![Topology::Complete];
        for along in [Along::Forward, Along::Both] {
            kinds.extend([Topology::Ring(along), Topology::Path(along)]);
        }
        for spokes in [Spokes::Out, Spokes::In, Spokes::Both] {
            kinds.push(Topology::Star { centre: agents / 2, spokes });
        }
        kinds.extend((0..agents).map(|in_degree| Topology::Random { in_degree, seed: 5 }));
        kinds
    }

    fn roots(topology: Topology, agents: usize) -> Option<Vec<usize>> {
        let edges = topology.edges(agents).unwrap();
        let edges: Vec<Edge> =
            edges.into_iter().map(|(from, to)| Edge { from, to, weight: 1.0.into(), delay: 0 }).collect();
        match spanning_tree(agents, &edges) {
            SpanningTree::Rooted { roots } => Some(roots),
            SpanningTree::Missing { .. } => None,
        }
    }

    #[test]
    fn rules_give_the_edges_one_would_write() {
        let edges = |topology: Topology, agents| topology.edges(agents).unwrap();
        assert_eq!(edges(Topology::Ring(Along::Forward), 4), [(0, 1), (1, 2), (2, 3), (3, 0)]);
        assert_eq!(edges(Topology::Ring(Along::Both), 3), [(0, 1), (1, 0), (1, 2), (2, 1), (2, 0), (0, 2)]);
        assert_eq!(edges(Topology::Ring(Along::Forward), 2), [(0, 1), (1, 0)]);
        assert_eq!(edges(Topology::Ring(Along::Both), 2), [(0, 1), (1, 0)]);
        assert_eq!(edges(Topology::Path(Along::Forward), 3), [(0, 1), (1, 2)]);
        assert_eq!(edges(Topology::Path(Along::Both), 3), [(0, 1), (1, 0), (1, 2), (2, 1)]);
        let star = |spokes| edges(Topology::Star { centre: 1, spokes }, 3);
        assert_eq!(star(Spokes::Out), [(1, 0), (1, 2)]);
        assert_eq!(star(Spokes::In), [(0, 1), (2, 1)]);
        assert_eq!(star(Spokes::Both), [(1, 0), (0, 1), (1, 2), (2, 1)]);
        assert_eq!(edges(Topology::Complete, 3), [(1, 0), (2, 0), (0, 1), (2, 1), (0, 2), (1, 2)]);
    }

    #[test]
    fn prop_no_rule_gives_self_loops_or_edges_twice_and_all_are_counted() {
        for agents in 1..=9 {
            for topology in every_kind(agents) {
                let edges = topology.edges(agents).unwrap();
                let distinct: BTreeSet<_> = edges.iter().collect();
                assert_eq!(distinct.len(), edges.len(), "{topology:?} of {agents}");
                assert!(edges.iter().all(|&(from, to)| from != to && from < agents && to < agents));
                assert_eq!(topology.edge_count(agents).unwrap(), edges.len() as u64, "{topology:?} of {agents}");
            }
        }
    }

    #[test]
    fn prop_rules_have_the_roots_one_expects() {
        for agents in 3..=9 {
            let all = Some((0..agents).collect::<Vec<_>>());
            let centre = agents / 2;
            assert_eq!(roots(Topology::Ring(Along::Forward), agents), all);
            assert_eq!(roots(Topology::Ring(Along::Both), agents), all);
            assert_eq!(roots(Topology::Path(Along::Forward), agents), Some(vec![0]));
            assert_eq!(roots(Topology::Path(Along::Both), agents), all);
            assert_eq!(roots(Topology::Star { centre, spokes: Spokes::Out }, agents), Some(vec![centre]));
            assert_eq!(roots(Topology::Star { centre, spokes: Spokes::In }, agents), None);
            assert_eq!(roots(Topology::Star { centre, spokes: Spokes::Both }, agents), all);
            assert_eq!(roots(Topology::Complete, agents), all);
            let in_degree = agents - 1;
            let everybody = Topology::Random { in_degree, seed: 1 }.edges(agents);
            assert_eq!(everybody, Topology::Complete.edges(agents), "only one set has all others");
        }
    }

    #[test]
    fn random_graphs_repeat_and_are_fair() {
        let random = |seed| Topology::Random { in_degree: 2, seed }.edges(6).unwrap();
        assert_eq!(random(1), random(1));
        assert_ne!(random(1), random(2));
        let mut count = [[0_u32; 6]; 6];
        for seed in 0..2000 {
            for (from, to) in random(seed) {
                count[to][from] += 1;
            }
        }
        for (to, row) in count.iter().enumerate() {
            assert_eq!(row.iter().sum::<u32>(), 4000, "two in every graph");
            // Each of five others two times out of five: 800 ± 22.
            assert!(row.iter().enumerate().all(|(from, n)| if from == to { *n == 0 } else { n.abs_diff(800) < 110 }));
        }
        // Written down, so that seeds mean tomorrow what they mean today.
        let today = [(1, 0), (4, 1), (1, 2), (0, 3), (3, 4)];
        assert_eq!(Topology::Random { in_degree: 1, seed: 7 }.edges(5).unwrap(), today);
    }

    #[test]
    fn rules_without_meaning_are_refused() {
        let star = Topology::Star { centre: 3, spokes: Spokes::Out };
        assert_eq!(star.edges(3), Err(TopologyError::Centre { centre: 3, agents: 3 }));
        let random = Topology::Random { in_degree: 3, seed: 0 };
        assert_eq!(random.edges(3), Err(TopologyError::InDegree { in_degree: 3, others: 2 }));
        assert_eq!(Topology::Random { in_degree: 0, seed: 0 }.edges(0), Ok(vec![]));
    }
}

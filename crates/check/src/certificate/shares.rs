//! What each agent's start counts in the value agreed upon, in exact numbers.

use forwardstep_core::expression::Number;
use forwardstep_sim::Setup;
use forwardstep_sim::graph::{SpanningTree, spanning_tree};
use num_rational::BigRational;
use num_traits::{One, Zero};

use crate::instance::is_consensus;

/// Agents among which shares are eliminated in rational numbers.
const MOST_ROOTS: usize = 40;

/// u ≥ 0 with uᵀL = 0 and Σu = 1 for agents that agree over a network that never changes.
///
/// On the one closed class by elimination without subtraction (Grassmann, Taksar and Heyman), zero elsewhere.
pub(super) fn influence(setup: &Setup) -> Option<Vec<BigRational>> {
    if !is_consensus(setup) {
        return None;
    }
    let (edges, vertices) = (setup.network.schedule.constant_graph()?, setup.network.agents);
    let SpanningTree::Rooted { roots } = spanning_tree(vertices, edges) else { return None };
    let n = roots.len();
    if n > MOST_ROOTS {
        return None;
    }
    let place = |vertex: usize| roots.iter().position(|root| *root == vertex);
    let mut rates = vec![vec![BigRational::zero(); n]; n];
    for edge in edges {
        let weight = edge.weight.constant()?;
        // Who is a root hears roots only.
        if let (Some(from), Some(to)) = (place(edge.from), place(edge.to)) {
            rates[to][from] += Number::written(weight);
        }
    }
    for k in (1..n).rev() {
        let out: BigRational = rates[k][..k].iter().sum();
        let last = rates[k].clone();
        for row in &mut rates[..k] {
            row[k] /= &out;
            let share = row[k].clone();
            for (entry, rate) in row[..k].iter_mut().zip(&last) {
                *entry += &share * rate;
            }
        }
    }
    let mut shares = vec![BigRational::one()];
    for k in 1..n {
        let share = shares.iter().enumerate().map(|(i, share)| share * &rates[i][k]).sum();
        shares.push(share);
    }
    let total: BigRational = shares.iter().sum();
    let mut influence = vec![BigRational::zero(); vertices];
    for (root, share) in roots.iter().zip(shares) {
        influence[*root] = share / &total;
    }
    Some(influence)
}

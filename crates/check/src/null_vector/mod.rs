//! How much each agent counts in what all agree on: the left null vector of the Laplacian.
//!
//! It is zero outside the closed class, the agents that reach all others, and positive on it. There it is found by
//! [elimination] without subtraction, and where fill is too much the rest is [iterated](iteration) and enclosed. Either way a bound on the relative
//! error of every entry comes with it.

mod elimination;
mod iteration;
mod positive;

use forwardstep_sim::graph::{Edge, SpanningTree, spanning_tree};

use elimination::Elimination;
use iteration::{Block, Enclosed};
use positive::Wide;

pub(crate) use positive::{Positive, sum_depth};

/// The left null vector of the Laplacian.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NullVector {
    /// Not negative, with the sum one.
    pub(crate) entries: Vec<f64>,
    /// Bound on the relative error of every entry beside the weights as decimals; infinite where none was found.
    pub(crate) error: f64,
}

/// Why there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NoNullVector {
    /// There are as many closed classes, each with one of its own.
    Classes(usize),
    /// A weight varies.
    Varies,
}

/// Finds it, for constant weights.
pub(crate) fn null_vector(agents: usize, edges: &[Edge]) -> Result<NullVector, NoNullVector> {
    let roots = match spanning_tree(agents, edges) {
        SpanningTree::Rooted { roots } => roots,
        SpanningTree::Missing { closed_groups } => return Err(NoNullVector::Classes(closed_groups.len())),
    };
    let mut local = vec![None; agents];
    for (index, root) in roots.iter().enumerate() {
        local[*root] = Some(index);
    }
    let mut within = Vec::new();
    for edge in edges {
        // Nothing leads into the class, so who hears decides.
        if let (Some(to), Some(from)) = (local[edge.to], local[edge.from]) {
            within.push((to, from, edge.weight.constant().ok_or(NoNullVector::Varies)?));
        }
    }
    let class = on_class::<f64>(roots.len(), &within)
        .or_else(|| on_class::<Wide>(roots.len(), &within))
        .unwrap_or_else(|| NullVector { entries: vec![f64::NAN; roots.len()], error: f64::INFINITY });
    let mut entries = vec![0.0; agents];
    for (root, entry) in roots.iter().zip(class.entries) {
        entries[*root] = entry;
    }
    Ok(NullVector { entries, error: class.error })
}

/// On a strongly connected graph; `None` where digits were lost to the range of the numbers.
fn on_class<T: Positive>(vertices: usize, edges: &[(usize, usize, f64)]) -> Option<NullVector> {
    let mut elimination = Elimination::<T>::new(vertices, edges);
    elimination.run();
    let left = elimination.left();
    let enclosed = rest(&elimination, &left)?;
    let u = elimination.expand(left.into_iter().zip(enclosed.u.into_iter().map(T::of)));
    let largest = u.iter().copied().fold(T::ZERO, |a, b| if b.exceeds(a) { b } else { a });
    let scaled: Vec<f64> = u.iter().map(|u| u.over(largest).value()).collect();
    let total = f64::sum(&scaled);
    let rounding = 0.5 * f64::EPSILON;
    // Rounding of the decimals, of what was scaled and summed; a ratio of enclosed entries has the error twice.
    let first_order =
        elimination.error()? + 2.0 * enclosed.error + rounding * (2.0 * vertices as f64 + sum_depth(vertices) + 4.0);
    // (1 + δ)^k − 1 ≤ 1.02 kδ while kδ is below 0.03.
    let error = if first_order < 0.03 { 1.02 * first_order } else { f64::INFINITY };
    Some(NullVector { entries: scaled.into_iter().map(|entry| entry / total).collect(), error })
}

/// u of the vertices that the elimination left; `None` where their weights are out of range.
fn rest<T: Positive>(elimination: &Elimination<T>, left: &[usize]) -> Option<Enclosed> {
    if left.len() == 1 {
        return Some(Enclosed { u: vec![1.0], error: 0.0 });
    }
    let mut index = vec![0; elimination.rows.len()];
    for (number, vertex) in left.iter().enumerate() {
        index[*vertex] = number;
    }
    let (mut edges, mut out) = (Vec::new(), Vec::with_capacity(left.len()));
    for (i, vertex) in left.iter().enumerate() {
        let row = elimination.rows[*vertex].iter().filter(|entry| !entry.weight.is_zero());
        let weights: Vec<(usize, f64)> =
            row.map(|entry| (index[entry.column as usize], entry.weight.value())).collect();
        if weights.iter().any(|(_, weight)| weight.is_lost()) {
            return None;
        }
        let sum = f64::sum(&weights.iter().map(|(_, weight)| *weight).collect::<Vec<_>>());
        out.push(sum);
        edges.extend(weights.into_iter().map(|(j, weight)| (i, j, weight)));
    }
    out.iter().all(|out| out.is_finite()).then(|| Block::new(out, &edges).solve())
}

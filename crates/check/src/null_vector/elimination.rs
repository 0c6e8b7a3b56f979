//! Elimination without subtraction, one vertex after the other, on a strongly connected graph.
//!
//! With u the left null vector of the Laplacian (uᵀL = 0) and S_k = Σⱼ w_kj, taking vertex k out leaves
//!
//! ```text
//! w_ij ← w_ij + w_ik w_kj / S_k  (i, j ≠ k)        u_k = Σᵢ uᵢ w_ik / S_k
//! ```
//!
//! (Grassmann, Taksar and Heyman, Operations Research 33, 1985). The others keep their u. S_k is summed anew from what is left,
//! so nothing is ever subtracted.
//!
//! **Why every entry is accurate.** By the Markov chain tree theorem uᵢ is proportional to the sum, over all spanning trees that
//! lead to i, of the products of their weights, and such a tree has at most one edge that leaves each vertex. If the
//! weights that leave r vertices are wrong by a factor within (1 ± δ)^±1, any ratio uᵢ/u_j is wrong by at most (1 ± δ)^±2r. Taking out k
//! rounds weights that leave the vertices i with w_ik > 0 only, r_k of them, each by (d_k + 3) u at most with d_k the depth of the sum S_k;
//! finding u_k rounds it by (d_k + d′_k + 2) u. Together the ratios are within
//!
//! ```text
//! E = u Σ_k [ 2 r_k (d_k + 3) + d_k + d′_k + 2 ],        u = 2⁻⁵³,
//! ```
//!
//! to first order; the caller widens it by the rest. That weights are decimals that were rounded to `f64` adds 2 n u in the same way.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::positive::{Positive, sum_depth};

/// An entry w_ij of row i.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<T> {
    pub(super) column: u32,
    pub(super) weight: T,
}

/// What is left when a vertex is taken out.
struct Eliminated<T> {
    vertex: u32,
    /// Whom its u follows from, in `sources`.
    first: usize,
    out_weight: T,
}

/// A graph from which vertices are taken out.
pub(super) struct Elimination<T> {
    /// Row i: the weights w_ij, rising in j. The pattern is symmetric, so there are zeros.
    pub(super) rows: Vec<Vec<Entry<T>>>,
    gone: Vec<bool>,
    eliminated: Vec<Eliminated<T>>,
    sources: Vec<Entry<T>>,
    /// E over u.
    roundings: f64,
    lost: bool,
}

/// Fewer vertices than this may be as dense as they like.
const FEW: usize = 1000;
/// Entries that fill may make of one.
const FILL: usize = 4;

impl<T: Positive> Elimination<T> {
    /// Of the graph in which `i` hears `j` with weight w, for every `(i, j, w)`; no pair twice.
    pub(super) fn new(vertices: usize, edges: &[(usize, usize, f64)]) -> Self {
        let mut rows: Vec<Vec<Entry<T>>> = (0..vertices).map(|_| Vec::new()).collect();
        for &(i, j, weight) in edges {
            rows[i].push(Entry { column: j as u32, weight: T::of(weight) });
            rows[j].push(Entry { column: i as u32, weight: T::ZERO });
        }
        for row in &mut rows {
            row.sort_unstable_by_key(|entry| entry.column);
            // An edge that leads both ways has given an entry twice, once with zero.
            row.dedup_by(|second, first| {
                let same = second.column == first.column;
                if same {
                    first.weight = first.weight.plus(second.weight);
                }
                same
            });
        }
        Elimination {
            rows,
            gone: vec![false; vertices],
            eliminated: Vec::new(),
            sources: Vec::new(),
            roundings: 0.0,
            lost: false,
        }
    }

    /// Takes out vertices with few neighbours first, until one is left or fill is too much.
    pub(super) fn run(&mut self) {
        let mut entries: usize = self.rows.iter().map(Vec::len).sum();
        let most = (FILL * entries).max(FEW * FEW);
        let mut queue: BinaryHeap<_> = self.rows.iter().enumerate().map(|(k, row)| Reverse((row.len(), k))).collect();
        let mut left = self.rows.len();
        let mut merged = Vec::new();
        while left > 1 && entries <= most {
            let Some(Reverse((degree, k))) = queue.pop() else { return };
            // An older note of a vertex that has changed since.
            if self.gone[k] || self.rows[k].len() != degree {
                continue;
            }
            let row = std::mem::take(&mut self.rows[k]);
            entries -= row.len();
            self.take_out(k, &row, &mut merged, |i, before, after| {
                entries = entries + after - before;
                queue.push(Reverse((after, i)));
            });
            left -= 1;
        }
    }

    fn take_out(
        &mut self,
        k: usize,
        row: &[Entry<T>],
        merged: &mut Vec<Entry<T>>,
        mut changed: impl FnMut(usize, usize, usize),
    ) {
        let weights: Vec<T> = row.iter().map(|entry| entry.weight).collect();
        let out_weight = T::sum(&weights);
        self.lost |= out_weight.is_lost();
        let shares: Vec<Entry<T>> =
            row.iter().map(|entry| Entry { column: entry.column, weight: entry.weight.over(out_weight) }).collect();
        self.lost |= shares.iter().any(|share| !share.weight.is_zero() && share.weight.is_lost());
        let first = self.sources.len();
        for entry in row {
            let i = entry.column as usize;
            let before = self.rows[i].len();
            let into = self.rows[i].binary_search_by_key(&(k as u32), |entry| entry.column);
            let into = into.map_or(T::ZERO, |at| self.rows[i][at].weight);
            if !into.is_zero() {
                self.sources.push(Entry { column: entry.column, weight: into });
            }
            self.lost |= merge(merged, &self.rows[i], &shares, [i as u32, k as u32], into);
            std::mem::swap(&mut self.rows[i], merged);
            changed(i, before, self.rows[i].len());
        }
        let sources = self.sources.len() - first;
        let depth = sum_depth(row.len());
        self.roundings += 2.0 * sources as f64 * (depth + 3.0) + depth + sum_depth(sources) + 2.0;
        self.gone[k] = true;
        self.eliminated.push(Eliminated { vertex: k as u32, first, out_weight });
    }

    /// The vertices that are left, rising.
    pub(super) fn left(&self) -> Vec<usize> {
        (0..self.gone.len()).filter(|vertex| !self.gone[*vertex]).collect()
    }

    /// u of all vertices, from those that are left, up to a common factor.
    pub(super) fn expand(&mut self, left: impl Iterator<Item = (usize, T)>) -> Vec<T> {
        let mut u = vec![T::ZERO; self.gone.len()];
        for (vertex, value) in left {
            u[vertex] = value;
        }
        let mut end = self.sources.len();
        let mut terms = Vec::new();
        for Eliminated { vertex, first, out_weight } in self.eliminated.iter().rev() {
            terms.clear();
            terms.extend(self.sources[*first..end].iter().map(|source| u[source.column as usize].times(source.weight)));
            let value = T::sum(&terms).over(*out_weight);
            self.lost |= value.is_lost() || terms.iter().any(|term| term.is_lost());
            u[*vertex as usize] = value;
            end = *first;
        }
        u
    }

    /// E, unless digits were lost to the range of the numbers.
    pub(super) fn error(&self) -> Option<f64> {
        (!self.lost).then_some(self.roundings * 0.5 * f64::EPSILON)
    }
}

/// `row` + `into` · `shares`, without columns `own`, which stands in `shares`, and `gone`, which stands in `row`; whether digits were lost.
fn merge<T: Positive>(
    merged: &mut Vec<Entry<T>>,
    row: &[Entry<T>],
    shares: &[Entry<T>],
    [own, gone]: [u32; 2],
    into: T,
) -> bool {
    merged.clear();
    let (mut row, mut lost) = (row.iter().filter(|entry| entry.column != gone).peekable(), false);
    for share in shares.iter().filter(|share| share.column != own) {
        while let Some(entry) = row.next_if(|entry| entry.column < share.column) {
            merged.push(*entry);
        }
        let mut weight = into.times(share.weight);
        lost |= weight.is_lost() && !into.is_zero() && !share.weight.is_zero();
        if let Some(entry) = row.next_if(|entry| entry.column == share.column) {
            weight = weight.plus(entry.weight);
        }
        merged.push(Entry { column: share.column, weight });
    }
    merged.extend(row);
    lost
}

//! Symmetric matrices of intervals: what can be said of the eigenvalues of every matrix in them.

use alloc::vec;
use alloc::vec::Vec;

use crate::expression::Interval;

/// A symmetric matrix whose entries are known to lie in intervals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Enclosed {
    size: usize,
    /// Row by row; the lower triangle counts.
    entries: Vec<Interval>,
}

/// Bisections at most; each halves what is not known.
const MOST_HALVINGS: usize = 80;
/// Bounds of eigenvalues are found to this part of them.
const SHARP: f64 = 1e-6;

impl Enclosed {
    pub(crate) fn zero(size: usize) -> Self {
        Enclosed { size, entries: vec![Interval::point(0.0); size * size] }
    }

    /// The matrix with these on its diagonal.
    pub(crate) fn diagonal(entries: &[Interval]) -> Self {
        let mut diagonal = Enclosed::zero(entries.len());
        for (i, entry) in entries.iter().enumerate() {
            diagonal.set(i, i, *entry);
        }
        diagonal
    }

    /// From its lower triangle and whatever stands above it.
    pub(crate) fn from_rows(size: usize, entries: Vec<Interval>) -> Option<Self> {
        (entries.len() == size * size).then_some(Enclosed { size, entries })
    }

    pub(crate) fn size(&self) -> usize {
        self.size
    }

    pub(crate) fn at(&self, row: usize, column: usize) -> Interval {
        let (row, column) = if row < column { (column, row) } else { (row, column) };
        self.entries[row * self.size + column]
    }

    pub(crate) fn set(&mut self, row: usize, column: usize, entry: Interval) {
        let (row, column) = if row < column { (column, row) } else { (row, column) };
        self.entries[row * self.size + column] = entry;
    }

    /// A = L D Lᵀ with ones on the diagonal of L: L below the diagonal, D on it. `None` unless every matrix in it is positive
    /// definite, as far as intervals tell.
    pub(crate) fn factors(mut self) -> Option<Self> {
        for k in 0..self.size {
            let pivot = self.at(k, k);
            // Not so where it is not a number.
            if !(pivot.low > 0.0 && pivot.is_finite()) {
                return None;
            }
            for i in k + 1..self.size {
                let factor = self.at(i, k) / pivot;
                for j in k + 1..=i {
                    let rest = self.at(i, j) - factor * self.at(j, k);
                    self.set(i, j, rest);
                }
            }
            for i in k + 1..self.size {
                let factor = self.at(i, k) / pivot;
                self.set(i, k, factor);
            }
        }
        Some(self)
    }

    /// Whether every matrix in it is positive definite; `false` where that is not known.
    pub(crate) fn is_positive(&self) -> bool {
        self.clone().factors().is_some()
    }

    /// `lambda` · diag(`weights`) − A.
    fn below(&self, lambda: f64, weights: &[Interval]) -> Self {
        let mut rest = Enclosed { size: self.size, entries: self.entries.iter().map(|entry| -*entry).collect() };
        for (i, weight) in weights.iter().enumerate().take(self.size) {
            let entry = Interval::point(lambda) * *weight + rest.at(i, i);
            rest.set(i, i, entry);
        }
        rest
    }

    /// Whether `lambda` · diag(`weights`) − A is positive definite; `false` where that is not known.
    pub(crate) fn keeps_below(&self, lambda: f64, weights: &[Interval]) -> bool {
        self.below(lambda, weights).is_positive()
    }

    /// A number that no λ with det(λ diag(`weights`) − A) = 0 exceeds, for A ⪰ 0; `None` where none is found.
    pub(crate) fn largest_over(&self, weights: &[Interval]) -> Option<f64> {
        let each = (0..self.size).map(|i| self.at(i, i) / *weights.get(i).unwrap_or(&Interval::WHOLE));
        let (mut low, mut trace) = (0.0_f64, Interval::point(0.0));
        for entry in each {
            low = low.max(entry.low);
            trace = trace + entry;
        }
        let mut high = trace.high * (1.0 + SHARP);
        let holds = |lambda: f64| self.keeps_below(lambda, weights);
        if !high.is_finite() || !holds(high) {
            return None;
        }
        for _ in 0..MOST_HALVINGS {
            if high - low <= SHARP * low {
                break;
            }
            let middle = 0.5 * (low + high);
            *(if holds(middle) { &mut high } else { &mut low }) = middle;
        }
        Some(high)
    }

    /// A number that no eigenvalue exceeds, for A ⪰ 0.
    pub(crate) fn largest(&self) -> Option<f64> {
        self.largest_over(&vec![Interval::point(1.0); self.size])
    }

    /// Whether every eigenvalue exceeds `lambda`; `false` where that is not known.
    pub(crate) fn exceeds(&self, lambda: f64) -> bool {
        let mut rest = self.clone();
        for i in 0..self.size {
            rest.set(i, i, self.at(i, i) - Interval::point(lambda));
        }
        rest.is_positive()
    }

    /// A positive number that every eigenvalue exceeds.
    pub(crate) fn least(&self) -> Option<f64> {
        let mut high = (0..self.size).map(|i| self.at(i, i).high).fold(f64::INFINITY, f64::min);
        let mut low = 0.0;
        if !self.exceeds(low) {
            return None;
        }
        for _ in 0..MOST_HALVINGS {
            if high - low <= SHARP * low {
                break;
            }
            let middle = 0.5 * (low + high);
            *(if self.exceeds(middle) { &mut low } else { &mut high }) = middle;
        }
        (low > 0.0).then_some(low)
    }

    /// LᵀA L for a unit lower triangular L.
    pub(crate) fn between(&self, l: &Enclosed) -> Self {
        let n = self.size;
        let factor = |row: usize, column: usize| if row == column { Interval::point(1.0) } else { l.at(row, column) };
        let mut product = Enclosed::zero(n);
        for i in 0..n {
            for j in 0..=i {
                let mut sum = Interval::point(0.0);
                for r in i..n {
                    for c in j..n {
                        sum = sum + factor(r, i) * self.at(r, c) * factor(c, j);
                    }
                }
                product.set(i, j, sum);
            }
        }
        product
    }

    /// A direction v with vᵀM v ≤ 0: a joint by itself, or one with those before it as they follow without a torque.
    pub(crate) fn against(&self) -> Option<Vec<f64>> {
        let n = self.size;
        let unit = |joint: usize| (0..n).map(|k| if k == joint { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        if let Some(joint) = (0..n).find(|joint| self.at(*joint, *joint).high <= 0.0) {
            return Some(unit(joint));
        }
        let middle = |i: usize, j: usize| 0.5 * (self.at(i, j).low + self.at(i, j).high);
        // Rows of L of L D Lᵀ, one by one; v solves Lᵀv = e_k.
        let mut l = vec![0.0; n * n];
        let mut pivots: Vec<f64> = Vec::with_capacity(n);
        for k in 0..n {
            for j in 0..k {
                let known = (0..j).map(|i| l[k * n + i] * l[j * n + i] * pivots[i]).sum::<f64>();
                l[k * n + j] = (middle(k, j) - known) / pivots[j];
            }
            let pivot = middle(k, k) - (0..k).map(|i| l[k * n + i] * l[k * n + i] * pivots[i]).sum::<f64>();
            let mut v = unit(k);
            for j in (0..k).rev() {
                v[j] = -(j + 1..=k).map(|i| l[i * n + j] * v[i]).sum::<f64>();
            }
            if self.quadratic(&v).high <= 0.0 {
                return Some(v);
            }
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            pivots.push(pivot);
        }
        None
    }

    /// vᵀM v.
    fn quadratic(&self, v: &[f64]) -> Interval {
        let mut sum = Interval::point(0.0);
        for (i, a) in v.iter().enumerate() {
            for (j, b) in v.iter().enumerate() {
                sum = sum + Interval::point(*a) * self.at(i, j) * Interval::point(*b);
            }
        }
        sum
    }
}

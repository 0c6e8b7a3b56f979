//! Candidates for characteristic roots: eigenvalues of the infinitesimal generator of the delay system, collocated.
//!
//! The state is ψ₀ … ψ_ℓ of every agent and, of every ψ₀ or ψ₁ that is heard late, its values at the Chebyshev nodes of the
//! longest delay with which it is heard. What was sent is transported by differentiating the polynomial through the nodes;
//! what is heard is that polynomial at the delay. Roots far from the origin are poor, the rightmost ones good; either way
//! they are only where Newton's method begins.

use forwardstep_core::reference::{RootPair, RootSet};
use nalgebra::DMatrix;

use super::characteristic::{C, Characteristic};
use super::eigenvalues::eigenvalues;
use crate::fixed::Link;

/// Chebyshev nodes cos(kπ/M) on [−1, 1] with the matrix that differentiates the polynomial through values there.
struct Nodes {
    at: Vec<f64>,
    differentiate: DMatrix<f64>,
}

impl Nodes {
    fn new(m: usize) -> Nodes {
        let at: Vec<f64> = (0..=m).map(|k| libm::cos(core::f64::consts::PI * k as f64 / m as f64)).collect();
        let end = |k: usize| if k == 0 || k == m { 2.0 } else { 1.0 };
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut differentiate = DMatrix::zeros(m + 1, m + 1);
        for i in 0..=m {
            for j in (0..=m).filter(|j| *j != i) {
                differentiate[(i, j)] = end(i) / end(j) * sign(i + j) / (at[i] - at[j]);
            }
            // The derivative of a constant is zero.
            differentiate[(i, i)] = -differentiate.row(i).sum();
        }
        Nodes { at, differentiate }
    }

    /// What each value counts in the polynomial at `x`.
    fn weights(&self, x: f64) -> Vec<f64> {
        let m = self.at.len() - 1;
        let barycentric = |k: usize| {
            let half = if k == 0 || k == m { 0.5 } else { 1.0 };
            if k.is_multiple_of(2) { half } else { -half }
        };
        if let Some(hit) = self.at.iter().position(|at| *at == x) {
            return (0..=m).map(|k| if k == hit { 1.0 } else { 0.0 }).collect();
        }
        let terms: Vec<f64> = (0..=m).map(|k| barycentric(k) / (x - self.at[k])).collect();
        let sum: f64 = terms.iter().sum();
        terms.iter().map(|term| term / sum).collect()
    }
}

/// Part of what an agent hears: `weight` · ψ_r of `from`, `delay_s` ago.
struct Part {
    from: usize,
    to: usize,
    r: usize,
    weight: f64,
    delay_s: f64,
}

/// What all agents hear: q_j + v q̇_j/κ₀ᵢ = (1 − v κ₀ⱼ/κ₀ᵢ) ψ_{0,j} + v (κ₀ⱼ/κ₀ᵢ) ψ_{1,j}.
fn parts(system: &Characteristic) -> Vec<Part> {
    let each = |&Link { from, to, weight, delay_s }: &Link| {
        let share = system.ratio(to) * system.first_root[from];
        [(0, 1.0 - share), (1, share)].map(|(r, share)| Part { from, to, r, weight: weight * share, delay_s })
    };
    system.links.iter().flat_map(each).filter(|part| part.weight != 0.0).collect()
}

/// Unknowns beside the history, and how many variables have one.
pub(super) fn unknowns(system: &Characteristic) -> [usize; 2] {
    let late = longest(system, &parts(system)).iter().flatten().filter(|delay_s| **delay_s > 0.0).count();
    [system.coefficients.iter().map(Vec::len).sum(), late]
}

/// For ψ₀ and ψ₁ of every agent the longest delay with which they are heard, s.
fn longest(system: &Characteristic, parts: &[Part]) -> Vec<[f64; 2]> {
    let mut longest = vec![[0.0_f64; 2]; system.agents()];
    for part in parts {
        let own = &mut longest[part.from][part.r];
        *own = own.max(part.delay_s);
    }
    longest
}

/// The eigenvalues of the generator with `m` + 1 nodes per late variable, none when they do not converge.
pub(super) fn candidates(system: &Characteristic, roots_per_s: &[&RootSet], m: usize) -> Option<Vec<C>> {
    let parts = parts(system);
    let (longest, nodes) = (longest(system, &parts), Nodes::new(m));
    let [mut later, _] = unknowns(system);
    // Where the states of every agent begin, and the histories of ψ₀ and ψ₁ without the node at no delay.
    let (mut own, mut history, mut next) = (Vec::new(), Vec::new(), 0);
    for (a, delays) in system.coefficients.iter().zip(&longest) {
        own.push(next);
        next += a.len();
        history.push(delays.map(|delay_s| {
            let begin = later;
            later += if delay_s > 0.0 { m } else { 0 };
            begin
        }));
    }
    let column = |agent: usize, r: usize, k: usize| if k == 0 { own[agent] + r } else { history[agent][r] + k - 1 };
    let mut generator = DMatrix::zeros(later, later);
    for (i, roots) in roots_per_s.iter().enumerate() {
        for (r, root) in roots.real.iter().enumerate() {
            generator[(own[i] + r, own[i] + r)] -= root;
            generator[(own[i] + r, own[i] + r + 1)] += root;
        }
        for (k, pair) in roots.pairs.iter().enumerate() {
            averages_of_a_pair(&mut generator, own[i] + roots.real.len() + 2 * k, *pair);
        }
        let top = own[i] + roots.len();
        generator[(top, top)] -= system.degree[i];
        for (r, delay_s) in longest[i].into_iter().enumerate().filter(|(_, delay_s)| *delay_s > 0.0) {
            for k in 1..=m {
                for j in 0..=m {
                    generator[(column(i, r, k), column(i, r, j))] += 2.0 / delay_s * nodes.differentiate[(k, j)];
                }
            }
        }
    }
    for Part { from, to, r, weight, delay_s } in parts {
        let top = own[to] + roots_per_s[to].len();
        if delay_s > 0.0 {
            let weights = nodes.weights(1.0 - 2.0 * delay_s / longest[from][r]);
            for (k, share) in weights.iter().enumerate() {
                generator[(top, column(from, r, k))] += weight * share;
            }
        } else {
            generator[(top, own[from] + r)] += weight;
        }
    }
    eigenvalues(&generator)
}

/// ψ at `at`, ψ⁺ = ψ + 2 a ψ̇/c² + ψ̈/c² with c² = a² + b² two places on, and y = ψ + ψ̇/c between them:
/// ψ̇ = c (y − ψ) and ẏ = (c − 2 a)(y − ψ) + c (ψ⁺ − ψ).
fn averages_of_a_pair(generator: &mut DMatrix<f64>, at: usize, RootPair { real: a, imaginary: b }: RootPair) {
    let c = libm::hypot(a, b);
    let rates = [[-c, c, 0.0], [a + a - c - c, c - a - a, c]];
    for (row, rates) in rates.into_iter().enumerate() {
        for (column, rate) in rates.into_iter().enumerate() {
            generator[(at + row, at + column)] += rate;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_differentiate_and_interpolate_polynomials() {
        let nodes = Nodes::new(6);
        let f = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x * x;
        let values: Vec<f64> = nodes.at.iter().map(|x| f(*x)).collect();
        for i in 0..=6 {
            let slope: f64 = (0..=6).map(|j| nodes.differentiate[(i, j)] * values[j]).sum();
            let x = nodes.at[i];
            assert!((slope - (-2.0 + 1.5 * x * x)).abs() < 1e-12);
        }
        for x in [-1.0, -0.3, nodes.at[2], 0.77, 1.0] {
            let value: f64 = nodes.weights(x).iter().zip(&values).map(|(weight, value)| weight * value).sum();
            assert!((value - f(x)).abs() < 1e-14, "{x}");
        }
    }
}

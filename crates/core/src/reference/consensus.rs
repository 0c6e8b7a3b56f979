//! The consensus family: (aa10), (a1), (a5) and (24) are one equation.
//!
//! With roots κ₀ … κ_{ℓ−1} > 0 let αᵣ be the coefficients of ∏ᵣ (p + κᵣ), so α_ℓ = 1, and let
//!
//! ```text
//! x₀ = q    x₁ = q̇    xᵣ = z^(r−1), r ≥ 2                        (measured below, constructed above: Remark 6)
//!
//! z^(ℓ) = − Σ_{r<ℓ} αᵣ xᵣ₊₁ − Σ_j w_ij [ Σ_{r≤ℓ} αᵣ xᵣ − α₀ q_j(t−T_ij) − (α₀/κ₀) q̇_j(t−T_ij) ]
//!       = − Σ_{r≤ℓ} (αᵣ₋₁ + d αᵣ) xᵣ + α₀ Σ_j w_ij q_j(t−T_ij) + (α₀/κ₀) Σ_j w_ij q̇_j(t−T_ij),   d = Σ_j w_ij,  α₋₁ = 0
//! ```
//!
//! which is (a5); without the last term, when only positions are sent, it is (24). Order 1 with velocities is (aa10),
//! since x₁ = q̇ stands in both sums; order 2 with κ = (α, β) is (a1); order 3 of (24) is (49).
//!
//! Writing Xᵢ for the own part Σ_{r≤ℓ} αᵣ xᵣ, differentiation gives d/dt (Xᵢ − α₁ s) = −Σ_j w_ij (Xᵢ − heard_j) whatever s
//! does (α₁ = 1 for ℓ = 1): the conserved quantity that predicts the agreed value starts here.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::{Exchange, Heard};
use crate::{LengthError, Scalar};

/// What every member of the family measures of its own robot, `axes · agents` entries each.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a, S> {
    /// Joint positions.
    pub q: &'a [S],
    /// Joint velocities.
    pub dq: &'a [S],
}

/// A root that does not make a Hurwitz polynomial with real roots.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RootsError {
    /// No roots at all.
    #[error("the reference dynamics need at least one root")]
    Empty,
    /// A root that is not a positive number.
    #[error("root {index} is {value} per second, but every root must be positive and finite")]
    NotPositive {
        /// Position in the list, from zero.
        index: usize,
        /// The offending value, 1/s.
        value: f64,
    },
    /// Agents of one population must share the order.
    #[error("{got} roots were given where the population has order {need}")]
    Order {
        /// The order of the population.
        need: usize,
        /// The number of roots given.
        got: usize,
    },
}

/// The coefficients α₀ … α_{ℓ−1}, α_ℓ = 1 of ∏ᵣ (p + κᵣ): polynomial (25).
///
/// # Errors
/// [`RootsError`] when there are no roots or one is not positive and finite.
pub fn polynomial(roots_per_s: &[f64]) -> Result<Vec<f64>, RootsError> {
    if roots_per_s.is_empty() {
        return Err(RootsError::Empty);
    }
    let mut alpha = vec![1.0];
    for (index, kappa) in roots_per_s.iter().enumerate() {
        if !(*kappa > 0.0 && kappa.is_finite()) {
            return Err(RootsError::NotPositive { index, value: *kappa });
        }
        // (p + κ) · Σ αᵣ pʳ
        alpha.insert(0, 0.0);
        for r in 0..alpha.len() - 1 {
            alpha[r] += kappa * alpha[r + 1];
        }
    }
    Ok(alpha)
}

/// Reference dynamics of order ℓ for a population of agents, each with roots of its own.
///
/// State: `[z, ż, …, z^(ℓ−1)]`, each m axes, each axis a column of one entry per agent: entry `(r·m + axis)·n + agent`.
/// One agent is a population of one.
///
/// **Source**: (aa10), (a1), (a5), (24), (25).
/// **Measures**: q, q̇. **Transmits**: what `X` says.
/// **Requires**: positive real roots; (a5) over a switching graph or a varying delay also needs a common κ₀ within each
/// strongly connected component of the union graph.
/// **Guarantees**: with a tracking law that keeps s square-integrable, Theorems 2 and 3. z is ℓ−1 times continuously
/// differentiable through switches and delay jumps; z^(ℓ) jumps there and stays bounded.
/// **Deviates from the paper**: for ℓ = 1, α₁ = 1 multiplies q̇, not z, which makes (a5) reduce to (aa10).
#[derive(Clone, Debug)]
pub struct Consensus<X> {
    exchange: core::marker::PhantomData<X>,
    order: usize,
    agents: usize,
    /// αᵣ of every agent: entry `r · agents + agent`, r = 0 … ℓ.
    alpha: Vec<f64>,
    /// α₀/κ₀ of every agent.
    alpha_0_over_kappa_0: Vec<f64>,
}

impl<X: Exchange> Consensus<X> {
    /// Builds the dynamics from the roots κ₀ … κ_{ℓ−1} of every agent.
    ///
    /// # Errors
    /// [`RootsError`] when there are none, one is not positive, or agents differ in their number.
    pub fn new<'a>(roots_per_s: impl IntoIterator<Item = &'a [f64]>) -> Result<Self, RootsError> {
        let mut columns = Vec::new();
        let mut alpha_0_over_kappa_0 = Vec::new();
        for roots in roots_per_s {
            let alpha = polynomial(roots)?;
            if let Some(first) = columns.first().map(Vec::len)
                && first != alpha.len()
            {
                return Err(RootsError::Order { need: first - 1, got: roots.len() });
            }
            alpha_0_over_kappa_0.push(alpha[0] / roots[0]);
            columns.push(alpha);
        }
        let Some(order) = columns.first().map(|alpha| alpha.len() - 1) else { return Err(RootsError::Empty) };
        let agents = columns.len();
        let alpha = (0..=order).flat_map(|r| columns.iter().map(move |alpha| alpha[r])).collect();
        Ok(Consensus { exchange: core::marker::PhantomData, order, agents, alpha, alpha_0_over_kappa_0 })
    }

    /// ℓ.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Number of agents.
    pub fn agents(&self) -> usize {
        self.agents
    }

    /// d/dt of the state `[z, ż, …, z^(ℓ−1)]` for `axes` axes of every agent.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    #[inline(always)]
    pub fn rate<S: Scalar>(
        &self,
        axes: usize,
        measured: Measured<'_, S>,
        state: &[S],
        heard: Heard<'_, S, X>,
        d_state: &mut [S],
    ) -> Result<(), LengthError> {
        let (n, block) = (self.agents, axes * self.agents);
        LengthError::check("q", block, measured.q.len())?;
        LengthError::check("dq", block, measured.dq.len())?;
        LengthError::check("reference state", self.order * block, state.len())?;
        LengthError::check("reference rate", self.order * block, d_state.len())?;
        LengthError::check("degree", n, heard.degree.len())?;
        X::check(heard.sums, block)?;

        // z^(r) ← z^(r+1) below the top, then the one equation of the family at the top.
        let top = (self.order - 1) * block;
        d_state[..top].copy_from_slice(&state[block..]);
        for axis in 0..axes {
            let columns = axis * n..(axis + 1) * n;
            let out = &mut d_state[top..][columns.clone()];
            for i in 0..n {
                let (alpha_0, ratio) = (S::splat(self.alpha[i]), S::splat(self.alpha_0_over_kappa_0[i]));
                out[i] = X::term(heard.sums, columns.start + i, alpha_0, ratio);
            }
            for r in 0..=self.order {
                let x = match r {
                    0 => &measured.q[columns.clone()],
                    1 => &measured.dq[columns.clone()],
                    _ => &state[(r - 1) * block..][columns.clone()],
                };
                let alpha = &self.alpha[r * n..(r + 1) * n];
                if r == 0 {
                    for i in 0..n {
                        out[i] = (heard.degree[i] * S::splat(alpha[i])).neg_mul_add(x[i], out[i]);
                    }
                } else {
                    let below = &self.alpha[(r - 1) * n..r * n];
                    for i in 0..n {
                        let c = heard.degree[i].mul_add(S::splat(alpha[i]), S::splat(below[i]));
                        out[i] = c.neg_mul_add(x[i], out[i]);
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Position, PositionSums, PositionVelocity, PositionVelocitySums};
    use super::*;

    const Q: [f64; 2] = [0.3, -1.2];
    const DQ: [f64; 2] = [0.7, 0.4];
    const Q_J: [f64; 2] = [-0.5, 0.9];
    const DQ_J: [f64; 2] = [0.2, -0.8];
    const W: f64 = 1.5;

    fn sums<'a>(storage: &'a [[f64; 2]; 2]) -> PositionVelocitySums<'a, f64> {
        PositionVelocitySums { q: &storage[0], dq: &storage[1] }
    }

    fn weighted() -> [[f64; 2]; 2] {
        [Q_J.map(|x| W * x), DQ_J.map(|x| W * x)]
    }

    #[test]
    fn eq_25_roots_give_the_polynomial() {
        assert_eq!(polynomial(&[2.0]), Ok(vec![2.0, 1.0]));
        assert_eq!(polynomial(&[1.0, 2.0, 3.0]), Ok(vec![6.0, 11.0, 6.0, 1.0]));
        assert_eq!(polynomial(&[]), Err(RootsError::Empty));
        assert_eq!(polynomial(&[1.0, -2.0]), Err(RootsError::NotPositive { index: 1, value: -2.0 }));
    }

    #[test]
    fn eq_aa10_is_order_1_with_velocities() {
        let alpha = 1.3;
        let law = Consensus::<PositionVelocity>::new([&[alpha][..]]).unwrap();
        let storage = weighted();
        let mut dz = [0.0; 2];
        law.rate(2, Measured { q: &Q, dq: &DQ }, &[9.0; 2], Heard { degree: &[W], sums: sums(&storage) }, &mut dz)
            .unwrap();
        for k in 0..2 {
            let (xi, xi_j) = (DQ[k] + alpha * Q[k], DQ_J[k] + alpha * Q_J[k]);
            assert!((dz[k] - (-alpha * DQ[k] - W * (xi - xi_j))).abs() < 1e-14);
        }
    }

    #[test]
    fn eq_a1_is_order_2_with_velocities() {
        let (alpha, beta) = (1.3, 0.6);
        let law = Consensus::<PositionVelocity>::new([&[alpha, beta][..]]).unwrap();
        let storage = weighted();
        let state = [0.1, -0.2, 0.5, 0.8];
        let mut rate = [0.0; 4];
        law.rate(2, Measured { q: &Q, dq: &DQ }, &state, Heard { degree: &[W], sums: sums(&storage) }, &mut rate)
            .unwrap();
        for k in 0..2 {
            let dz = state[2 + k];
            let (xi, xi_j) = (DQ[k] + alpha * Q[k], DQ_J[k] + alpha * Q_J[k]);
            let ddz = -(alpha + beta) * dz - alpha * beta * DQ[k] - W * (dz + alpha * DQ[k] + beta * xi - beta * xi_j);
            assert_eq!(rate[k], dz);
            assert!((rate[2 + k] - ddz).abs() < 1e-14);
        }
    }

    #[test]
    fn eq_24_order_3_is_eq_49() {
        let (a, b, c) = (1.0, 2.0, 0.5);
        let law = Consensus::<Position>::new([&[a, b, c][..]]).unwrap();
        let q_sum = [W * Q_J[0]];
        let state = [0.1, 0.5, -0.7];
        let mut rate = [0.0; 3];
        let heard = Heard { degree: &[W], sums: PositionSums { q: &q_sum } };
        law.rate(1, Measured { q: &Q[..1], dq: &DQ[..1] }, &state, heard, &mut rate).unwrap();
        let (dz, ddz) = (state[1], state[2]);
        let pairs = a * b + a * c + b * c;
        let dddz = -(a + b + c) * ddz
            - pairs * dz
            - a * b * c * DQ[0]
            - W * (ddz + (a + b + c) * dz + pairs * DQ[0] + a * b * c * (Q[0] - Q_J[0]));
        assert_eq!(rate[..2], state[1..]);
        assert!((rate[2] - dddz).abs() < 1e-14);
    }

    #[test]
    fn wrong_lengths_are_errors() {
        let law = Consensus::<Position>::new([&[1.0][..]]).unwrap();
        let heard = Heard { degree: &[W], sums: PositionSums { q: &[0.0] } };
        let result = law.rate(1, Measured { q: &Q, dq: &DQ }, &[0.0], heard, &mut [0.0]);
        assert_eq!(result, Err(LengthError { what: "q", need: 1, got: 2 }));
    }
}

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
//! since x₁ = q̇ stands in both sums; order 2 with κ = (α, β) is (a1); order 3 of (24) is (49). Remark 4 adds λ (q̇ − z) to
//! each of them, which makes the loop easy to move by hand.
//!
//! Writing Xᵢ for the own part Σ_{r≤ℓ} αᵣ xᵣ, differentiation gives d/dt (Xᵢ − α₁ s) = −Σ_j w_ij (Xᵢ − heard_j) whatever s
//! does (α₁ = 1 for ℓ = 1): the conserved quantity that predicts the agreed value starts here.

use super::polynomial::{Coefficients, RootsError};
use super::roots::RootSet;
use super::{Exchange, Heard, Measured, Reference, ReferenceOut, Sliding, begin, check};
use crate::{LengthError, Scalar};

/// Reference dynamics of order ℓ for a population of agents, each with roots of its own.
///
/// State: `[z, ż, …, z^(ℓ−1)]`.
///
/// **Source**: (aa10), (a1), (a5), (24), (25); Remark 4 for λ.
/// **Measures**: q, q̇. **Transmits**: what `X` says.
/// **Requires**: positive real roots; (a5) over a switching graph or a varying delay also needs a common κ₀ within each
/// strongly connected component of the union graph.
/// **Guarantees**: with a tracking law that keeps s square-integrable, Theorems 2 and 3. z is ℓ−1 times continuously
/// differentiable through switches and delay jumps; z^(ℓ) jumps there and stays bounded.
/// **Deviates from the paper**: for ℓ = 1, α₁ = 1 multiplies q̇, not z, which makes (a5) reduce to (aa10).
///
/// (a1) for α = 1 and β = 2, with one neighbour:
///
/// ```
/// use forwardstep_core::reference::{Consensus, Heard, Measured, PositionVelocity, Reference, ReferenceOut};
///
/// let design = Consensus::<PositionVelocity>::new([(&[1.0, 2.0][..], 0.0)])?;
/// let (q, dq, z, dz) = (0.3, -0.2, 0.5, 0.1);
/// let (w, q_j, dq_j) = (0.8, 1.0, 0.4);
/// let (mut rate, mut dz_out) = ([0.0; 2], [0.0]);
/// let out = ReferenceOut { z: &mut [0.0], dz: &mut dz_out, d_state: &mut rate };
/// let (degree, sums) = ([w], [w * q_j, w * dq_j]);
/// let heard = Heard::new(&degree, &sums, 1)?;
/// design.evaluate(1, Measured { q: &[q], dq: &[dq] }, &[z, dz], heard, out)?;
/// let ddz = -3.0 * dz - 2.0 * dq - w * (dz + 3.0 * dq + 2.0 * q - 2.0 * dq_j - 2.0 * q_j);
/// assert!((rate[1] - ddz).abs() < 1e-12);
/// assert_eq!(dz_out, [dz]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Consensus<X> {
    exchange: core::marker::PhantomData<X>,
    coefficients: Coefficients,
}

impl<X: Exchange> Consensus<X> {
    /// Builds the dynamics from the roots κ₀ … κ_{ℓ−1} and the manipulability gain λ (zero for none) of every agent.
    ///
    /// # Errors
    /// [`RootsError`] when there are no roots, one is not positive, agents differ in their number, a λ is negative,
    /// or velocities are sent and no root is real.
    pub fn new<R: Into<RootSet>>(designs: impl IntoIterator<Item = (R, f64)>) -> Result<Self, RootsError> {
        Ok(Consensus {
            exchange: core::marker::PhantomData,
            coefficients: Coefficients::new(designs, X::CHANNELS > 1)?,
        })
    }

    /// ℓ.
    pub fn order(&self) -> usize {
        self.coefficients.order
    }
}

impl<X: Exchange> Reference for Consensus<X> {
    type Exchange = X;

    fn agents(&self) -> usize {
        self.coefficients.agents
    }

    fn vectors(&self) -> usize {
        self.coefficients.order
    }

    fn derivatives(&self) -> usize {
        self.coefficients.order
    }

    fn sliding(&self) -> Option<&Sliding> {
        None
    }

    fn is_affine(&self) -> bool {
        true
    }

    #[inline(always)]
    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, X>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        let Coefficients { order, agents: n, .. } = self.coefficients;
        check([axes, n, order], measured, state, heard, &out)?;
        let block = axes * n;

        // z^(r) ← z^(r+1) below the top, then the one equation of the family at the top.
        let top = (order - 1) * block;
        out.d_state[..top].copy_from_slice(&state[block..]);
        for axis in 0..axes {
            let columns = axis * n..(axis + 1) * n;
            let rate = &mut out.d_state[top..][columns.clone()];
            let (dq, z) = (&measured.dq[columns.clone()], &state[columns.clone()]);
            for i in 0..n {
                let (alpha_0, ratio) = (self.coefficients.alpha[i], self.coefficients.alpha_0_over_kappa_0[i]);
                let received = X::term(heard.sums, columns.start + i, alpha_0, ratio);
                rate[i] = self.coefficients.lambda[i].mul_add(dq[i] - z[i], received);
            }
            for r in 0..=order {
                let x = match r {
                    0 => &measured.q[columns.clone()],
                    1 => dq,
                    _ => &state[(r - 1) * block..][columns.clone()],
                };
                let alpha = self.coefficients.alpha(r);
                if r == 0 {
                    for i in 0..n {
                        rate[i] = (heard.degree[i] * alpha[i]).neg_mul_add(x[i], rate[i]);
                    }
                } else {
                    let below = self.coefficients.alpha(r - 1);
                    for i in 0..n {
                        let c = heard.degree[i].mul_add(alpha[i], below[i]);
                        rate[i] = c.neg_mul_add(x[i], rate[i]);
                    }
                }
            }
        }

        out.z.copy_from_slice(&state[..block]);
        // ż is a state, but for order one, where it is the rate just computed.
        out.dz.copy_from_slice(&out.d_state[..block]);
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        _: Measured<'_>,
        given: &[f64],
        _: Heard<'_, X>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let need = self.vectors() * axes * self.agents();
        begin([need, need], given, state)
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;
    use alloc::vec::Vec;

    use super::super::{Position, PositionSums, PositionVelocity, PositionVelocitySums};
    use super::*;

    const Q: [f64; 2] = [0.3, -1.2];
    const DQ: [f64; 2] = [0.7, 0.4];
    const Q_J: [f64; 2] = [-0.5, 0.9];
    const DQ_J: [f64; 2] = [0.2, -0.8];
    const W: f64 = 1.5;

    /// z, ż and the rate of the state of one agent with two axes.
    fn evaluate<R: Reference>(
        law: &R,
        state: &[f64],
        sums: <R::Exchange as Exchange>::Sums<'_>,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (mut z, mut dz, mut rate) = (vec![0.0; 2], vec![0.0; 2], vec![0.0; state.len()]);
        let heard = Heard { degree: &[W], sums, time_s: 0.0 };
        let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
        law.evaluate(2, Measured { q: &Q, dq: &DQ }, state, heard, out).unwrap();
        (z, dz, rate)
    }

    #[test]
    fn eq_aa10_is_order_1_with_velocities() {
        let alpha = 1.3;
        let law = Consensus::<PositionVelocity>::new([(&[alpha][..], 0.0)]).unwrap();
        let (q_sum, dq_sum) = (Q_J.map(|x| W * x), DQ_J.map(|x| W * x));
        let (z, dz, rate) = evaluate(&law, &[9.0; 2], PositionVelocitySums { q: &q_sum, dq: &dq_sum });
        assert_eq!((z, &rate), (vec![9.0; 2], &dz));
        for k in 0..2 {
            let (xi, xi_j) = (DQ[k] + alpha * Q[k], DQ_J[k] + alpha * Q_J[k]);
            assert!((dz[k] - (-alpha * DQ[k] - W * (xi - xi_j))).abs() < 1e-14);
        }
    }

    #[test]
    fn eq_a1_is_order_2_with_velocities_and_remark_4_adds_lambda() {
        let (alpha, beta, lambda) = (1.3, 0.6, 0.9);
        let law = Consensus::<PositionVelocity>::new([(&[alpha, beta][..], lambda)]).unwrap();
        let (q_sum, dq_sum) = (Q_J.map(|x| W * x), DQ_J.map(|x| W * x));
        let state = [0.1, -0.2, 0.5, 0.8];
        let (z, dz, rate) = evaluate(&law, &state, PositionVelocitySums { q: &q_sum, dq: &dq_sum });
        assert_eq!((&z[..], &dz[..], &rate[..2]), (&state[..2], &state[2..], &state[2..]));
        for k in 0..2 {
            let (xi, xi_j) = (DQ[k] + alpha * Q[k], DQ_J[k] + alpha * Q_J[k]);
            let ddz =
                -(alpha + beta) * dz[k] - alpha * beta * DQ[k] - W * (dz[k] + alpha * DQ[k] + beta * xi - beta * xi_j)
                    + lambda * (DQ[k] - z[k]);
            assert!((rate[2 + k] - ddz).abs() < 1e-14);
        }
    }

    #[test]
    fn eq_24_order_3_is_eq_49() {
        let (a, b, c) = (1.0, 2.0, 0.5);
        let law = Consensus::<Position>::new([(&[a, b, c][..], 0.0)]).unwrap();
        let q_sum = Q_J.map(|x| W * x);
        let state = [0.1, 0.2, 0.5, -0.4, -0.7, 0.3];
        let (_, dz, rate) = evaluate(&law, &state, PositionSums { q: &q_sum });
        let pairs = a * b + a * c + b * c;
        assert_eq!(rate[..4], state[2..]);
        for k in 0..2 {
            let ddz = state[4 + k];
            let dddz = -(a + b + c) * ddz
                - pairs * dz[k]
                - a * b * c * DQ[k]
                - W * (ddz + (a + b + c) * dz[k] + pairs * DQ[k] + a * b * c * (Q[k] - Q_J[k]));
            assert!((rate[4 + k] - dddz).abs() < 1e-14);
        }
    }

    #[test]
    fn wrong_lengths_are_errors() {
        let law = Consensus::<Position>::new([(&[1.0][..], 0.0)]).unwrap();
        let heard = Heard { degree: &[W], sums: PositionSums { q: &[0.0] }, time_s: 0.0 };
        let out = ReferenceOut { z: &mut [0.0], dz: &mut [0.0], d_state: &mut [0.0] };
        let result = law.evaluate(1, Measured { q: &Q, dq: &DQ }, &[0.0], heard, out);
        assert_eq!(result, Err(LengthError { what: "q", need: 1, got: 2 }));
    }
}

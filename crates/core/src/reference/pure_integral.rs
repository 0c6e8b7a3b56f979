//! (3) and (23): reference dynamics with q̈, realised by their integral (Remark 2).
//!
//! With roots κ₀ = α, κ₁ = β, α₁ = α + β, α₀ = α β and d = Σ_j w_ij both read
//!
//! ```text
//! z̈ = −α₁ q̈ − α₀ q̇ − Σ_j w_ij [ q̈ + α₁ q̇ + α₀ q − β q̇_j(t−T_ij) − α₀ q_j(t−T_ij) ] + λ (q̇ − z)
//! ```
//!
//! where (23), which hears positions only, lacks β q̇_j; the last term is (31). For a fixed graph everything that carries a
//! derivative integrates to what is measured, and what is left is one integrated variable η:
//!
//! ```text
//! ż = −α₁ q̇ − α₀ q − d (q̇ + α₁ q) + η        η̇ = −d α₀ q + Σ_j w_ij [ β q̇_j + α₀ q_j ](t−T_ij) + λ (q̇ − z)
//! ```
//!
//! No acceleration is measured. When the graph switches d jumps, and ż and the torque jump with it: these designs are for
//! fixed graphs; (a1) is the one for switching graphs.

use super::polynomial::{Coefficients, RootsError};
use super::roots::RootSet;
use super::{Exchange, Heard, Measured, Reference, ReferenceOut, Sliding, check};
use crate::{LengthError, Scalar};

/// Reference dynamics of order two that contain q̈. State: `[z, η]`.
///
/// **Source**: (3) when velocities are exchanged, (23) when only positions are; (31) for λ > 0.
/// **Measures**: q, q̇. **Transmits**: what `X` says.
/// **Requires**: a fixed graph with a directed spanning tree; bounded, piecewise continuous delays.
/// **Guarantees**: Theorem 1 for (3), Remark 3 for (23): ż is differentiable, so the torque is, even where a delay jumps.
/// **Deviates from the paper**: realised by the integral above; over a switching graph it runs, but nothing is promised.
///
/// The acceleration of (3) is integrated, not measured: with all that is heard at rest, a step of q̇ steps ż by −(α₁ + d) of it.
///
/// ```
/// use forwardstep_core::reference::{Heard, Measured, PositionVelocity, PureIntegral, Reference, ReferenceOut};
///
/// let design = PureIntegral::<PositionVelocity>::new([(&[1.0, 2.0][..], 0.0)])?;
/// let dz = |dq: f64| -> Result<f64, Box<dyn std::error::Error>> {
///     let (mut rate, mut dz) = ([0.0; 2], [0.0]);
///     let out = ReferenceOut { z: &mut [0.0], dz: &mut dz, d_state: &mut rate };
///     let heard = Heard::new(&[0.8], &[0.8 * 1.0, 0.0], 1)?;
///     design.evaluate(1, Measured { q: &[0.3], dq: &[dq] }, &[0.5, 0.1], heard, out)?;
///     // η̇ = Σ w α₀ (q_j − q)
///     assert!((rate[1] - 0.8 * 2.0 * (1.0 - 0.3)).abs() < 1e-12);
///     Ok(dz[0])
/// };
/// assert!((dz(0.5)? - dz(-0.5)? + (3.0 + 0.8)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PureIntegral<X> {
    exchange: core::marker::PhantomData<X>,
    coefficients: Coefficients,
}

impl<X: Exchange> PureIntegral<X> {
    /// Builds the dynamics from the two roots κ₀ = α, κ₁ = β and the manipulability gain λ (zero for none) of every agent.
    ///
    /// # Errors
    /// [`RootsError`] when an agent has not two roots, one is not positive, a λ is negative, or velocities are sent
    /// and no root is real.
    pub fn new<R: Into<RootSet>>(designs: impl IntoIterator<Item = (R, f64)>) -> Result<Self, RootsError> {
        let coefficients = Coefficients::new(designs, X::CHANNELS > 1)?;
        if coefficients.order != 2 {
            return Err(RootsError::Order { need: 2, got: coefficients.order });
        }
        Ok(PureIntegral { exchange: core::marker::PhantomData, coefficients })
    }
}

impl<X: Exchange> Reference for PureIntegral<X> {
    type Exchange = X;

    fn agents(&self) -> usize {
        self.coefficients.agents
    }

    fn vectors(&self) -> usize {
        2
    }

    fn derivatives(&self) -> usize {
        1
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
        let n = self.coefficients.agents;
        check([axes, n, 2], measured, state, heard, &out)?;
        let (z, eta) = state.split_at(axes * n);
        let (z_rate, eta_rate) = out.d_state.split_at_mut(axes * n);
        for k in 0..axes * n {
            let i = k % n;
            let [alpha_0, alpha_1] = [0, 1].map(|r| self.coefficients.alpha(r)[i]);
            let (ratio, lambda) = (self.coefficients.alpha_0_over_kappa_0[i], self.coefficients.lambda[i]);
            let (q, dq, d) = (measured.q[k], measured.dq[k], heard.degree[i]);
            let received = X::term(heard.sums, k, alpha_0, ratio);
            // −(α₁ + d) q̇ − (α₀ + d α₁) q + η
            let dz = (alpha_1 + d).neg_mul_add(dq, d.mul_add(alpha_1, alpha_0).neg_mul_add(q, eta[k]));
            out.z[k] = z[k];
            out.dz[k] = dz;
            z_rate[k] = dz;
            eta_rate[k] = (d * alpha_0).neg_mul_add(q, lambda.mul_add(dq - z[k], received));
        }
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, X>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let (n, block) = (self.coefficients.agents, axes * self.coefficients.agents);
        LengthError::check("start of the reference", 2 * block, given.len())?;
        LengthError::check("reference state", 2 * block, state.len())?;
        LengthError::check("q", block, measured.q.len())?;
        LengthError::check("dq", block, measured.dq.len())?;
        LengthError::check("degree", n, heard.degree.len())?;
        let (z, eta) = state.split_at_mut(block);
        z.copy_from_slice(&given[..block]);
        for k in 0..block {
            let [alpha_0, alpha_1] = [0, 1].map(|r| self.coefficients.alpha(r)[k % n]);
            let d = heard.degree[k % n];
            eta[k] = given[block + k] + (alpha_1 + d) * measured.dq[k] + (alpha_0 + d * alpha_1) * measured.q[k];
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Position, PositionSums, PositionVelocity, PositionVelocitySums};
    use super::*;

    const W: f64 = 1.5;
    const LAMBDA: f64 = 0.7;
    const ALPHA: f64 = 1.3;
    const BETA: f64 = 0.6;

    /// ż and the rates of z and η of one agent with one axis.
    fn evaluate<X: Exchange>(sums: X::Sums<'_>, [q, dq, z, eta]: [f64; 4]) -> [f64; 3] {
        let law = PureIntegral::<X>::new([(&[ALPHA, BETA][..], LAMBDA)]).unwrap();
        let (mut z_out, mut dz, mut rate) = ([0.0], [0.0], [0.0; 2]);
        let out = ReferenceOut { z: &mut z_out, dz: &mut dz, d_state: &mut rate };
        law.evaluate(1, Measured { q: &[q], dq: &[dq] }, &[z, eta], Heard { degree: &[W], sums, time_s: 0.0 }, out)
            .unwrap();
        [dz[0], rate[0], rate[1]]
    }

    #[test]
    fn eq_3_and_eq_23_are_their_literal_forms_with_the_acceleration() {
        // ż is linear in q, q̇ and η, so its derivative is the same function of q̇, q̈ and η̇.
        let [q, dq, ddq, z, eta, q_j, dq_j] = [0.3, -0.7, 1.9, 0.4, -1.1, 0.8, -0.2];
        let own = ddq + (ALPHA + BETA) * dq + ALPHA * BETA * q;
        let literal =
            |received: f64| -(ALPHA + BETA) * ddq - ALPHA * BETA * dq - W * (own - received) + LAMBDA * (dq - z);

        let sums = PositionVelocitySums { q: &[W * q_j], dq: &[W * dq_j] };
        let [dz, z_rate, eta_rate] = evaluate::<PositionVelocity>(sums, [q, dq, z, eta]);
        let none = PositionVelocitySums { q: &[0.0], dq: &[0.0] };
        let [ddz, ..] = evaluate::<PositionVelocity>(none, [dq, ddq, 0.0, eta_rate]);
        assert_eq!(z_rate, dz);
        assert!((ddz - literal(BETA * dq_j + ALPHA * BETA * q_j)).abs() < 1e-14);

        let [.., eta_rate] = evaluate::<Position>(PositionSums { q: &[W * q_j] }, [q, dq, z, eta]);
        let [ddz, ..] = evaluate::<Position>(PositionSums { q: &[0.0] }, [dq, ddq, 0.0, eta_rate]);
        assert!((ddz - literal(ALPHA * BETA * q_j)).abs() < 1e-14);
    }

    #[test]
    fn the_start_gives_the_wanted_reference_acceleration() {
        let law = PureIntegral::<Position>::new([(&[ALPHA, BETA][..], 0.0)]).unwrap();
        let (q, dq, z, dz) = (0.3, -0.7, 0.4, 2.5);
        let mut state = [0.0; 2];
        let heard = Heard { degree: &[W], sums: PositionSums { q: &[0.2] }, time_s: 0.0 };
        law.start(1, Measured { q: &[q], dq: &[dq] }, &[z, dz], heard, &mut state).unwrap();
        let [got, ..] = evaluate::<Position>(PositionSums { q: &[0.2] }, [q, dq, state[0], state[1]]);
        assert!((got - dz).abs() < 1e-14 && state[0] == z);
    }

    #[test]
    fn other_orders_are_refused() {
        let error = PureIntegral::<Position>::new([(&[1.0][..], 0.0)]).unwrap_err();
        assert_eq!(error, RootsError::Order { need: 2, got: 1 });
    }
}

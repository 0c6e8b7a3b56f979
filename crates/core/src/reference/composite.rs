//! Following a leader over graphs that take turns and links that delay, with differentiable torques: the design that (122) leads to
//! when all that agents tell each other is one vector. Not from the paper; derived here.
//!
//! In (119) let ż and z take the place of q̈ and q̇ in what is damped and in what is told, y = ż + β z + α q in the place of
//! ξ* = q̈ + β q̇ + α q:
//!
//! ```text
//! z̈_i = −β ż_i − α q̇_i − Σ_j w_ij (y_i − y_j) − γ ς_i,      ς_i ∈ Sgn[Σ_j w_ij (y_i − y_j)]
//! ```
//!
//! Then ẏ_i = z̈_i + β ż_i + α q̇_i has neither a velocity nor a position left in it. With y as a state the design reads
//!
//! ```text
//! ẏ_i = −Σ_j w_ij (y_i − y_j) − γ ς_i
//! ż_i = y_i − β z_i − α q_i
//! ```
//!
//! and the leader, vertex 0, tells y_0 = q̈_0 + β q̇_0 + α q_0. Nothing is differentiated, and no acceleration is measured or told.
//!
//! **Why y follows.** Let L be the Laplacian of the followers with the weights to the leader, and ỹ = y − y_0 on one axis. Then
//! dỹ/dt = −L ỹ − γ ς − 1 ẏ_0 with ς ∈ Sgn(L ỹ): (110) with s ≡ 0, exactly and at all times, since no robot enters. So, with
//! D = sup|ẏ_0|∞ < γ, all that the head of `following.rs` shows of robots that follow exactly is true of ỹ:
//!
//! - where the leader reaches everybody in each graph, the largest |ỹ_i| falls at γ − D at least, whatever the order and the
//!   length of the phases, and ỹ = 0 from t = max|ỹ_i(0)|/(γ − D) on;
//! - on a fixed graph with constant weights, in which messages are up to T_ij old, |ỹ_i| ≤ c_i in the end, where
//!   L c = D Σ_j w_ij T_ij: in proportion to the delays, and nothing where the leader comes to rest.
//!
//! **Why the robot follows.** With x = q − q_0 and v = z − q̇_0, which (6)–(7) make ẋ − s,
//!
//! ```text
//! ẋ = v + s        v̇ = ż − q̈_0 = −β v − α x + ỹ
//! ```
//!
//! a stable filter for any α, β > 0, driven by ỹ and by s, none of them differentiated: the cascade
//! ẍ + β ẋ + α x = ỹ + ṡ + β s is of degree one, and this is its reduction. By (6)–(7) V_i = ½ sᵀMs + ½ Δϑᵀ Γ⁻¹ Δϑ has
//! V̇_i = −sᵀK s, so s is bounded and square-integrable; ỹ is bounded, hence x, v and, with q̇_0 and q̈_0 bounded, q̇, z, ż and ṡ:
//! s → 0, and x → 0, ẋ → 0 where ỹ → 0. Where ỹ does not vanish |x_i| ≤ c_i/α is left, times (1 + b/a) if p² + β p + α has the
//! roots −a ± b i: the absolute integral of the response of the filter.
//!
//! **What the torque does.** ς jumps, and graphs and delays do, in ẏ alone. y is then Lipschitz continuous, ż has a derivative of
//! bounded size, and the torque of (6) is differentiable through all of them. In (119) and (122) ż holds differences of what is heard
//! by itself, so that a switch or a late packet makes it jump.
//!
//! **What it is not.** What agents tell is no measurement of themselves: a push on one robot moves no other, and none waits for
//! it. With y = ż + β q̇ + α q, which they could measure, ẏ would have β ṡ in it, and ỹ would vanish with s only.

use alloc::vec::Vec;

use super::sliding::Sliding;
use super::{Composite, CompositeSums, Heard, Measured, Reference, ReferenceOut, check};
use crate::{LengthError, Scalar};

/// Agents that agree with their leader on one vector, and are led by it. State: `[z, y, ς]`.
///
/// **Source**: our own derivation, at the head of this file; it goes on from (119), (122) and Remark 12.
/// **Measures**: q, q̇. **Transmits**: y = ż + β z + α q; a leader q̈_0 + β q̇_0 + α q_0.
/// **Requires**: a leader that reaches everybody, in each of the graphs if they take turns; common α, β > 0;
/// γ > sup|d³q_0 + β q̈_0 + α q̇_0|∞.
/// **Guarantees**: q_i − q_0 → 0 and q̇_i − q̇_0 → 0 under (6)–(7), with differentiable torques, over graphs that take turns
/// without delay; on a fixed graph with delays a bound of what is left.
/// **Deviates from the paper**: is not in it.
///
/// The sign is set-valued, see [`Sliding`]; it is taken of what is told. z(0) and ż(0) are as given, and
/// y(0) = ż(0) + β z(0) + α q(0).
///
/// ```
/// use forwardstep_core::reference::{Choice, CompositeFollowing, Derived, Heard, Measured, Reference, ReferenceOut, Sliding};
///
/// let (alpha, beta, gamma) = (2.0, 3.0, 4.0);
/// let sign = Sliding { derived: Derived::Composite, alpha, beta, gamma, choice: Choice::Implicit };
/// let (q, dq, z, y, selection) = (0.3, -0.2, 0.5, 0.7, 0.25);
/// let (w, y_j) = (0.8, 1.0);
/// let (mut dz, mut rate) = ([0.0], [0.0; 3]);
/// let out = ReferenceOut { z: &mut [0.0], dz: &mut dz, d_state: &mut rate };
/// let (degree, sums) = ([w], [w * y_j]);
/// let heard = Heard::new(&degree, &sums, 1)?;
/// CompositeFollowing::new(1, sign).evaluate(1, Measured { q: &[q], dq: &[dq] }, &[z, y, selection], heard, out)?;
/// assert!((dz[0] - (y - beta * z - alpha * q)).abs() < 1e-12);
/// // z̈ as it stands at the head.
/// let ddz = rate[1] - beta * dz[0] - alpha * dq;
/// assert!((ddz - (-beta * dz[0] - alpha * dq - w * (y - y_j) - gamma * selection)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CompositeFollowing {
    agents: usize,
    sliding: Sliding,
}

impl CompositeFollowing {
    /// For `agents` agents. [`Sliding::derived`] must be [`Derived::Composite`](super::Derived::Composite).
    pub fn new(agents: usize, sliding: Sliding) -> Self {
        CompositeFollowing { agents, sliding }
    }

    /// y where z, ż and q are these.
    fn composite(&self, z: f64, dz: f64, q: f64) -> f64 {
        self.sliding.beta.mul_add(z, self.sliding.alpha.mul_add(q, dz))
    }
}

impl Reference for CompositeFollowing {
    type Exchange = Composite;

    fn agents(&self) -> usize {
        self.agents
    }

    fn vectors(&self) -> usize {
        3
    }

    fn derivatives(&self) -> usize {
        1
    }

    fn sliding(&self) -> Option<&Sliding> {
        Some(&self.sliding)
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
        heard: Heard<'_, Composite>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        check([axes, self.agents, 3], measured, state, heard, &out)?;
        let block = axes * self.agents;
        let (z, rest) = state.split_at(block);
        let (y, selection) = rest.split_at(block);
        let [alpha, beta, gamma] = [self.sliding.alpha, self.sliding.beta, self.sliding.gamma];
        let CompositeSums { y: y_heard } = heard.sums;
        for k in 0..block {
            let d = heard.degree[k % self.agents];
            let dz = beta.neg_mul_add(z[k], alpha.neg_mul_add(measured.q[k], y[k]));
            out.z[k] = z[k];
            out.dz[k] = dz;
            out.d_state[k] = dz;
            out.d_state[block + k] = gamma.neg_mul_add(selection[k], d.neg_mul_add(y[k], y_heard[k]));
            out.d_state[2 * block + k] = 0.0;
        }
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        _: Heard<'_, Composite>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let block = axes * self.agents;
        LengthError::check("start of the reference", 3 * block, given.len())?;
        LengthError::check("reference state", 3 * block, state.len())?;
        LengthError::check("q", block, measured.q.len())?;
        state[..block].copy_from_slice(&given[..block]);
        for k in 0..block {
            state[block + k] = self.composite(given[k], given[block + k], measured.q[k]);
        }
        state[2 * block..].fill(0.0);
        Ok(())
    }

    fn initial_message(&self, wanted: &[Vec<f64>], message: &mut [f64]) {
        let of = |k: usize, r: usize| wanted.get(r).and_then(|block| block.get(k)).copied().unwrap_or(0.0);
        for (k, y) in message.iter_mut().enumerate() {
            *y = self.composite(of(k, 0), of(k, 1), *y);
        }
    }
}

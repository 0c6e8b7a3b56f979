//! A distributed observer of the leader: a rival of (110), of the kind that Remark 11 sets beside the paper's physical
//! measurements. Not from the paper; derived here.
//!
//! Every agent holds estimates x̂_i and v̂_i of where the leader is and how fast it moves, and tells these, not what it measures. The
//! leader tells x̂_0 = q_0 and v̂_0 = q̇_0. With ξ̂ = v̂ + α x̂,
//!
//! ```text
//! dx̂_i/dt = v̂_i
//! dv̂_i/dt = −α v̂_i − Σ_j w_ij (ξ̂_i − ξ̂_j) − γ ς_i,      ς_i ∈ Sgn[Σ_j w_ij (ξ̂_i − ξ̂_j)]
//! z_i = v̂_i − κ (q_i − x̂_i),      ż_i = dv̂_i/dt − κ (q̇_i − v̂_i)
//! ```
//!
//! and the robot follows z_i by (6)–(7). z is a function of what the agent holds and measures, and so is ż: nothing is differentiated.
//!
//! **Why the leader is observed.** Let L be the Laplacian of the followers with the weights to the leader, ξ̃ = ξ̂ − ξ_0 on one axis
//! and e = L ξ̃. Then
//!
//! ```text
//! dξ̃/dt = −L ξ̃ − γ ς − 1 ξ̇_0,      ς ∈ Sgn(L ξ̃)
//! ```
//!
//! which is (110) with s ≡ 0, exactly and at all times: no robot enters. As at the head of `following.rs`, where the leader
//! reaches everybody and γ > D = sup|ξ̇_0|∞ the largest |ξ̃_i| falls at γ − D at least, so that all are zero from
//! t = max|ξ̃_i(0)|/(γ − D) on. From d(x̂_i − q_0)/dt = −α (x̂_i − q_0) + ξ̃_i then x̂_i → q_0 and v̂_i → q̇_0. Where links between
//! followers lead both ways with equal weights, L = Lᵀ > 0 and, summed over the axes,
//!
//! ```text
//! V = ½ ξ̃ᵀL ξ̃,      V̇ = ξ̃ᵀL dξ̃/dt = −|e|² − γ eᵀς − eᵀ1 ξ̇_0 ≤ −|e|² − (γ − D) |e|₁
//! ```
//!
//! Without a sign, γ = 0, −L is Metzler and Hurwitz, and |ξ̃_i| ≤ D c_i is left in the end, L c = 1: nothing, if the leader comes to
//! rest or ξ̇_0 → 0.
//!
//! **Why the robot follows.** d(q_i − x̂_i)/dt = −κ (q_i − x̂_i) + s_i. By (6)–(7) V_i = ½ sᵀMs + ½ Δϑᵀ Γ⁻¹ Δϑ has V̇_i = −sᵀK s,
//! so s_i is bounded and square-integrable. q_i − x̂_i is bounded then, and with q̇_0 and q̈_0 bounded so are v̂_i, z_i, q̇_i, dv̂_i/dt and
//! ż_i, hence ṡ_i: s_i → 0, q_i − x̂_i → 0, and with what stands above q_i → q_0 and q̇_i → q̇_0.
//!
//! **What differs from (110).** Nothing of a robot enters the observer, so its proof needs no degree reduction, and a push, a limit
//! or friction at one robot moves no other: none waits for it either. Under (110) ξ_j is measured, and neighbours give way.
//! Two more vectors of state are held, and what is told is no measurement: a sensor that sees a neighbour does not replace the
//! radio. The sign is in ż in both, so that both torques are as smooth as the chosen ς.

use alloc::vec::Vec;

use super::sliding::Sliding;
use super::{EstimateSums, Estimates, Exchange, Heard, Measured, Reference, ReferenceOut, check};
use crate::{LengthError, Scalar};

/// An observer of the leader, and where it leads the robot. State: `[x̂, v̂, ς]`.
///
/// **Source**: our own derivation, at the head of this file; Remark 11 names works of this kind.
/// **Measures**: q, q̇. **Transmits**: its estimates x̂ and v̂; a leader its q_0 and q̇_0.
/// **Requires**: a fixed graph without delay in which the leader reaches everybody; a common α; γ > sup|q̈_0 + α q̇_0|∞.
/// **Guarantees**: q_i − q_0 → 0 and q̇_i − q̇_0 → 0 under (6)–(7), and v̂_i + α x̂_i = q̇_0 + α q_0 from a finite time on.
/// **Deviates from the paper**: is not in it.
///
/// The sign is set-valued, see [`Sliding`]; it is taken of the estimates, so [`SlidingInputs`](super::SlidingInputs) of
/// it holds x̂ and v̂ where it names q and q̇. z(0) = v̂(0) is what is given, and x̂(0) = q(0).
///
/// ```
/// use forwardstep_core::reference::{Choice, Derived, Heard, Measured, Observer, Reference, ReferenceOut, Sliding};
///
/// let (alpha, gamma, kappa) = (1.5, 4.0, 2.0);
/// let sign = Sliding { derived: Derived::Nothing, alpha, beta: 1.0, gamma, choice: Choice::Implicit };
/// let (q, dq, x, v, selection) = (0.3, -0.2, 0.5, 0.7, 0.25);
/// let (w, x_j, v_j) = (0.8, 1.0, 0.4);
/// let (mut z, mut dz, mut rate) = ([0.0], [0.0], [0.0; 3]);
/// let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
/// let (degree, sums) = ([w], [w * x_j, w * v_j]);
/// let heard = Heard::new(&degree, &sums, 1)?;
/// Observer::new(1, sign, kappa).evaluate(1, Measured { q: &[q], dq: &[dq] }, &[x, v, selection], heard, out)?;
/// let xi = |x: f64, v: f64| v + alpha * x;
/// assert!((rate[1] - (-alpha * v - w * (xi(x, v) - xi(x_j, v_j)) - gamma * selection)).abs() < 1e-12);
/// assert!((z[0] - (v - kappa * (q - x))).abs() < 1e-12);
/// assert!((dz[0] - (rate[1] - kappa * (dq - v))).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Observer {
    agents: usize,
    sliding: Sliding,
    kappa: f64,
}

impl Observer {
    /// For `agents` agents, with κ = `kappa` in 1/s. [`Sliding::beta`] must be one and nothing derived.
    pub fn new(agents: usize, sliding: Sliding, kappa: f64) -> Self {
        Observer { agents, sliding, kappa }
    }
}

impl Reference for Observer {
    type Exchange = Estimates;

    fn agents(&self) -> usize {
        self.agents
    }

    fn vectors(&self) -> usize {
        3
    }

    fn derivatives(&self) -> usize {
        0
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
        heard: Heard<'_, Estimates>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        check([axes, self.agents, 3], measured, state, heard, &out)?;
        let block = axes * self.agents;
        let (x, rest) = state.split_at(block);
        let (v, selection) = rest.split_at(block);
        let [alpha, gamma] = [self.sliding.alpha, self.sliding.gamma];
        let EstimateSums { x: x_heard, v: v_heard } = heard.sums;
        for k in 0..block {
            let d = heard.degree[k % self.agents];
            // −(α + d) v̂ − d α x̂ + Σ w (v̂_j + α x̂_j) − γ ς
            let received = alpha.mul_add(x_heard[k], v_heard[k]);
            let own = (alpha + d).neg_mul_add(v[k], (d * alpha).neg_mul_add(x[k], received));
            let dv = gamma.neg_mul_add(selection[k], own);
            out.z[k] = self.kappa.neg_mul_add(measured.q[k] - x[k], v[k]);
            out.dz[k] = self.kappa.neg_mul_add(measured.dq[k] - v[k], dv);
            out.d_state[k] = v[k];
            out.d_state[block + k] = dv;
            out.d_state[2 * block + k] = 0.0;
        }
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, Estimates>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let block = axes * self.agents;
        LengthError::check("start of the reference", 3 * block, given.len())?;
        LengthError::check("reference state", 3 * block, state.len())?;
        LengthError::check("q", block, measured.q.len())?;
        Estimates::check(heard.sums, block)?;
        state[..block].copy_from_slice(measured.q);
        state[block..2 * block].copy_from_slice(&given[..block]);
        state[2 * block..].fill(0.0);
        Ok(())
    }

    // x̂(0) = q(0), which stands there, and v̂(0) = z(0).
    fn initial_message(&self, wanted: &[Vec<f64>], message: &mut [f64]) {
        let velocity = message.len() / 2;
        for (v, wanted) in message[velocity..].iter_mut().zip(wanted.first().into_iter().flatten()) {
            *v = *wanted;
        }
    }
}

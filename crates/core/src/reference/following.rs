//! (110), (119) and (122): following a leader that only some can see, with a set-valued sign. And swarm tracking, which
//! Remark 11 names and the paper does not print: our own derivation.
//!
//! Vertex 0 is the leader; it is heard like everybody else, so nothing here knows which neighbour it is. (110) is
//!
//! ```text
//! ż_i = −α q̇_i − Σ_j w_ij (ξ_i − ξ_j) − γ ς_i,      ς_i ∈ Sgn[Σ_j w_ij (ξ_i − ξ_j)],      ξ = q̇ + α q
//! ```
//!
//! whose torque chatters if ς does. (119) adds a differentiator,
//!
//! ```text
//! z̈_i = −β q̈_i − α q̇_i − Σ_j w_ij (ξ*_i − ξ*_j) − γ ς_i,      ς_i ∈ Sgn[Σ_j w_ij (ξ*_i − ξ*_j)],      ξ* = q̈ + β q̇ + α q
//! ```
//!
//! and (122) is its integral, with ξ** = ż + β q̇ + α q in place of ξ* inside the sign only. On a fixed graph without delay
//! everything but the sign integrates to what is measured, so both are one system with one integrated variable p,
//!
//! ```text
//! ż_i = −β q̇_i − α q_i − Σ_j w_ij (q̇_i − q̇_j) + p_i
//! ṗ_i = −Σ_j w_ij [β q̇_i + α q_i − β q̇_j − α q_j] − γ ς_i
//! ```
//!
//! p(0) = c** in (122). Differentiating the first and putting in the second gives (119). An acceleration is needed for the sign
//! of (119) alone.
//!
//! **Why the leader is followed.** With s ≡ 0 and ξ̃ = ξ − ξ_0 (likewise ξ*, ξ**) all three are
//! dξ̃/dt = −L ξ̃ − γ ς − ξ̇_0 with ς ∈ Sgn(L ξ̃), where L is the Laplacian of the followers with the weights to the leader, a
//! nonsingular M-matrix when the leader reaches everybody. Where some entry of ξ̃ is the largest of its axis and differs from a
//! neighbour's, e is positive there and that entry falls at a rate of γ − sup|ξ̇_0|∞ or more, likewise the smallest rises: ξ̃
//! vanishes, as the paper takes from Cao and Ren. s vanishes by (6)–(7) and enters through its derivative alone: the degree
//! reduction of the paper.
//!
//! **Graphs that take turns** (our own derivation, for (110) without delay). Let L(t) be the Laplacian of the graph in force, in
//! which the leader reaches everybody at almost every t, D = sup|ξ̇_0|∞ < γ, s ≡ 0, and let x = max(0, max_i ξ̃_i) of an axis be
//! positive. At almost every t all those at the maximum have the same derivative, ẋ. The leader is not among them and reaches
//! them, so that one of them hears somebody lower: there e > 0, ς = 1, and ẋ ≤ −(γ − D). Likewise the minimum. So max|ξ̃_i| falls
//! at γ − D at least until it is zero, whatever the order and the length of the phases are, with weights of any size, equal or
//! not, and with a γ of its own for every agent if each exceeds D. With s ≠ 0 let y = ξ̃ − s, ẏ ∈ −L(y + s) − γ Sgn[L(y + s)] − ξ̇_0.
//! With a dwell time and weights that are uniformly continuous, bounded, and bounded away from zero, ẏ = −L y is exponentially
//! stable, so y is bounded, and s → 0 as in the paper. Were limsup|y| = δ > 0, pieces of y before times at which |y| is nearly δ
//! would, along a subsequence, converge uniformly to a motion with s = 0 over a limit of the graphs (phases no shorter than the dwell
//! time, again with the leader reaching everybody), that ends at δ and never exceeds it, though it falls at γ − D: a contradiction.
//!
//! It is not enough that the leader reaches everybody over windows. Let it rest at 0 and two agents be at ξ = 1; the leader is
//! heard by the first, then the first hears the second, then the second the first, in turns. The sign takes the first all the way
//! back to the second in a finite time, and nothing of the leader is left in it when it is heard: the second stays at 1 for ever
//! if its phase lasts 1/γ or longer. Without the sign both would come to rest at 0. And whoever is not heard from a leader that
//! moves drifts from it at |ξ̇_0| meanwhile.
//!
//! (119) and (122) jump in ξ* and ξ** where the graph switches: p holds what was integrated with the former weights, so that
//! (w⁻ − w⁺)(q̇_i − q̇_j) is added, and what grows so from far away no γ makes up for.
//!
//! **Links that delay** (our own derivation, for (110) on a fixed graph with constant weights). Let messages be up to T_ij old,
//! whatever the delays do below that. Relative to the leader, e_i = Σ_j w_ij (ξ̃_i − ξ̃_j(t − T) + δ_ij) with |δ_ij| ≤ D T_ij. Let
//! L c = D Σ_j w_ij T_ij, c ≥ 0 since L is a nonsingular M-matrix, and let r be the largest |ξ̃_j|/c_j over what is still under way.
//! Whoever has ξ̃_i > (r − η) c_i hears no more than r c_j of the others, so that
//!
//! ```text
//! e_i ≥ Σ_j w_ij [(r − η) c_i − r c_j − D T_ij] = (r − 1) (L c)_i − η d_i c_i > 0      for small η, if r > 1 and (L c)_i > 0
//! ```
//!
//! (where some (L c)_i is zero take a c a little larger) and falls at γ − D at least. So r comes down to 1: in the end
//! |ξ̃_i| ≤ c_i and |q_i − q_0| ≤ c_i/α, in proportion to the delays and to sup|ξ̇_0| whatever γ is; s only adds what vanishes with
//! it. Where the links from the leader alone delay, all by the same T, ξ_0(t − T) takes the place of the leader's, and is followed
//! exactly. Graphs that take turns besides leave no such c in general: with the leader at rest, and two agents of which one hears
//! the leader and the other one the first, in turns with a delay as long as a phase, each hears of the other what that had when it
//! did not hear the leader, and the motion in that phase repeats itself for ever.
//!
//! **Swarm tracking.** An undirected graph, a leader that some hear, and nothing but differences to neighbours: no agent uses
//! its own velocity or position by itself. Made differentiable by one differentiator,
//!
//! ```text
//! z̈_i = −k Σ_j w_ij (ξ*_i − ξ*_j) − γ ς_i,      ς_i ∈ Sgn[Σ_j w_ij (ξ**_i − ξ**_j)]
//! ```
//!
//! with ξ*, ξ** as above, realised like (122) without the terms of its own. Let s ≡ 0, so ξ* = ξ**, let κ₀ ≤ κ₁ be the roots of
//! p² + β p + α, q̃ = q − q_0, v = q̃' + κ₀ q̃ and y = v' + κ₁ v = ξ̃*. Then, with L = Lᵀ > 0 and a = β² − α > 0,
//!
//! ```text
//! ẏ = −k L y − γ ς − d³q_0 + β y − a v + κ₀³ q̃        v̇ = y − κ₁ v        q̃' = v − κ₀ q̃
//! V = ½ yᵀL y + ½ a vᵀL v + ½ a κ₀ κ₁ q̃ᵀL q̃
//! V̇ = −k |L y|² + β yᵀL y − a κ₁ vᵀL v − a κ₀² κ₁ q̃ᵀL q̃ + κ₀³ yᵀL q̃ + a κ₀ κ₁ q̃ᵀL v − γ |L y|₁ − (L y)ᵀ d³q_0
//! ```
//!
//! Here |L y|² ≥ λ yᵀL y with λ the smallest eigenvalue of L, a κ₀ κ₁ q̃ᵀL v ≤ ½ a κ₀² κ₁ q̃ᵀL q̃ + ½ a κ₁ vᵀL v, and what is left
//! is negative definite if k λ > β + κ₀⁴/(2 a κ₁) and γ > sup|d³q_0|∞: neither bound grows with how fast the leader moves, only
//! with how its acceleration changes. The leader is followed at an exponential rate. s enters through its derivative, as in
//! (122).
//!
//! Over graphs that take turns V changes with L, and the error can grow even with one weight for all links: four followers 1 to 4 with unit
//! weights, κ₀ = κ₁ = 1 and k = 12, above 10.94 which the slower graph asks for, and the graphs
//!
//! ```text
//! {1 – 2, 1 – 3, leader → 2, leader → 4}        {1 – 3, 1 – 4, 2 – 3, 3 – 4, leader → 1, leader → 3}
//! ```
//!
//! for 1.25 s each. With γ = 0, of which far away little is seen, what is left over two phases is multiplied by a matrix with the eigenvalue −1.4899. No k
//! makes up for it: with k = 10⁴ and 1.2 s each the largest eigenvalue still has the size 1.05.

use super::sliding::Sliding;
use super::{Exchange, Heard, Measured, PositionVelocity, Reference, ReferenceOut, begin, check};
use crate::{LengthError, Scalar};

/// (110). State: `[z, ς]`.
///
/// **Source**: (110), Theorem 8. **Measures**: q, q̇. **Transmits**: q, q̇.
/// **Requires**: a fixed graph without delay in which the leader reaches everybody; a common α; γ > sup|q̈_0 + α q̇_0|∞.
/// **Guarantees**: q_i − q_0 → 0 and q̇_i − q̇_0 → 0 under (6)–(7). By derivations of our own, at the head of this file, the same over
/// graphs that take turns if the leader reaches everybody in each, and on a fixed graph with delays a bound of what is left.
/// **Deviates from the paper**: the sign is set-valued, see [`Sliding`].
///
/// ```
/// use forwardstep_core::reference::{Choice, Derived, Following, Heard, Measured, Reference, ReferenceOut, Sliding};
///
/// let (alpha, gamma) = (1.5, 4.0);
/// let sign = Sliding { derived: Derived::Nothing, alpha, beta: 1.0, gamma, choice: Choice::Implicit };
/// let (q, dq, z, selection) = (0.3, -0.2, 0.5, 0.25);
/// let (w, q_j, dq_j) = (0.8, 1.0, 0.4);
/// let (mut dz, mut rate) = ([0.0], [0.0; 2]);
/// let out = ReferenceOut { z: &mut [0.0], dz: &mut dz, d_state: &mut rate };
/// let (degree, sums) = ([w], [w * q_j, w * dq_j]);
/// let heard = Heard::new(&degree, &sums, 1)?;
/// Following::new(1, sign).evaluate(1, Measured { q: &[q], dq: &[dq] }, &[z, selection], heard, out)?;
/// let xi = |q: f64, dq: f64| dq + alpha * q;
/// assert!((dz[0] - (-alpha * dq - w * (xi(q, dq) - xi(q_j, dq_j)) - gamma * selection)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Following {
    agents: usize,
    sliding: Sliding,
}

/// (119) and (122). State: `[z, p, ς]`.
///
/// **Source**: (119), Theorem 9; (122), Remark 12. **Measures**: q, q̇; for (119) q̈ too, inside the sign.
/// **Transmits**: q, q̇, and q̈ for (119), ż for (122).
/// **Requires**: a fixed graph without delay in which the leader reaches everybody; common α and β;
/// γ > sup|d³q_0 + β q̈_0 + α q̇_0|∞.
/// **Guarantees**: q_i − q_0 → 0 and q̇_i − q̇_0 → 0 under (6)–(7), with differentiable torques.
/// **Deviates from the paper**: (119) is integrated as in the head of this file; the sign is set-valued, see [`Sliding`].
///
/// ż has no sign in it, p has:
///
/// ```
/// use forwardstep_core::reference::{Choice, Derived, Heard, Measured, Reference, ReferenceOut, Sliding, SmoothFollowing};
///
/// let (alpha, beta, gamma) = (2.0, 3.0, 4.0);
/// let sign = Sliding { derived: Derived::ReferenceAcceleration, alpha, beta, gamma, choice: Choice::Implicit };
/// let (q, dq, z, p, selection) = (0.3, -0.2, 0.5, 0.1, 0.25);
/// let (w, q_j, dq_j) = (0.8, 1.0, 0.4);
/// let mut rate = [0.0; 3];
/// let out = ReferenceOut { z: &mut [0.0], dz: &mut [0.0], d_state: &mut rate };
/// let (degree, sums) = ([w], [w * q_j, w * dq_j]);
/// let heard = Heard::new(&degree, &sums, 1)?;
/// SmoothFollowing::new(1, sign).evaluate(1, Measured { q: &[q], dq: &[dq] }, &[z, p, selection], heard, out)?;
/// assert!((rate[0] - (-beta * dq - alpha * q - w * (dq - dq_j) + p)).abs() < 1e-12);
/// let xi = |q: f64, dq: f64| beta * dq + alpha * q;
/// assert!((rate[1] - (-w * (xi(q, dq) - xi(q_j, dq_j)) - gamma * selection)).abs() < 1e-12);
/// assert_eq!(rate[2], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SmoothFollowing {
    agents: usize,
    sliding: Sliding,
    /// 1 with the terms of its own, 0 for differences to neighbours only.
    own: f64,
    /// The factor of those differences.
    coupling: f64,
}

impl Following {
    /// For `agents` agents. [`Sliding::beta`] must be one and nothing derived, as (110) has it.
    pub fn new(agents: usize, sliding: Sliding) -> Self {
        Following { agents, sliding }
    }
}

impl SmoothFollowing {
    /// For `agents` agents; (119) or (122) by what ξ contains.
    pub fn new(agents: usize, sliding: Sliding) -> Self {
        SmoothFollowing { agents, sliding, own: 1.0, coupling: 1.0 }
    }

    /// Swarm tracking with k = `coupling`; ξ contains ż.
    ///
    /// **Source**: our own derivation, at the head of this file; Remark 11 names the problem.
    /// **Measures**: q, q̇. **Transmits**: q, q̇, ż.
    /// **Requires**: a fixed undirected graph without delay in which the leader reaches everybody; real roots κ₀ ≤ κ₁;
    /// k λ > β + κ₀⁴/(2 (β² − α) κ₁); γ > sup|d³q_0|∞.
    /// **Guarantees**: q_i − q_0 → 0 and q̇_i − q̇_0 → 0 under (6)–(7), with differentiable torques.
    pub fn swarm(agents: usize, sliding: Sliding, coupling: f64) -> Self {
        SmoothFollowing { agents, sliding, own: 0.0, coupling }
    }
}

impl Reference for Following {
    type Exchange = PositionVelocity;

    fn agents(&self) -> usize {
        self.agents
    }

    fn vectors(&self) -> usize {
        2
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
        heard: Heard<'_, PositionVelocity>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        check([axes, self.agents, 2], measured, state, heard, &out)?;
        let block = axes * self.agents;
        let (z, selection) = state.split_at(block);
        let [alpha, gamma] = [self.sliding.alpha, self.sliding.gamma];
        for k in 0..block {
            let (q, dq, d) = (measured.q[k], measured.dq[k], heard.degree[k % self.agents]);
            // −(α + d) q̇ − d α q + Σ w (q̇_j + α q_j) − γ ς
            let received = alpha.mul_add(heard.sums.q[k], heard.sums.dq[k]);
            let own = (alpha + d).neg_mul_add(dq, (d * alpha).neg_mul_add(q, received));
            let dz = gamma.neg_mul_add(selection[k], own);
            out.z[k] = z[k];
            out.dz[k] = dz;
            out.d_state[k] = dz;
            out.d_state[block + k] = 0.0;
        }
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        _: Measured<'_>,
        given: &[f64],
        _: Heard<'_, PositionVelocity>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let block = axes * self.agents;
        begin([block, 2 * block], given, state)
    }
}

impl Reference for SmoothFollowing {
    type Exchange = PositionVelocity;

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
        heard: Heard<'_, PositionVelocity>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        check([axes, self.agents, 3], measured, state, heard, &out)?;
        let block = axes * self.agents;
        let (z, rest) = state.split_at(block);
        let (p, selection) = rest.split_at(block);
        let [alpha, beta, gamma] = [self.sliding.alpha, self.sliding.beta, self.sliding.gamma];
        let [by_itself, coupling] = [self.own, self.coupling];
        for k in 0..block {
            let (q, dq, d) = (measured.q[k], measured.dq[k], heard.degree[k % self.agents]);
            let own = alpha.mul_add(q, beta * dq);
            let received = alpha.mul_add(heard.sums.q[k], beta * heard.sums.dq[k]);
            // ż and ṗ without what is left out of them, or scaled, for a swarm.
            let apart = d.neg_mul_add(dq, heard.sums.dq[k]);
            let dz = coupling.mul_add(apart, p[k]) - by_itself * own;
            out.z[k] = z[k];
            out.dz[k] = dz;
            out.d_state[k] = dz;
            out.d_state[block + k] = gamma.neg_mul_add(selection[k], coupling * d.neg_mul_add(own, received));
            out.d_state[2 * block + k] = 0.0;
        }
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, PositionVelocity>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let block = axes * self.agents;
        LengthError::check("start of the reference", 3 * block, given.len())?;
        LengthError::check("reference state", 3 * block, state.len())?;
        LengthError::check("q", block, measured.q.len())?;
        LengthError::check("dq", block, measured.dq.len())?;
        LengthError::check("degree", self.agents, heard.degree.len())?;
        PositionVelocity::check(heard.sums, block)?;
        state[..block].copy_from_slice(&given[..block]);
        for k in 0..block {
            let (q, dq, d) = (measured.q[k], measured.dq[k], heard.degree[k % self.agents]);
            let own = self.sliding.beta * dq + self.sliding.alpha * q;
            // c**: what makes ż(0) as wanted.
            state[block + k] = given[block + k] + self.own * own + self.coupling * (d * dq - heard.sums.dq[k]);
        }
        state[2 * block..].fill(0.0);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::sliding::{Choice, Derived};
    use super::super::{PositionVelocitySums, ReferenceOut};
    use super::*;

    const ALPHA: f64 = 1.3;
    const BETA: f64 = 0.6;
    const GAMMA: f64 = 2.5;
    const W: f64 = 1.5;

    fn sliding(derived: Derived, beta: f64) -> Sliding {
        Sliding { derived, alpha: ALPHA, beta, gamma: GAMMA, choice: Choice::Implicit }
    }

    /// z, ż and the rate of the state of one agent with one axis.
    fn evaluate<const N: usize>(
        law: &impl Reference<Exchange = PositionVelocity>,
        own: [f64; 2],
        state: [f64; N],
        sums: [f64; 2],
        degree: f64,
    ) -> (f64, [f64; N]) {
        let (mut z, mut dz, mut rate) = ([0.0], [0.0], [0.0; N]);
        let heard =
            Heard { degree: &[degree], sums: PositionVelocitySums { q: &[sums[0]], dq: &[sums[1]] }, time_s: 0.0 };
        let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
        law.evaluate(1, Measured { q: &[own[0]], dq: &[own[1]] }, &state, heard, out).unwrap();
        assert_eq!(z[0], state[0]);
        (dz[0], rate)
    }

    #[test]
    fn eq_110_is_its_literal_form() {
        let law = Following::new(1, sliding(Derived::Nothing, 1.0));
        let ([q, dq], [q_j, dq_j], selection) = ([0.3, -0.7], [0.8, -0.2], 0.4);
        let (dz, rate) = evaluate(&law, [q, dq], [0.9, selection], [W * q_j, W * dq_j], W);
        let (xi, xi_j) = (dq + ALPHA * q, dq_j + ALPHA * q_j);
        assert!((dz - (-ALPHA * dq - W * (xi - xi_j) - GAMMA * selection)).abs() < 1e-14);
        assert_eq!(rate, [dz, 0.0]);
    }

    /// ż is linear, so its derivative is the same function of the derivatives of what enters it.
    #[test]
    fn eq_119_and_eq_122_are_the_derivative_of_what_is_realised() {
        let law = SmoothFollowing::new(1, sliding(Derived::Acceleration, BETA));
        let ([q, dq, ddq], [q_j, dq_j, ddq_j], selection) = ([0.3, -0.7, 1.9], [0.8, -0.2, 0.5], 0.4);
        let (dz, rate) = evaluate(&law, [q, dq], [0.9, -1.1, selection], [W * q_j, W * dq_j], W);
        assert_eq!((rate[0], rate[2]), (dz, 0.0));
        let (ddz, _) = evaluate(&law, [dq, ddq], [0.0, rate[1], 0.0], [W * dq_j, W * ddq_j], W);
        let (xi, xi_j) = (ddq + BETA * dq + ALPHA * q, ddq_j + BETA * dq_j + ALPHA * q_j);
        let literal = -BETA * ddq - ALPHA * dq - W * (xi - xi_j) - GAMMA * selection;
        assert!((ddz - literal).abs() < 1e-13, "{ddz} {literal}");
    }

    #[test]
    fn eq_swarm_has_differences_only() {
        let law = SmoothFollowing::swarm(1, sliding(Derived::ReferenceAcceleration, BETA), 3.0);
        let ([q, dq, ddq], [q_j, dq_j, ddq_j], selection) = ([0.3, -0.7, 1.9], [0.8, -0.2, 0.5], 0.4);
        let (_, rate) = evaluate(&law, [q, dq], [0.9, -1.1, selection], [W * q_j, W * dq_j], W);
        let (ddz, _) = evaluate(&law, [dq, ddq], [0.0, rate[1], 0.0], [W * dq_j, W * ddq_j], W);
        let (xi, xi_j) = (ddq + BETA * dq + ALPHA * q, ddq_j + BETA * dq_j + ALPHA * q_j);
        assert!((ddz - (-3.0 * W * (xi - xi_j) - GAMMA * selection)).abs() < 1e-13, "{ddz}");
    }

    #[test]
    fn the_start_gives_the_wanted_reference_acceleration() {
        let law = SmoothFollowing::new(1, sliding(Derived::ReferenceAcceleration, BETA));
        let (q, dq, z, dz) = (0.3, -0.7, 0.4, 2.5);
        let mut state = [0.0; 3];
        let heard = Heard { degree: &[W], sums: PositionVelocitySums { q: &[0.2], dq: &[-0.9] }, time_s: 0.0 };
        law.start(1, Measured { q: &[q], dq: &[dq] }, &[z, dz, 0.0], heard, &mut state).unwrap();
        let (got, _) = evaluate(&law, [q, dq], state, [0.2, -0.9], W);
        assert!((got - dz).abs() < 1e-14 && state[0] == z);
    }
}

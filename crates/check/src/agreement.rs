//! The value agreed upon, known before the run.
//!
//! Let Xᵢ = Σ_{r≤ℓ} αᵣ xᵣ be agent i's own part of the family (x₀ = q, x₁ = q̇, xᵣ = z^(r−1)) and α₀ = αᵢ,₀. Along every
//! run, whatever the torque,
//!
//! ```text
//! Bᵢ = Xᵢ − α₁ sᵢ          Ḃᵢ = − Σⱼ w_ij [ Xᵢ − α₀ q_j(t−T_ij) − (α₀/κ₀) q̇_j(t−T_ij) ]
//! Wᵢ = α₁ qᵢ + Σ_{r≥2} αᵣ z^(r−2)                Ẇᵢ = Xᵢ − α₀ qᵢ
//! ```
//!
//! (the last term only when velocities are sent). With a fixed graph, constant delays and u the left null vector of the
//! Laplacian, Σᵢ uᵢ Σⱼ w_ij (qᵢ − q_j) = 0, and q_j − q_j(t−T) is the derivative of ∫_{t−T}^t q_j. Hence
//!
//! ```text
//! Q = Σᵢ uᵢ [ (Bᵢ + dᵢ Wᵢ)/α₀ + Σⱼ w_ij ( ∫_{t−T_ij}^t q_j dσ − R_j(t−T_ij)/κ₀ ) ],        dᵢ = Σⱼ w_ij
//! ```
//!
//! is conserved, where R_j = q_j for t ≥ 0 and q_j(0) + t q̇_j(0) before: the velocities sent before t = 0 are q̇_j(0), not
//! zero. When everybody has come to rest at c, Q = c Σᵢ uᵢ [1 + dᵢ α₁/α₀ + Σⱼ w_ij (T_ij − 1/κ₀)].
//!
//! (3) and (23) have q̈ in the place of ż: with Bᵢ = żᵢ + α₁ q̇ᵢ + α₀ qᵢ and Wᵢ = q̇ᵢ + α₁ qᵢ the same Q is conserved.
//!
//! With λ > 0 (Remark 4) Ḃᵢ gains λ sᵢ, so Q moves by Σᵢ uᵢ (λᵢ/α₀) ∫ sᵢ dt: in general only the run knows by how much, see
//! `manipulation` for where it is known before. With λ = 0 no push moves Q, since no torque enters Bᵢ and Wᵢ.
//! A push that never ends leaves sᵢ = K⁻¹τ_ext and zᵢ = −sᵢ, and where z is in Bᵢ and Wᵢ the network then rests elsewhere.

use forwardstep_core::reference::polynomial;
use forwardstep_sim::graph::{Edge, SpanningTree, laplacian, spanning_tree};
use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral};
use forwardstep_sim::{AgentSetup, Exchange, Setup};
use nalgebra::DMatrix;
use thiserror::Error;

use crate::kinds::is_lagrangian;
use crate::manipulation::error_integral;

/// The value that all agents will agree on.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// c, one entry per axis.
    pub value: Vec<f64>,
    /// How much each agent's initial data counts: the left null vector of the Laplacian, summing to one.
    pub influence: Vec<f64>,
}

/// Why the value agreed upon cannot be known before the run.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoPrediction {
    /// The graph changes.
    #[error("the graph switches")]
    Switching,
    /// A delay changes.
    #[error("a delay varies with time")]
    VaryingDelay,
    /// A weight changes.
    #[error("a weight varies with time")]
    VaryingWeight,
    /// The value depends on the tracking errors.
    #[error("the manipulability gain of agent number {} lets tracking errors move it", agent + 1)]
    Manipulability {
        /// Index of the agent.
        agent: usize,
    },
    /// Its tracking error does not vanish, and takes part in what is conserved.
    #[error("agent number {} is pushed for ever", agent + 1)]
    PushedForEver {
        /// Index of the agent.
        agent: usize,
    },
    /// A nonlinear coupling conserves nothing over a delay.
    #[error("the coupling is nonlinear")]
    Coupling,
    /// Held inputs conserve the quantity only in the limit of short periods.
    #[error("the controllers sample")]
    Sampled,
    /// Agents follow targets of their own, or a law whose tracking error stays in what is conserved.
    #[error("only agents under the adaptive or the known law that agree with each other have one")]
    Law,
    /// They follow a leader, who moves.
    #[error("everybody follows a leader")]
    Leader,
    /// The baseline conserves nothing.
    #[error("under backstepping tracking errors move it")]
    Backstepping,
    /// Reference dynamics from outside: nothing is known of what they conserve.
    #[error("the reference dynamics are not among those that come with forwardstep")]
    Own,
    /// There is no single value.
    #[error("no agent reaches all others, so nothing makes them agree")]
    NoSpanningTree,
    /// A root is not positive.
    #[error("the reference dynamics of agent number {} are not stable", agent + 1)]
    Roots {
        /// Index of the agent.
        agent: usize,
    },
    /// The arithmetic failed.
    #[error("the left null vector of the Laplacian could not be computed")]
    NullVector,
}

/// Predicts the value agreed upon for a fixed graph with constant delays.
///
/// **Guarantees**: if the agents of such a network come to rest in agreement, as Theorems 2 and 3 promise, it is at this
/// value, whatever the robots, the gains, the adaptation, the torques and whoever pushes for a while. With λ > 0 a value is given where
/// tracking errors are known before the run: for known parameters and as long as no external torque acts, and for pushed point masses
/// with known parameters.
///
/// # Errors
/// [`NoPrediction`] says why there is none.
pub fn predict(setup: &Setup) -> Result<Prediction, NoPrediction> {
    if setup.reference.is::<Backstepping>() {
        return Err(NoPrediction::Backstepping);
    }
    if setup.following().is_some() {
        return Err(NoPrediction::Leader);
    }
    if setup.all_track() || setup.agents.iter().any(|agent| !is_lagrangian(agent)) {
        return Err(NoPrediction::Law);
    }
    if !(setup.reference.is::<Consensus>() || setup.reference.is::<PureIntegral>()) {
        return Err(NoPrediction::Own);
    }
    if !setup.network.coupling.is_linear() {
        return Err(NoPrediction::Coupling);
    }
    if setup.control.is_some() {
        return Err(NoPrediction::Sampled);
    }
    let edges = setup.network.schedule.constant_graph().ok_or(NoPrediction::Switching)?;
    if !edges.iter().all(|edge| setup.network.delays[edge.delay].is_constant()) {
        return Err(NoPrediction::VaryingDelay);
    }
    let n = setup.agents.len();
    let l = laplacian(n, edges).ok_or(NoPrediction::VaryingWeight)?;
    let influence = left_null_vector(n, edges, &l)?;
    // (3) and (23) hold no z in what they conserve.
    let counts = |agent: &usize| setup.reference.is::<Consensus>() && influence[*agent] > 0.0;
    if let Some(agent) = (0..n).filter(counts).find(|agent| pushed_for_ever(&setup.agents[*agent])) {
        return Err(NoPrediction::PushedForEver { agent });
    }
    let alpha: Vec<Vec<f64>> = setup
        .agents
        .iter()
        .enumerate()
        .map(|(agent, a)| polynomial(&a.roots_per_s).map_err(|_| NoPrediction::Roots { agent }))
        .collect::<Result<_, _>>()?;
    let axes = setup.agents[0].start.q.len();
    let value = (0..axes)
        .map(|axis| {
            let (mut quantity, mut weight) = (0.0, 0.0);
            for i in 0..n {
                let (share, at_rest) = contribution(setup, edges, &alpha[i], i, axis);
                quantity += influence[i] * (share + shift(setup, &alpha[i], i, axis, influence[i])?);
                weight += influence[i] * at_rest;
            }
            Ok(quantity / weight)
        })
        .collect::<Result<_, _>>()?;
    Ok(Prediction { value, influence })
}

/// Whether something acts on the agent without end.
fn pushed_for_ever(agent: &AgentSetup) -> bool {
    agent.pushes.iter().any(|push| push.span_s()[1] == f64::INFINITY)
}

/// u ≥ 0 with uᵀL = 0 and Σu = 1. Only the agents that reach all others count.
fn left_null_vector(n: usize, edges: &[Edge], l: &[f64]) -> Result<Vec<f64>, NoPrediction> {
    let SpanningTree::Rooted { roots } = spanning_tree(n, edges) else { return Err(NoPrediction::NoSpanningTree) };
    // Lᵀu = 0 on the roots, with its last equation, which the others imply, replaced by Σu = 1.
    let m = roots.len();
    let entry = |row: usize, column: usize| {
        if row + 1 == m { 1.0 } else { l[roots[column] * n + roots[row]] }
    };
    let mut right = nalgebra::DVector::zeros(m);
    right[m - 1] = 1.0;
    let solution = DMatrix::from_fn(m, m, entry).lu().solve(&right).ok_or(NoPrediction::NullVector)?;
    let mut influence = vec![0.0; n];
    for (root, share) in roots.iter().zip(solution.iter()) {
        influence[*root] = *share;
    }
    Ok(influence)
}

/// Agent i's term of Q at t = 0, and what it is per unit of c at rest.
fn contribution(setup: &Setup, edges: &[Edge], alpha: &[f64], i: usize, axis: usize) -> (f64, f64) {
    let start = &setup.agents[i].start;
    let z = |k: usize| reference_start(&setup.agents[i], k, axis);
    let (q, dq) = (start.q[axis], start.dq[axis]);
    let (b, w) = if setup.reference.is::<PureIntegral>() {
        (alpha[0] * q + alpha[1] * dq + z(1), alpha[1] * q + dq)
    } else {
        let above = || alpha.iter().enumerate().skip(2);
        let b = alpha[0] * q + alpha[1] * dq - alpha[1] * (dq - z(0));
        (
            b + above().map(|(r, a)| a * z(r - 1)).sum::<f64>(),
            alpha[1] * q + above().map(|(r, a)| a * z(r - 2)).sum::<f64>(),
        )
    };
    let kappa_0 = setup.agents[i].roots_per_s[0];
    let velocity = if setup.exchange == Exchange::PositionVelocity { 1.0 / kappa_0 } else { 0.0 };
    let (mut degree, mut past, mut past_at_rest) = (0.0, 0.0, 0.0);
    let weighted = edges.iter().filter(|edge| edge.to == i).filter_map(|edge| Some((edge, edge.weight.constant()?)));
    for (edge, weight) in weighted {
        let delay_s = setup.network.delays[edge.delay].max_s();
        let sender = &setup.agents[edge.from].start;
        let ramp = sender.q[axis] - delay_s * sender.dq[axis];
        degree += weight;
        past += weight * (delay_s * sender.q[axis] - velocity * ramp);
        past_at_rest += weight * (delay_s - velocity);
    }
    ((b + degree * w) / alpha[0] + past, 1.0 + degree * alpha[1] / alpha[0] + past_at_rest)
}

/// What Remark 4 adds to agent i's term of Q in the course of time.
fn shift(setup: &Setup, alpha: &[f64], i: usize, axis: usize, influence: f64) -> Result<f64, NoPrediction> {
    let agent = &setup.agents[i];
    if agent.manipulability == 0.0 || influence == 0.0 {
        return Ok(0.0);
    }
    let integral = error_integral(agent, axis, reference_start(agent, 0, axis));
    integral.map(|s| agent.manipulability / alpha[0] * s).ok_or(NoPrediction::Manipulability { agent: i })
}

/// z^(k)(0), with the defaults of [`forwardstep_sim::Start`].
fn reference_start(agent: &AgentSetup, k: usize, axis: usize) -> f64 {
    match agent.start.reference.get(k) {
        Some(z) => z[axis],
        None if k == 0 => agent.start.dq[axis],
        None => 0.0,
    }
}

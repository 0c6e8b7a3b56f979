//! Manipulability (Remark 4): the transfer from an external torque to the value agreed upon.
//!
//! For a fixed graph with constant delays, at rest where all agree without s, and to first order in the push. Let α_r be the coefficients of agent
//! i's polynomial A_i = Σ_r α_r pʳ, d_i = Σⱼ w_ij, v = 1 when velocities are sent, else 0. With z = p q − s the parts of the family
//! (`agreement`) are x₀ = q, x₁ = p q and x_r = pʳ q − p^(r−1) s for r ≥ 2, so that X_i = A_i q_i − S_i s_i with
//! S_i = Σ_{r≥2} α_r p^(r−1), and p (X_i − α₁ s_i) = −Σⱼ w_ij [X_i − (α₀ + v α₀ p/κ₀) e^(−p T_ij) q_j] + λ_i s_i becomes
//!
//! ```text
//! Δ(p) q = diag(N_i/α₀) s       Δ_ii = (p + d_i) A_i/α₀          Δ_ij = −w_ij (1 + v p/κ₀) e^(−p T_ij)
//! N_i = λ_i + Σ_{r=1}^ℓ (α_r + d_i α_{r+1}) pʳ                     (a5), (24), (aa10), (a1); α_{ℓ+1} = 0
//! N_i = λ_i + p²                                                  (31), and (3) and (23) with λ = 0
//! s_i = (M p + K + D)⁻¹ τ_i                                       known parameters
//! s_i = (M p + K + D + Y Γ Yᵀ/p)⁻¹ τ_i = R τ_i + S p τ_i + O(p²)    adapted ones, Y = Y(q, 0, 0, 0)
//! ```
//!
//! the last from M ṡ + (K + D) s = τ + Y Δϑ, Δϑ̇ = −Γ Yᵀ s. Without delays all of it is rational in p; a delay adds its exponential.
//! Zero is a simple root of Δ with the left null vector u of the Laplacian, so Δ⁻¹ = 1 uᵀ/(ν p) + O(1) where ν = uᵀ Δ'(0) 1, and the value
//! agreed upon is
//!
//! ```text
//! uᵀ q = u_i/(ν α₀) · N_i s_i/p + …                        for a push on agent i
//! known:  λ > 0   u_i λ_i/(ν α₀) (K + D)⁻¹ τ / p           degree one: an impulse displaces it, a constant torque lets it drift
//!         λ = 0   u_i (α₁ + d_i α₂)/(ν α₀) (K + D)⁻¹ τ     degree zero: an impulse leaves nothing, a constant torque displaces it
//!         λ = 0 under (3), (23)                            degree −1: neither leaves anything
//! ```
//!
//! With P = Y Γ Yᵀ, N a basis of its kernel and P⁺ its pseudoinverse, R = N (Nᵀ (K + D) N)⁻¹ Nᵀ, and S = P⁺ on an axis where R is zero, by
//! the Schur complement. Where gravity columns make P definite R is zero: the adaptation
//! integrates s away and the degree falls by one, so that with λ > 0 an impulse leaves nothing either.
//!
//! The paper states (31) and says what it is for; degree and gain are derived for this software.

mod measured;
mod response;

pub use measured::{Measured, NotMeasured, Trial, measure};

use forwardstep_core::reference::polynomial;
use forwardstep_sim::reference::PureIntegral;
use forwardstep_sim::{Adaptive, Setup, Start, check_shape};
use nalgebra::DMatrix;
use thiserror::Error;

use self::response::Response;
use crate::agreement::predict;
use crate::fixed::fixed;
use crate::instance::designed;
use crate::null_vector::null_vector;
use crate::prediction::roots::characteristic::{C, Characteristic};
use crate::prediction::roots::network;
use crate::prediction::{NoIdeal, NoRate, ideal, rate};
use crate::surroundings::dry_loss_w;

/// The transfer from a torque on one axis of one agent to the value agreed upon on this axis, with every agent at rest where all agree.
#[derive(Debug)]
pub struct Manipulability {
    system: Characteristic,
    influence: Vec<f64>,
    agent: usize,
    axis: usize,
    /// N/α₀ of the agent, from p⁰ on.
    numerator: Vec<f64>,
    response: Response,
    posture: Vec<f64>,
}

/// What is left of the transfer as p → 0: `gain` p^(−`degree`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowFrequency {
    /// How many poles it has at the origin; zeros count as negative. |G(jω)| has the slope −20 dB times this per decade.
    pub degree: i32,
    /// In (rad or m) s^(−degree) per N m or N.
    pub gain: f64,
}

impl LowFrequency {
    /// By how much a push of impulse one displaces the value agreed upon, (rad or m)/(N m s or N s); so fast a constant torque of one
    /// lets it drift.
    pub fn by_impulse(&self) -> f64 {
        if self.degree == 1 { self.gain } else { 0.0 }
    }

    /// By how much a constant torque of one displaces it, (rad or m)/(N m or N); infinite where it drifts.
    pub fn by_constant(&self) -> f64 {
        match self.degree {
            1 => f64::INFINITY,
            0 => self.gain,
            _ => 0.0,
        }
    }
}

/// Why there is no such transfer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoManipulability {
    /// The references depend on more than the network.
    #[error(transparent)]
    Ideal(#[from] NoIdeal),
    /// The network is not one with a transfer.
    #[error(transparent)]
    Network(#[from] NoRate),
    /// Held inputs have another one.
    #[error("the controllers sample, and the transfer is that of continuous control; leave `control` out")]
    Sampled,
    /// A joint that sticks does not move at all.
    #[error(
        "the joints of agent number {} have dry friction and stick at rest, so that no transfer describes them; `friction.smooth` has one",
        agent + 1
    )]
    DryFriction {
        /// Index of the agent.
        agent: usize,
    },
    /// There is no such axis.
    #[error("there is no axis {} of agent number {}", axis + 1, agent + 1)]
    NoSuchAxis {
        /// Index of the agent.
        agent: usize,
        /// Index of the axis.
        axis: usize,
    },
    /// Nothing linear is known of it.
    #[error("agent number {} is not under (6)-(7) with gains that can be resolved at its start", agent + 1)]
    Law {
        /// Index of the agent.
        agent: usize,
    },
    /// The others do not follow it.
    #[error("agent number {} does not reach all others, so that no push on it moves what they agree on; push another", agent + 1)]
    NoInfluence {
        /// Index of the agent.
        agent: usize,
    },
}

impl Manipulability {
    /// For a torque on one axis of one agent.
    ///
    /// # Errors
    /// [`NoManipulability`] says why there is none.
    pub fn of(setup: &Setup, agent: usize, axis: usize) -> Result<Manipulability, NoManipulability> {
        check_shape(setup).map_err(|error| NoIdeal::from(Box::new(error)))?;
        let designed = designed(setup);
        let setup = designed.as_ref().unwrap_or(setup);
        let own = setup.agents.get(agent).filter(|own| axis < own.robot.axes.len());
        let own = own.ok_or(NoManipulability::NoSuchAxis { agent, axis })?;
        if setup.control.is_some() {
            return Err(NoManipulability::Sampled);
        }
        if let Some(agent) = setup.agents.iter().position(|agent| dry_loss_w(agent).is_some()) {
            return Err(NoManipulability::DryFriction { agent });
        }
        let system = network(&ideal(setup)?)?;
        let influence = influence(setup)?;
        if influence[agent] <= 0.0 {
            return Err(NoManipulability::NoInfluence { agent });
        }
        let rest = at_agreement(setup, agent);
        let at_rest = &rest.agents[agent];
        let response = Response::at_rest(at_rest).ok_or(NoManipulability::Law { agent })?;
        if setup.agents.iter().any(|agent| agent.roots_per_s.all_real().is_none()) {
            // With real roots everything comes to rest again; with others only where no characteristic root says otherwise.
            rate(setup)?;
        }
        let alpha_0 = polynomial(&own.roots_per_s).map_err(|_| NoRate::Unclear)?[0];
        let (a, degree) = (&system.coefficients[agent], system.degree[agent]);
        let mut numerator: Vec<f64> = if setup.reference.is::<PureIntegral>() {
            vec![0.0, 0.0, 1.0 / alpha_0]
        } else {
            a.iter().enumerate().map(|(r, own)| own + degree * a.get(r + 1).unwrap_or(&0.0)).collect()
        };
        numerator[0] = own.manipulability / alpha_0;
        Ok(Manipulability { system, influence, agent, axis, numerator, response, posture: at_rest.start.q.clone() })
    }

    /// Where the agent that is pushed stands, axis by axis.
    pub fn posture(&self) -> &[f64] {
        &self.posture
    }

    /// How much each agent counts in the value agreed upon: the left null vector of the Laplacian, summing to one.
    pub fn influence(&self) -> &[f64] {
        &self.influence
    }

    /// Degree and gain.
    pub fn low_frequency(&self) -> LowFrequency {
        let s = self.response.series(self.axis);
        // N s = Σ_k pᵏ Σ_r N_r s_{k−r}; the terms before the first that does not vanish determine that one.
        let term = |k: usize| -> f64 {
            s.iter()
                .enumerate()
                .filter(|(r, _)| *r <= k)
                .map(|(r, s)| s * self.numerator.get(k - r).unwrap_or(&0.0))
                .sum()
        };
        let first = (0..4).find(|k| term(*k) != 0.0).unwrap_or(3);
        let gain = self.influence[self.agent] / self.slope() * term(first);
        LowFrequency { degree: 1 - first as i32, gain }
    }

    /// uᵀ q per torque at one p, real and imaginary part; `None` at a pole.
    pub fn at(&self, p: [f64; 2]) -> Option<[f64; 2]> {
        let p = C::new(p[0], p[1]);
        let s = self.response.at(p, self.axis)?;
        let numerator = self.numerator.iter().rev().fold(C::from(0.0), |sum, c| sum * p + c);
        let [delta, _] = self.system.matrix(p);
        let mut q = DMatrix::from_element(self.influence.len(), 1, C::from(0.0));
        q[(self.agent, 0)] = numerator * s;
        let q = delta.lu().solve(&q)?;
        let agreed = q.iter().zip(&self.influence).fold(C::from(0.0), |sum, (q, u)| sum + q * *u);
        (agreed.re.is_finite() && agreed.im.is_finite()).then_some([agreed.re, agreed.im])
    }

    /// ν.
    fn slope(&self) -> f64 {
        let [_, slope] = self.system.matrix(C::from(0.0));
        slope.row_iter().zip(&self.influence).map(|(row, u)| u * row.iter().map(|entry| entry.re).sum::<f64>()).sum()
    }
}

/// Everybody at rest where all agree without s, with estimates that are right and nothing that pushes. Where that place is not known, it is
/// where the agent that is pushed starts.
fn at_agreement(setup: &Setup, agent: usize) -> Setup {
    let without_s = ideal(setup).ok().and_then(|mut alike| {
        alike.agents.iter_mut().for_each(|own| own.manipulability = 0.0);
        Some(predict(&alike).ok()?.value)
    });
    let agreed = without_s.unwrap_or_else(|| setup.agents[agent].start.q.clone());
    let mut rest = setup.clone();
    for own in &mut rest.agents {
        let theta = own.robot.theta.clone();
        own.change_law(|law: &mut Adaptive| law.estimate_start = theta);
        own.start = Start { dq: vec![0.0; agreed.len()], q: agreed.clone(), rest: Vec::new(), reference: Vec::new() };
        own.enforce_limits = false;
        own.pushes.clear();
    }
    rest
}

/// The left null vector of the Laplacian of a graph that stays.
fn influence(setup: &Setup) -> Result<Vec<f64>, NoRate> {
    let (edges, _) = fixed(&setup.network)?;
    let found = null_vector(setup.agents.len(), edges).map_err(|_| NoRate::NoSpanningTree)?;
    if found.entries.iter().all(|u| u.is_finite()) { Ok(found.entries) } else { Err(NoRate::Unclear) }
}

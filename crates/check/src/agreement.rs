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
//! A chain of order k has α_{k−1} and s = x_{k−1} − z in the place of α₁ and s. A vehicle has x̃ = x − d in the place of q, and under (46), where
//! it is itself the chain, Bᵢ = Xᵢ. There a force f moves Q by Σᵢ uᵢ (α₁ + dᵢ)/α₀ ∫ f/m dt: the law takes ρ = ẍ − f/m for the acceleration, so
//! that with ρ in Xᵢ and Wᵢ Ḃᵢ gains α₁ f/m and Ẇᵢ gains f/m.
//!
//! (3) and (23) have q̈ in the place of ż: with Bᵢ = żᵢ + α₁ q̇ᵢ + α₀ qᵢ and Wᵢ = q̇ᵢ + α₁ qᵢ the same Q is conserved.
//!
//! With λ > 0 (Remark 4) Ḃᵢ gains λ sᵢ, so Q moves by Σᵢ uᵢ (λᵢ/α₀) ∫ sᵢ dt: in general only the run knows by how much, see
//! `manipulation` for where it is known before. With λ = 0 no push moves Q, since no torque enters Bᵢ and Wᵢ.
//! A push that never ends leaves sᵢ = K⁻¹τ_ext and zᵢ = −sᵢ, and where z is in Bᵢ and Wᵢ the network then rests elsewhere. So does dry
//! friction, which may hold a joint while z is not zero.

use forwardstep_core::reference::polynomial;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral};
use forwardstep_sim::{AgentSetup, ChainLaw, ChainModel, Setup, ThrustLaw, VehicleModel, check_shape};
use thiserror::Error;

use crate::conserved::Conserved;
use crate::fixed::{NotFixed, fixed};
use crate::instance::{designed, is_consensus};
use crate::kinds::{is_its_own_reference, is_lagrangian};
use crate::null_vector::{NoNullVector, NullVector, null_vector};
use crate::prediction::{NoIdeal, family_start};
use crate::surroundings::{dry_loss_w, endless};

/// The value that all agents will agree on.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// c, one entry per axis.
    pub value: Vec<f64>,
    /// How far rounding, of the decimals of the data and of what is computed from them, can have moved each entry of `value`;
    /// that of ∫ s of Remark 4 does not count.
    pub error_bound: Vec<f64>,
    /// How much each agent's initial data counts: the left null vector of the Laplacian, summing to one. Zero for agents that
    /// do not reach all others, and for what is below the range of numbers.
    pub influence: Vec<f64>,
    /// Bound on the relative error of every entry of `influence`.
    pub influence_error: f64,
}

impl Prediction {
    /// The value on every axis, to six places after the point at most, or three digits of the largest where all are small, and no more than
    /// are known.
    pub fn known_digits(&self) -> Vec<String> {
        let largest = self.value.iter().map(|value| libm::fabs(*value)).fold(0.0, f64::max);
        let most = if largest > 0.0 { (2.0 - libm::floor(libm::log10(largest))).clamp(6.0, 300.0) as usize } else { 6 };
        let each = self.value.iter().zip(&self.error_bound);
        each.map(|(value, error_bound)| known_digits(*value, *error_bound, most)).collect()
    }
}

fn known_digits(value: f64, error_bound: f64, most: usize) -> String {
    match (0..=most).rev().find(|places| error_bound * libm::pow(10.0, *places as f64) <= 0.5) {
        Some(digits) => {
            // What rounds to zero has no sign.
            let text = format!("{value:.digits$}");
            if text.bytes().any(|digit| (b'1'..=b'9').contains(&digit)) {
                text.replace('-', "−")
            } else {
                text.replace('-', "")
            }
        }
        None => format!("{value:.0} ± {error_bound:.0e}"),
    }
}

/// Why the value agreed upon cannot be known before the run.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoPrediction {
    /// The network changes, or is not linear: a nonlinear coupling conserves nothing over a delay.
    #[error(transparent)]
    NotFixed(#[from] NotFixed),
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
    /// Its tracking error need not vanish either.
    #[error("the joints of agent number {} have dry friction, which keeps its tracking error from vanishing", agent + 1)]
    DryFriction {
        /// Index of the agent.
        agent: usize,
    },
    /// Held inputs conserve the quantity only in the limit of short periods.
    #[error("the controllers sample")]
    Sampled,
    /// They do not agree with each other.
    #[error("agents follow targets of their own")]
    Targets,
    /// A law whose tracking error stays in what is conserved.
    #[error(
        "only robots under the adaptive or the known law, vehicles, and chains of derivatives of order two or more have one"
    )]
    Law,
    /// Its start does not fit, or it keeps an offset that its law does not know.
    #[error(transparent)]
    Start(#[from] NoIdeal),
    /// (57) and (58) bring ṡ to zero; s ends at a constant that depends on the run, or, where an accelerometer has a bias, at none.
    #[error("adaptation brings ṡ of agent number {} to zero and not s, and what is left of s moves it", agent + 1)]
    ErrorStays {
        /// Index of the agent.
        agent: usize,
    },
    /// Nothing keeps apart what pushes it and what it agrees on, and the impulse is not known.
    #[error("agent number {} is its own reference, so that what is agreed on moves by an amount that is known only after the run", agent + 1)]
    Pushed {
        /// Index of the agent.
        agent: usize,
    },
    /// They follow a leader, who moves.
    #[error("everybody follows a leader")]
    Leader,
    /// The baseline conserves nothing.
    #[error("under backstepping tracking errors move it")]
    Backstepping,
    /// Reference dynamics from outside: nothing is known of what they conserve.
    #[error("the reference dynamics are not those of a design of the paper")]
    Own,
    /// There is no single value.
    #[error(
        "no agent reaches all others, so nothing makes them agree: {closed_groups} groups hear no agent outside themselves"
    )]
    NoSpanningTree {
        /// How many groups hear no agent outside themselves.
        closed_groups: usize,
    },
    /// A root is not positive.
    #[error("the reference dynamics of agent number {} are not stable", agent + 1)]
    Roots {
        /// Index of the agent.
        agent: usize,
    },
    /// Nothing shows that all agree.
    #[error("not all roots of agent number {} are real, so that nothing shows that all agree", agent + 1)]
    ComplexRoots {
        /// Index of the agent.
        agent: usize,
    },
    /// Too few of its digits are known.
    #[error("{}", uncertain(*error_bound))]
    Uncertain {
        /// How far it can be from what was computed; infinite where no bound was found.
        error_bound: f64,
    },
}

fn uncertain(error_bound: f64) -> String {
    if error_bound.is_finite() {
        return format!("rounding leaves it uncertain by ± {error_bound:.1e}");
    }
    "no bound was found on what rounding does to it: the network is too dense to be eliminated, and parts of it hardly hear each \
     other"
        .into()
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
    check_shape(setup).map_err(|error| NoIdeal::from(Box::new(error)))?;
    let designed = designed(setup);
    let setup = designed.as_ref().unwrap_or(setup);
    if setup.reference.is::<Backstepping>() {
        return Err(NoPrediction::Backstepping);
    }
    if setup.following().is_some() {
        return Err(NoPrediction::Leader);
    }
    if setup.all_track() {
        return Err(NoPrediction::Targets);
    }
    if !setup.agents.iter().all(conserves) {
        return Err(NoPrediction::Law);
    }
    if !is_consensus(setup) {
        return Err(NoPrediction::Own);
    }
    if setup.control.is_some() {
        return Err(NoPrediction::Sampled);
    }
    let (edges, _) = fixed(&setup.network)?;
    let n = setup.agents.len();
    let thrust = |agent: usize| setup.agents[agent].law.downcast().map(|law: &ThrustLaw| law.design);
    let NullVector { entries: influence, error: influence_error } =
        null_vector(n, edges).map_err(|reason| match reason {
            NoNullVector::Classes(closed_groups) => NoPrediction::NoSpanningTree { closed_groups },
            NoNullVector::Varies => NotFixed::VaryingWeight.into(),
        })?;
    // (3) and (23) hold no z in what they conserve.
    let counts = |agent: &usize| setup.reference.is::<Consensus>() && influence[*agent] > 0.0;
    if let Some(agent) = (0..n).filter(counts).find(|agent| pushed_for_ever(&setup.agents[*agent])) {
        return Err(NoPrediction::PushedForEver { agent });
    }
    let adapts = |agent: &usize| thrust(*agent).is_some_and(|design| design.estimate_start().is_some());
    let drifts = |agent: &usize| thrust(*agent).is_some_and(|design| design.bias() != [0.0; 3]);
    if let Some(agent) = (0..n).find(|agent| drifts(agent) || counts(agent) && adapts(agent)) {
        return Err(NoPrediction::ErrorStays { agent });
    }
    if let Some(agent) = (0..n).filter(counts).find(|agent| dry_loss_w(&setup.agents[*agent]).is_some()) {
        return Err(NoPrediction::DryFriction { agent });
    }
    if let Some(agent) = setup.agents.iter().position(|agent| agent.roots_per_s.all_real().is_none()) {
        return Err(NoPrediction::ComplexRoots { agent });
    }
    let alpha: Vec<Vec<f64>> = setup
        .agents
        .iter()
        .enumerate()
        .map(|(agent, a)| polynomial(&a.roots_per_s).map_err(|_| NoPrediction::Roots { agent }))
        .collect::<Result<_, _>>()?;
    let integral = setup.reference.is::<PureIntegral>();
    let own = setup.agents.iter().enumerate();
    let starts = own.map(|(agent, own)| family_start(agent, own, integral)).collect::<Result<Vec<_>, _>>()?;
    let conserved =
        Conserved { setup, starts: &starts, heard: &by_receiver(n, edges), alpha: &alpha, influence: &influence };
    let (mut value, mut error_bound) = (Vec::new(), Vec::new());
    for axis in 0..setup.agents[0].start.q.len() {
        let found = conserved.quotient(axis, influence_error)?;
        value.push(found.value);
        error_bound.push(found.error_bound);
    }
    Ok(Prediction { value, error_bound, influence, influence_error })
}

/// Whether its tracking error drops out of Q.
fn conserves(agent: &AgentSetup) -> bool {
    if agent.law.is::<ThrustLaw>() {
        // The angular velocity of a rotorcraft is late, and (46) has nothing else that would be on time.
        return !is_its_own_reference(agent) || agent.robot.kind.is::<VehicleModel>();
    }
    let of_derivatives =
        |model: &ChainModel| model.order() > 1 && matches!(model, ChainModel::Derivatives(_) | ChainModel::Vector(_));
    is_lagrangian(agent)
        || agent.law.is::<ChainLaw>() && agent.robot.kind.downcast::<ChainModel>().is_some_and(of_derivatives)
}

/// The edges by who hears.
fn by_receiver(agents: usize, edges: &[Edge]) -> Vec<Vec<Edge>> {
    let mut heard = vec![Vec::new(); agents];
    for edge in edges {
        heard[edge.to].push(*edge);
    }
    heard
}

/// Whether something acts on the agent without end.
fn pushed_for_ever(agent: &AgentSetup) -> bool {
    agent.pushes.iter().any(endless)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_known_digits_are_printed_and_zero_has_no_sign() {
        assert_eq!(known_digits(-0.75, 1e-15, 6), "−0.750000");
        assert_eq!(known_digits(-1e-9, 1e-15, 6), "0.000000");
        assert_eq!(known_digits(-0.0, 0.0, 6), "0.000000");
        assert_eq!(known_digits(0.123_456_7, 4e-4, 6), "0.123");
        assert_eq!(known_digits(-0.4, 0.3, 6), "0");
        assert_eq!(known_digits(1234.5, 20.0, 6), "1234 ± 2e1");
        let small = |value: [f64; 2]| Prediction {
            value: value.into(),
            error_bound: vec![1e-22; 2],
            influence: Vec::new(),
            influence_error: 0.0,
        };
        assert_eq!(small([5e-7, -1.25e-9]).known_digits(), ["0.000000500", "−0.000000001"]);
        assert_eq!(small([0.5, 1e-9]).known_digits(), ["0.500000", "0.000000"]);
    }
}

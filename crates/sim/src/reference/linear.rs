//! Reference dynamics as linear forms: what is derived from, not what runs.

use forwardstep_core::reference::polynomial;

use crate::setup::{AgentSetup, Exchange};

/// z^(ℓ) = own + constant + Σ_j w_ij [coupled − a₀ q_j(t − T_ij) − a₁ q̇_j(t − T_ij)], of one agent on any axis.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearReference {
    /// ℓ, at least one.
    pub order: usize,
    /// What an agent has by itself.
    pub own: LinearTerms,
    /// Whether something else is added that does not depend on the state, such as a place where an agent is drawn to.
    pub constant: bool,
    /// What stands beside w_ij of the agent itself.
    pub coupled: LinearTerms,
    /// a₀ and a₁; zero for what is not sent.
    pub heard: [f64; 2],
}

/// Numbers times q, q̇, … and times z, ż, …, as decimals: what is derived has the numbers that are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearTerms {
    /// Those of q, q̇, ….
    pub q: Vec<f64>,
    /// Those of z, ż, …, z^(ℓ−1).
    pub z: Vec<f64>,
}

impl LinearReference {
    /// The consensus family with pʳ q as it is for r below `measured` and p^(r−1) z above. `None` for roots without meaning.
    pub(super) fn consensus(agent: &AgentSetup, exchange: Exchange, measured: usize) -> Option<Self> {
        let alpha = polynomial(&agent.roots_per_s).ok()?;
        let order = agent.roots_per_s.len();
        let split = |of: &dyn Fn(usize) -> f64| {
            let count = order + 1;
            let q = (0..measured.min(count)).map(of).collect();
            let z = (0..count.saturating_sub(1)).map(|k| if k + 1 < measured { 0.0 } else { of(k + 1) }).collect();
            LinearTerms { q, z }
        };
        let mut own = split(&|r| if r == 0 { 0.0 } else { -alpha[r - 1] });
        // λ (q̇ − z)
        if let (Some(dq), Some(z)) = (own.q.get_mut(1), own.z.first_mut()) {
            (*dq, *z) = (*dq + agent.manipulability, *z - agent.manipulability);
        }
        let coupled = split(&|r| -alpha[r]);
        let velocity = match exchange {
            Exchange::Position => 0.0,
            Exchange::PositionVelocity => -alpha[0] / agent.roots_per_s.first_real()?,
            Exchange::Estimates | Exchange::Composite => return None,
        };
        Some(LinearReference { order, own, constant: false, coupled, heard: [-alpha[0], velocity] })
    }
}

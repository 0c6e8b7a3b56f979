//! From s to disagreement: what a tracking error does to agreement through the reference dynamics of the schedule as it is written.
//!
//! Not from the paper, derived for this software. The reference is linear, and q̇ = z + s. So what a run adds to the disagreement that
//! s ≡ 0 leaves, and where it moves everybody to, is linear in s, on each axis by itself:
//!
//! ```text
//! q_i(t) − q_j(t) = Σ_k ∫ h_ij,k(t, τ) s_k(τ) dτ
//!
//! |q_i − q_j|(t) ≤ g∞ max|s|          g∞ = max over pairs and t of Σ_k ∫ |h_ij,k(t, τ)| dτ
//! rms D ≤ √(g∞ g₁) rms |s|            g₁ = max over k and τ of ∫ max_ij |h_ij,k(t, τ)| dt,   |s|² = Σ_k |s_k|²
//! ```
//!
//! with D the largest difference over pairs and axes: by Cauchy and Schwarz with |h| = |h|^½ |h|^½. A constant s gives no disagreement, since
//! z = −s with q̇ = 0 is agreement; so in the first bound half of what s varies by may be put for max|s|.
//!
//! An impulse of s_k at τ moves everybody by c_k(τ) for ever. Over a network that repeats itself after P the posture thus moves, in the
//! long run, by no more than (1/P) Σ_k ∫ |c_k| max|s| and √((1/P) Σ_k ∫ c_k²) rms |s| a second; both integrals are over one period. Over
//! a fixed graph with constant delays and λ = 0, c is zero whatever s does: Σ v (X − α₁ s) with what is on its way is conserved.
//!
//! An error b of all measured velocities is not seen by the law: q̇ = z − b, while the reference takes z for the velocity, and others
//! hear it. Over a fixed graph in which all degrees are d and all delays T it moves everybody for ever at
//! −b (α₀ + d (α₁ − v α₀/κ₀))/(α₀ + d (α₁ − v α₀/κ₀ + α₀ T)), v = 1 when velocities are sent, else 0. Under (3) and (23), which have
//! −α₀ q and −d α₁ q from positions, it is v b d (α₀/κ₀)/(α₀ + d (α₁ − v α₀/κ₀ + α₀ T)).
//!
//! h is worked out by marching impulse responses over one period, or over the horizon where nothing repeats: s, and what is heard, are held over
//! steps. It is a computation, no enclosure: it leaves out what sampling does to the reference.
//!
//! - `agent`: the reference of one agent on one axis.
//! - `grid`: steps on which the network is in one piece.
//! - `responses`: all responses at once.

mod agent;
mod grid;
mod responses;

use forwardstep_sim::{AgentSetup, PositionOnlyLaw, Setup, check_shape};
use thiserror::Error;

use self::agent::Agent;
use self::grid::Nodes;
use self::responses::{Sums, sums};
use crate::links::may_time_out;
use crate::prediction::{Repeats, order};

/// Steps over the fastest time constant, and the most steps of a round.
const FINE: f64 = 0.1;
const MOST_STEPS: usize = 6000;
/// Agents whose responses are worked out at most.
const MOST_AGENTS: usize = 100;
/// Steps that nothing is left for where it is over.
const QUIET: f64 = 20.0;
/// Steps of a cell over which s is held: as few as can be afforded.
const PER_CELL: [usize; 4] = [1, 2, 4, 8];

/// What s does to agreement, by the schedule as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceGains {
    /// g∞, s: from the largest |s| of an agent and axis to the largest disagreement.
    pub peak_s: f64,
    /// √(g∞ g₁), s: from the root mean square of |s| over all agents and axes to that of the disagreement.
    pub rms_s: f64,
    /// How fast the posture may move in the long run over max|s|.
    pub drift_peak: f64,
    /// The same over rms |s|.
    pub drift_rms: f64,
    /// How fast an error of one of all measured velocities moves everybody for ever; only over a network that repeats itself.
    pub bias: Option<f64>,
    /// Over what.
    pub over: Over,
}

/// What the gains speak of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Over {
    /// One graph with constant delays, for all time.
    Fixed,
    /// A network that repeats itself after so long, s; for all time.
    Period(f64),
    /// A network that does not repeat itself: from the start to the end of the horizon, s, as it is written.
    Horizon(f64),
}

/// Why there are no such gains.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoReferenceGains {
    /// The reference is not linear in what is measured and heard.
    #[error("the reference dynamics have no linear form")]
    Reference,
    /// What is heard does not act in proportion.
    #[error("the coupling is nonlinear")]
    Coupling,
    /// Its law does not lead q̇ to z.
    #[error("the law of {agent} does not lead the velocity to z")]
    Law {
        /// Name of the agent.
        agent: String,
    },
    /// One agent alone has no disagreement.
    #[error("there are no two agents to compare")]
    FewerThanTwoAgents,
    /// Messages stop counting when they are old.
    #[error("messages that are too old do not count, so that the network depends on what arrives")]
    Timeout,
    /// A message holds for a while.
    #[error(
        "a velocity is heard that stands still for a while, so that what it was for an instant counts for all that time"
    )]
    Held,
    /// Too many responses.
    #[error("the responses of {agents} agents to s at every time are too many to work out")]
    TooLarge {
        /// How many agents.
        agents: usize,
    },
    /// Disagreement that does not fade.
    #[error(
        "what s does to the disagreement does not fade within what can be worked out, as where λ moves agents that do not reach each other"
    )]
    Stays,
    /// The setup has no meaning, or numbers that cannot be reckoned with.
    #[error("the setup has no meaning, or the gains of the reference overflow double precision")]
    Unclear,
}

impl ReferenceGains {
    /// Those of a setup, whatever acts on it.
    ///
    /// # Errors
    /// [`NoReferenceGains`] says why there are none.
    pub fn of(setup: &Setup) -> Result<ReferenceGains, NoReferenceGains> {
        let network = &setup.network;
        if setup.agents.len() < 2 {
            return Err(NoReferenceGains::FewerThanTwoAgents);
        }
        if check_shape(setup).is_err() {
            return Err(NoReferenceGains::Unclear);
        }
        if !network.coupling.is_linear() {
            return Err(NoReferenceGains::Coupling);
        }
        if setup.agents.len() > MOST_AGENTS {
            return Err(NoReferenceGains::TooLarge { agents: setup.agents.len() });
        }
        let agents = (0..setup.agents.len()).map(|index| Agent::of(setup, index)).collect::<Option<Vec<_>>>();
        let agents = agents.ok_or(NoReferenceGains::Reference)?;
        let leads = |agent: &AgentSetup| order(agent) == Some(2) && !agent.law.is::<PositionOnlyLaw>();
        if let Some(agent) = setup.agents.iter().find(|agent| !leads(agent)) {
            return Err(NoReferenceGains::Law { agent: agent.name.clone() });
        }
        if may_time_out(setup) {
            return Err(NoReferenceGains::Timeout);
        }
        let end_s = setup.time.end_s;
        let valid = network.validate(end_s).is_ok() && network.lasts_until(end_s).is_ok();
        if !(valid && end_s > 0.0 && end_s.is_finite()) {
            return Err(NoReferenceGains::Unclear);
        }
        let step_s = FINE / fastest_per_s(setup, &agents);
        if !(step_s > 0.0 && step_s.is_finite()) {
            return Err(NoReferenceGains::Unclear);
        }
        let (over, round_s) = match Repeats::of(setup) {
            // Any time is like any other.
            Ok(Repeats::Always) => (Over::Fixed, step_s),
            Ok(Repeats::Every(period_s)) => (Over::Period(period_s), period_s),
            Err(_) => (Over::Horizon(end_s), end_s),
        };
        let sums = worked_out(setup, &agents, over, round_s, step_s)?;
        let lambda = setup.agents.iter().any(|agent| agent.manipulability != 0.0);
        Ok(ReferenceGains::from_sums(&sums, over, round_s, lambda))
    }

    fn from_sums(sums: &Sums, over: Over, round_s: f64, lambda: bool) -> ReferenceGains {
        let n = sums.shift.len() / sums.lengths_s.len();
        let cells = || sums.shift.chunks(n).zip(&sums.lengths_s);
        let absolute: f64 = cells().map(|(shift, _)| shift.iter().map(|c| c.abs()).sum::<f64>()).sum();
        let square: f64 = cells().map(|(shift, length_s)| shift.iter().map(|c| c * c).sum::<f64>() / length_s).sum();
        let stays = over == Over::Fixed && !lambda;
        let (drift_peak, drift_rms) = if stays { (0.0, 0.0) } else { (absolute / round_s, (square / round_s).sqrt()) };
        let bias = match over {
            Over::Fixed | Over::Period(_) => Some(sums.bias / round_s),
            Over::Horizon(_) => None,
        };
        let (peak_s, rms_s) = (sums.at_once_s, (sums.at_once_s * sums.of_one_s).sqrt());
        ReferenceGains { peak_s, rms_s, drift_peak, drift_rms, bias, over }
    }
}

/// The fastest rate of any agent by itself, 1/s.
fn fastest_per_s(setup: &Setup, agents: &[Agent]) -> f64 {
    let network = &setup.network;
    let mut fastest = 0.0_f64;
    for edges in &network.schedule.graphs {
        let mut degree = vec![0.0; agents.len()];
        for edge in edges {
            degree[edge.to] += edge.weight.constant().unwrap_or_else(|| network.weight_at(edge.weight, 0.0));
        }
        fastest =
            agents.iter().zip(&degree).map(|(agent, degree)| agent.fastest_per_s(*degree)).fold(fastest, f64::max);
    }
    fastest
}

fn worked_out(
    setup: &Setup,
    agents: &[Agent],
    over: Over,
    round_s: f64,
    step_s: f64,
) -> Result<Sums, NoReferenceGains> {
    let large = NoReferenceGains::TooLarge { agents: agents.len() };
    let repeats = !matches!(over, Over::Horizon(_));
    let nodes = Nodes::of(&setup.network, round_s, repeats, step_s, MOST_STEPS).ok_or_else(|| large.clone())?;
    let cuts = nodes.cuts(setup, agents)?;
    // Longer than any message is on its way, and than one difference that passes through zero.
    let quiet_s = setup.network.max_delay_s() + QUIET * step_s;
    for per_cell in PER_CELL {
        match sums(agents, &cuts, per_cell, repeats.then_some(quiet_s)) {
            Err(NoReferenceGains::TooLarge { .. }) if per_cell < nodes.steps() => {}
            Ok(sums) if !sums.is_finite() => return Err(NoReferenceGains::Unclear),
            other => return other,
        }
    }
    Err(large)
}

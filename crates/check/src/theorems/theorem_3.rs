//! Theorem 3 for (a5) and (24), of which (aa10) and Theorem 2's (a1) are members.

use forwardstep_sim::delay::{Delay, PiecewiseConstant};
use forwardstep_sim::graph::{Edge, strong_components};
use forwardstep_sim::{Exchange, Setup};

use super::{agreement, orders};
use crate::hypothesis::{Hypothesis, Id, Named, ReferenceEvidence};
use crate::kinds::Claim;
use crate::theorem::Theorem;

pub(super) fn claim(setup: &Setup) -> Claim {
    let (least, most) = orders(setup);
    let theorem = match setup.exchange {
        _ if least < most => Theorem::OwnOrders { exchange: setup.exchange, least, most },
        Exchange::PositionVelocity if most == 1 => Theorem::FirstOrder,
        Exchange::PositionVelocity if most == 2 && same_roots(setup) => Theorem::Theorem2,
        Exchange::PositionVelocity | Exchange::Estimates | Exchange::Composite => {
            Theorem::Theorem3Velocities { order: most }
        }
        Exchange::Position => Theorem::Theorem3Positions { order: most },
    };
    Claim { theorem, promises: agreement(setup, least) }
}

pub(super) fn hypotheses(setup: &Setup) -> Vec<Hypothesis> {
    vec![real_roots(setup), one_order(setup)]
}

fn same_roots(setup: &Setup) -> bool {
    setup.agents.windows(2).all(|pair| pair[0].roots_per_s == pair[1].roots_per_s)
}

/// That the polynomials of these agents are stable and have real roots: those of consensus, where every root is a step of the chain of averages
/// (30). With a pair of complex roots such a step weighs something negatively, and (24) grows under some schedules.
pub(super) fn real_roots(setup: &Setup) -> Hypothesis {
    let slowest = setup.agents.iter().filter_map(|agent| agent.roots_per_s.slowest_per_s());
    let smallest_per_s = slowest.fold(f64::INFINITY, f64::min);
    complex_roots(setup).unwrap_or_else(|| Hypothesis::new(Id::RealRoots, ReferenceEvidence::Roots { smallest_per_s }))
}

/// That it is not so, where an agent that does not follow a target has a pair.
pub(super) fn complex_roots(setup: &Setup) -> Option<Hypothesis> {
    let pair = |agent: usize| Some((agent, *setup.agents[agent].roots_per_s.pairs.first()?));
    let (agent, pair) = (0..setup.agents.len()).filter(|agent| !setup.tracks(*agent)).find_map(pair)?;
    let evidence = ReferenceEvidence::ComplexRoots { agent: Named::of(setup, agent), pair };
    Some(Hypothesis::new(Id::RealRoots, evidence))
}

/// The paper writes one ℓ for all agents. Its argument does not need that.
///
/// With χ_0 = qᵢ, χ_r = (p/κ_(r−1) + 1) χ_(r−1) and s = 0, (24) is, for the order ℓᵢ of agent i,
///
/// ```text
/// d/dt χ_r = κ_r (χ_(r+1) − χ_r),  r < ℓᵢ        d/dt χ_ℓᵢ = − Σⱼ w_ij (χ_ℓᵢ − χ_0 of j, at t − T_ij):
/// ```
///
/// (30), a network of first order with the vertices (i, 0) … (i, ℓᵢ). Its weights are positive, and each agent's own are constant, so it has a
/// spanning tree over the windows over which the agents have one, rooted at (k, ℓ_k). Nowhere does an ℓᵢ meet an ℓⱼ. For (a5) with
/// a common κ₀ it is χ_1 of j that is heard, which is there since ℓⱼ ≥ 1; where κ₀ is not common but graph and delays are
/// constant, p + κ₀ᵢ factors out and leaves (24) with ℓᵢ − 1. s enters agent by agent as before.
fn one_order(setup: &Setup) -> Hypothesis {
    let order = |agent: usize| setup.agents[agent].roots_per_s.len();
    let named = |agent: usize| (Named::of(setup, agent), order(agent));
    match (1..setup.agents.len()).find(|agent| order(*agent) != order(0)) {
        None => Hypothesis::new(Id::CommonOrder, ReferenceEvidence::Order(order(0))),
        Some(other) => Hypothesis::new(Id::OwnOrders, ReferenceEvidence::Orders([named(0), named(other)])),
    }
}

/// The condition that the paper's Theorem 3 leaves out for (a5), of which (aa10) and (a1) are members.
///
/// What agent i hears is α₀[(κ₀ⱼ/κ₀ᵢ) ψ_j + (1 − κ₀ⱼ/κ₀ᵢ) q_j]: a weighting that is only convex when κ₀ⱼ ≤ κ₀ᵢ along j → i.
/// Around a cycle that means equality. With a fixed graph and constant delays p + κ₀ᵢ factors out and nothing is needed.
///
/// Asked of graphs that recur. What a schedule that ends, or a delay that changes no more, goes through before acts for a finite time: the reference dynamics are linear with
/// bounded coefficients and V bounds s, so all is finite when the last of it begins, and the theorem speaks from there on, with what is
/// still under way as its history.
pub(super) fn common_first_root(setup: &Setup) -> Hypothesis {
    let network = &setup.network;
    let graphs = network.schedule.recurring_graphs();
    let stays = network.schedule.constant_graph().or(match graphs {
        [graph] => Some(graph),
        _ => None,
    });
    let constant = |edge: &Edge| edge.weight.constant().is_some() && stays_at_last(&network.delays[edge.delay]);
    let over_constants = stays.is_some_and(|graph| graph.iter().all(constant));
    let first_root = |agent: usize| setup.agents[agent].roots_per_s.first_real().unwrap_or(f64::NAN);
    let named = |agent: usize| (Named::of(setup, agent), first_root(agent));
    let edges: Vec<(usize, usize)> = graphs.iter().flatten().map(|edge| (edge.from, edge.to)).collect();
    let witness = strong_components(network.agents, &edges).into_iter().find_map(|component| {
        let first = component[0];
        component.into_iter().find(|agent| first_root(*agent) != first_root(first)).map(|other| (first, other))
    });
    let evidence = match witness {
        None => ReferenceEvidence::FirstRootCommon,
        Some(_) if over_constants => ReferenceEvidence::FirstRootsOverConstants,
        Some((a, b)) => ReferenceEvidence::FirstRoots([named(a), named(b)]),
    };
    Hypothesis::new(Id::CommonFirstRoot, evidence)
}

/// Whether a delay is one value from some time on.
fn stays_at_last(delay: &Delay) -> bool {
    delay.is_constant() || delay.downcast().is_some_and(|pieces: &PiecewiseConstant| pieces.period_s.is_none())
}

//! Theorem 3 for (a5) and (24), of which (aa10) and Theorem 2's (a1) are members.

use forwardstep_sim::graph::strong_components;
use forwardstep_sim::{Exchange, Setup};

use super::{agreement, order};
use crate::hypothesis::{Hypothesis, Id, Named, ReferenceEvidence};
use crate::kinds::Claim;
use crate::laws::kind_of;
use crate::links::varying_weights;
use crate::theorem::Theorem;

pub(super) fn claim(setup: &Setup) -> Claim {
    let order = order(setup);
    let theorem = match (setup.exchange, order) {
        (Exchange::PositionVelocity, 1) => Theorem::FirstOrder,
        (Exchange::PositionVelocity, 2) if same_roots(setup) => Theorem::Theorem2,
        (Exchange::PositionVelocity, order) => Theorem::Theorem3Velocities { order },
        (Exchange::Position, order) => Theorem::Theorem3Positions { order },
    };
    Claim { theorem, promises: agreement(setup, order) }
}

pub(super) fn hypotheses(setup: &Setup) -> Vec<Hypothesis> {
    let all: Vec<usize> = (0..setup.agents.len()).collect();
    let mut hypotheses = vec![real_roots(setup, &all)];
    if setup.agents.iter().any(|agent| kind_of(agent).wants_common_order()) {
        hypotheses.push(common_order(setup));
    }
    hypotheses
}

fn same_roots(setup: &Setup) -> bool {
    setup.agents.windows(2).all(|pair| pair[0].roots_per_s == pair[1].roots_per_s)
}

/// That the polynomials of these agents are stable.
pub(crate) fn real_roots(setup: &Setup, agents: &[usize]) -> Hypothesis {
    let roots = agents.iter().flat_map(|agent| &setup.agents[*agent].roots_per_s).copied();
    Hypothesis::new(Id::RealRoots, ReferenceEvidence::Roots { smallest_per_s: roots.fold(f64::INFINITY, f64::min) })
}

fn common_order(setup: &Setup) -> Hypothesis {
    let order = |agent: usize| setup.agents[agent].roots_per_s.len();
    let named = |agent: usize| (Named::of(setup, agent), order(agent));
    let other = (1..setup.agents.len()).find(|agent| order(*agent) != order(0));
    let evidence = match other {
        None => ReferenceEvidence::Order(order(0)),
        Some(other) => ReferenceEvidence::Orders([named(0), named(other)]),
    };
    Hypothesis::new(Id::CommonOrder, evidence)
}

/// The condition that the paper's Theorem 3 leaves out for (a5), of which (aa10) and (a1) are members.
///
/// What agent i hears is α₀[(κ₀ⱼ/κ₀ᵢ) ψ_j + (1 − κ₀ⱼ/κ₀ᵢ) q_j]: a weighting that is only convex when κ₀ⱼ ≤ κ₀ᵢ along j → i.
/// Around a cycle that means equality. With a fixed graph and constant delays p + κ₀ᵢ factors out and nothing is needed.
pub(super) fn common_first_root(setup: &Setup) -> Hypothesis {
    let graphs = &setup.network.schedule.graphs;
    let constant_delays = setup.network.used_delays().all(|index| setup.network.delays[index].is_constant());
    let first_root = |agent: usize| setup.agents[agent].roots_per_s.first().copied().unwrap_or(f64::NAN);
    let named = |agent: usize| (Named::of(setup, agent), first_root(agent));
    let edges: Vec<(usize, usize)> = graphs.iter().flatten().map(|edge| (edge.from, edge.to)).collect();
    let witness = strong_components(setup.network.agents, &edges).into_iter().find_map(|component| {
        let first = component[0];
        component.into_iter().find(|agent| first_root(*agent) != first_root(first)).map(|other| (first, other))
    });
    let evidence = match witness {
        None => ReferenceEvidence::FirstRootCommon,
        Some(_) if graphs.len() == 1 && constant_delays && varying_weights(setup).next().is_none() => {
            ReferenceEvidence::FirstRootsOverConstants
        }
        Some((a, b)) => ReferenceEvidence::FirstRoots([named(a), named(b)]),
    };
    Hypothesis::new(Id::CommonFirstRoot, evidence)
}

//! Swarm tracking, which Remark 11 names and the paper does not print: what our own derivation asks for, see
//! `forwardstep_core::reference::SmoothFollowing::swarm`.

use forwardstep_core::Gain;
use forwardstep_sim::Setup;
use forwardstep_sim::graph::laplacian;
use forwardstep_sim::leader::Following;

use crate::graphs::mutual_weights;
use crate::hypothesis::{FollowingEvidence, Hypothesis, Id};

pub(super) fn hypotheses(setup: &Setup, following: &Following, coupling: f64) -> [Hypothesis; 3] {
    [
        Hypothesis::new(Id::PrintedDesign, FollowingEvidence::NotPrinted),
        mutual_weights(setup),
        Hypothesis::new(Id::SwarmCoupling, coupled(setup, following, coupling)),
    ]
}

/// k λ against what the derivation asks for: L − λ* is positive definite exactly if λ > λ*.
fn coupled(setup: &Setup, following: &Following, coupling: f64) -> FollowingEvidence {
    let (alpha, beta) = (following.alpha, following.beta);
    let root = beta * beta - 4.0 * alpha;
    if root < -1e-12 * beta * beta {
        return FollowingEvidence::ComplexRoots;
    }
    let kappa = 0.5 * (beta - root.max(0.0).sqrt());
    let least = beta + kappa * kappa * kappa * kappa / (2.0 * (beta * beta - alpha) * (beta - kappa));
    let vertices = setup.network.agents;
    let followers: Vec<usize> = (0..vertices).filter(|vertex| setup.leader() != Some(*vertex)).collect();
    let n = followers.len();
    let Some(edges) = setup.network.schedule.constant_graph() else { return FollowingEvidence::GraphSwitches };
    let Some(all) = laplacian(vertices, edges) else { return FollowingEvidence::WeightVaries };
    let mut shifted = Vec::with_capacity(n * n);
    for row in &followers {
        for column in &followers {
            let shift = if row == column { least / coupling } else { 0.0 };
            shifted.push(all[row * vertices + column] - shift);
        }
    }
    match Gain::Matrix(shifted).resolve(n, &[]) {
        Ok(_) => FollowingEvidence::CouplingExceeds { least },
        Err(_) => FollowingEvidence::CouplingNotShown { least },
    }
}

//! Swarm tracking, which Remark 11 names and the paper does not print: what our own derivation asks for, see
//! `forwardstep_core::reference::SmoothFollowing::swarm`.

use forwardstep_sim::Setup;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::leader::Following;

use crate::graphs::mutual_weights;
use crate::hypothesis::{FollowingEvidence, Hypothesis, Id};
use crate::shifted_laplacian::ShiftedLaplacian;

pub(super) fn hypotheses(setup: &Setup, following: &Following, coupling: f64) -> [Hypothesis; 3] {
    [
        Hypothesis::new(Id::PrintedDesign, FollowingEvidence::NotPrinted),
        mutual_weights(setup),
        Hypothesis::new(Id::SwarmCoupling, coupled(setup, following, coupling)),
    ]
}

/// What bounds on rounding are widened by, relatively; far more than the few roundings on the way.
const WIDER: f64 = 1e-12;
/// How often a coupling that is too small is doubled to find one that is not.
const DOUBLINGS: usize = 20;

/// k λ against what the derivation asks for: L − λ* is positive definite exactly if λ > λ*.
fn coupled(setup: &Setup, following: &Following, coupling: f64) -> FollowingEvidence {
    let Some(least) = least(following.alpha, following.beta) else { return FollowingEvidence::ComplexRoots };
    let Some(edges) = setup.network.schedule.constant_graph() else { return FollowingEvidence::GraphSwitches };
    let vertices = setup.network.agents;
    let followers: Vec<usize> = (0..vertices).filter(|vertex| setup.leader() != Some(*vertex)).collect();
    let mut index = vec![None; vertices];
    for (number, follower) in followers.iter().enumerate() {
        index[*follower] = Some(number);
    }
    let heard = |edge: &Edge| Some((index[edge.to]?, index[edge.from], edge.weight.constant()));
    let mut weights = Vec::with_capacity(edges.len());
    for (to, from, weight) in edges.iter().filter_map(heard) {
        let Some(weight) = weight else { return FollowingEvidence::WeightVaries };
        weights.push((to, from, weight));
    }
    let exceeds = |coupling: f64| {
        let shift = least / coupling * (1.0 + WIDER);
        ShiftedLaplacian::new(followers.len(), &weights, shift).is_some_and(|matrix| matrix.is_shown_definite())
    };
    match exceeds(coupling) {
        true => FollowingEvidence::CouplingExceeds { least },
        false => FollowingEvidence::CouplingNotShown { least, enough: enough(coupling, exceeds) },
    }
}

/// A coupling that exceeds what it must, within a per cent of the least such, above one that does not.
fn enough(coupling: f64, exceeds: impl Fn(f64) -> bool) -> Option<f64> {
    let doubled = std::iter::successors(Some(2.0 * coupling), |coupling| Some(2.0 * coupling));
    let mut high = doubled.take(DOUBLINGS).find(|coupling| exceeds(*coupling))?;
    let mut low = 0.5 * high;
    while high > 1.01 * low {
        let middle = 0.5 * (low + high);
        if exceeds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(high)
}

/// What k λ must exceed; `None` where p² + β p + α has no real roots.
pub(crate) fn least(alpha: f64, beta: f64) -> Option<f64> {
    let root = beta * beta - 4.0 * alpha;
    if root < -WIDER * beta * beta {
        return None;
    }
    // The bound grows with κ₀, so that is taken as large as rounding of the difference allows.
    let kappa = 0.5 * (beta - (root - 8.0 * f64::EPSILON * beta * beta).max(0.0).sqrt());
    let least = beta + kappa * kappa * kappa * kappa / (2.0 * (beta * beta - alpha) * (beta - kappa));
    Some(least * (1.0 + WIDER))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_rounding_does_not_lower_what_the_coupling_must_exceed_where_roots_nearly_meet() {
        for k in 1..2000 {
            let beta = 0.1 + 0.7 * f64::from(k) * 0.618_033_988_749_894_9;
            let mut alpha = 0.25 * beta * beta;
            for _ in 0..6 {
                // Rounded once, so that next to nothing is lost where the two nearly cancel.
                let root = beta.mul_add(beta, -4.0 * alpha);
                let kappa = 0.5 * (beta - root.max(0.0).sqrt());
                let truth = beta + kappa.powi(4) / (2.0 * (beta * beta - alpha) * (beta - kappa));
                assert!(least(alpha, beta).is_some_and(|least| least > truth && least < truth * (1.0 + 1e-6)));
                alpha = alpha.next_down();
            }
        }
        // Far apart it is sharp; κ₀ = 1 of p² + 4 p + 3.
        let truth = 4.0 + 1.0 / (2.0 * 13.0 * 3.0);
        assert!(least(3.0, 4.0).is_some_and(|least| least > truth && least < truth * (1.0 + 2e-12)));
        assert_eq!(least(1.0 + 1e-9, 2.0), None);
    }
}

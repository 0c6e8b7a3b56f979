//! Pivots of gains that are full matrices, and of the Laplacian under swarm tracking.

use forwardstep_core::Gain;
use forwardstep_core::expression::Number;
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::{Adaptive, AgentSetup, AttitudeLaw, Known, PassivityFilterLaw, Setup, TaskSpaceLaw};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::exact::above;
use super::producers::Claim;
use super::proof::{Matrix, Proof};
use crate::theorems::swarm;
use crate::{Answer, Id};

/// Rows of a matrix that is eliminated in rational numbers.
const MOST_ROWS: usize = 64;

pub(super) fn definite(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer != Answer::Holds {
        return None;
    }
    let mut matrices = Vec::new();
    for (agent, own) in setup.agents.iter().enumerate() {
        for (gain, value) in gains(own, claim.id) {
            match value {
                Gain::Number(_) | Gain::Diagonal(_) | Gain::Bandwidth(_) => {}
                Gain::Matrix(entries) => {
                    let entries: Vec<BigRational> = entries.iter().copied().map(Number::written).collect();
                    matrices.push(Matrix { agent, gain, pivots: pivots(entries)? });
                }
            }
        }
    }
    Some(Proof::Definite(matrices))
}

/// The gains of an agent that may be matrices, by their keys in the table of its law.
fn gains(agent: &AgentSetup, id: Id) -> Vec<(&'static str, &Gain)> {
    if let (Some(law), Id::PositiveGains) = (agent.law.downcast::<Adaptive>(), id) {
        vec![("damping", &law.damping), ("adaptation_gain", &law.adaptation)]
    } else if let (Some(law), Id::PositiveGains) = (agent.law.downcast::<Known>(), id) {
        vec![("damping", &law.damping)]
    } else if let (Some(law), Id::TaskSpaceGains) = (agent.law.downcast::<TaskSpaceLaw>(), id) {
        let own = [("damping", &law.damping), ("adaptation_gain", &law.adaptation), ("task_gain", &law.task_gain)];
        own.into_iter().chain(law.kinematic_adaptation.as_ref().map(|gain| ("kinematic_gain", gain))).collect()
    } else if let (Some(law), Id::AttitudeGains) = (agent.law.downcast::<AttitudeLaw>(), id) {
        vec![("filter_gain_per_s", &law.filter), ("damping", &law.damping)]
    } else if let (Some(law), Id::PassivityFilterGains) = (agent.law.downcast::<PassivityFilterLaw>(), id) {
        vec![("filter_gain_per_s", &law.filter), ("damping", &law.damping)]
    } else {
        Vec::new()
    }
}

/// D of A = L D Lᵀ for a symmetric matrix, row by row; nothing where a pivot is not positive.
fn pivots(mut a: Vec<BigRational>) -> Option<Vec<BigRational>> {
    let size = a.len().isqrt();
    if size > MOST_ROWS {
        return None;
    }
    for k in 0..size {
        if !a[k * size + k].is_positive() {
            return None;
        }
        for i in k + 1..size {
            let factor = &a[i * size + k] / &a[k * size + k];
            for j in k + 1..size {
                let product = &factor * &a[k * size + j];
                a[i * size + j] -= product;
            }
        }
    }
    Some((0..size).map(|k| a[k * size + k].clone()).collect())
}

/// L − (β + κ⁴/(2 (β² − α) (β − κ)))/k of the followers, for κ the smaller root.
pub(super) fn swarm(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let following = setup.following().filter(|_| claim.answer == Answer::Holds)?;
    let FollowingDesign::Swarm { coupling } = following.design else { return None };
    let edges = setup.network.schedule.constant_graph()?;
    // Rounded upwards by more than α and β were when they were made of roots.
    let least = above(swarm::least(following.alpha, following.beta)?);
    let followers: Vec<usize> = (0..setup.network.agents).filter(|vertex| setup.leader() != Some(*vertex)).collect();
    let n = followers.len();
    let mut rows = vec![BigRational::zero(); n * n];
    let place = |vertex: usize| followers.iter().position(|follower| *follower == vertex);
    for k in 0..n {
        rows[k * n + k] = -(&least / Number::written(coupling));
    }
    for edge in edges {
        let (weight, to) = (Number::written(edge.weight.constant()?), place(edge.to)?);
        rows[to * n + to] += &weight;
        if let Some(from) = place(edge.from) {
            rows[to * n + from] -= weight;
        }
    }
    Some(Proof::Laplacian { pivots: pivots(rows)?, least })
}

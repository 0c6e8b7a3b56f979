//! Theorem 6: robots whose tip follows a target by uncertain lengths, without its velocity.

use std::sync::Arc;

use forwardstep_core::robot::tree::{Tree, TreeTip};
use forwardstep_core::robot::{Posture, TipKinematics};
use forwardstep_sim::{AgentSetup, Setup, TaskSpaceLaw, TipSetup};
use nalgebra::DMatrix;

use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named, Subject};
use crate::inertia::{bounded_dynamics, uniform_inertia};
use crate::reach::within_reach;
use crate::theorem::Theorem;

pub(crate) struct TaskSpaceRobot;

impl KindCheck for TaskSpaceRobot {
    fn name(&self) -> &'static str {
        "task-space"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<TaskSpaceLaw>()
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "Theorem 6"
    }

    fn claim(&self, _: &Setup) -> Option<Claim> {
        Some(Claim {
            theorem: Theorem::Theorem6,
            promises: "x − x_d → 0 and dx − dx_d → 0 with uncertain lengths and parameters, without a measured dx"
                .into(),
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = uniform_inertia(setup, agents);
        hypotheses.extend(bounded_dynamics(setup, agents));
        hypotheses.push(Hypothesis::new(Id::TaskSpaceGains, gains(setup, agents)));
        for index in agents {
            let agent = &setup.agents[*index];
            let Some(law) = agent.law.downcast::<TaskSpaceLaw>() else { continue };
            let about = |id, evidence| Hypothesis::about(id, Subject::Agent(Named::of(setup, *index)), evidence);
            hypotheses.push(about(Id::RegularJacobian, jacobian(agent, law)));
            let reach = within_reach(agent, law, setup.time.end_s);
            let of = || Subject::Agent(Named::of(setup, *index));
            hypotheses.extend(reach.map(|evidence| Hypothesis::about(Id::TargetWithinReach, of(), evidence)));
            hypotheses.extend(uncertain(agent, law).map(|evidence| about(Id::CertainRegressor, evidence)));
            hypotheses
                .extend(within_bounds(setup, *index, law).map(|evidence| about(Id::LengthsWithinBounds, evidence)));
        }
        hypotheses
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }
}

/// Ĵ must stay away from singularity along the run, which is not known before.
fn jacobian(agent: &AgentSetup, law: &TaskSpaceLaw) -> KindEvidence {
    match start(agent, law) {
        Some(start) if start != 0.0 && start.is_finite() => {
            KindEvidence::Determinant { start, floor: law.determinant_floor }
        }
        Some(start) => KindEvidence::Singular { start },
        None => KindEvidence::NoTip,
    }
}

/// det Ĵ at the start; nothing for a robot that has no such tip.
fn start(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<f64> {
    match &law.tip {
        TipSetup::Planar(tip) => {
            law.tip.parameters(&*agent.robot.kind).is_some().then(|| determinant(tip, agent, law)).flatten()
        }
        TipSetup::Point { point, coordinates, uncertain } => {
            let tree = agent.robot.kind.downcast::<Arc<Tree>>()?;
            let tip = TreeTip::new((**tree).clone(), point, coordinates, *uncertain).ok()?;
            determinant(&tip, agent, law)
        }
    }
}

fn determinant(tip: &impl TipKinematics, agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<f64> {
    let (m, still) = (tip.axes(), vec![0.0; law.kinematic_start.len()]);
    let (mut j, mut dj) = (vec![0.0; m * m], vec![0.0; m * m]);
    let posture = Posture { q: &agent.start.q, dq: &vec![0.0; m], theta: &law.kinematic_start, d_theta: &still };
    tip.jacobian(posture, &mut j, &mut dj).ok()?;
    Some(DMatrix::from_row_slice(m, m, &j).determinant())
}

/// Y(q, q̇, z, ż) has to be known but for ϑ. That of a tree is stated with all its translations, as they are in the file, and the
/// head of `robot/tree/tip.rs` of the core derives which of them it holds. A planar arm's has no length in it: they are in its ϑ.
fn uncertain(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<KindEvidence> {
    let TipSetup::Point { point, coordinates, uncertain } = &law.tip else { return None };
    let tree = agent.robot.kind.downcast::<Arc<Tree>>()?;
    let inside = TreeTip::new((**tree).clone(), point, coordinates, *uncertain).ok()?.in_regressor();
    let names = law.kinematic_names.iter().zip(inside).filter(|(_, inside)| *inside).map(|(name, _)| name.clone());
    let names: Vec<String> = names.collect();
    Some(if names.is_empty() {
        KindEvidence::LengthsOutsideRegressor(*uncertain)
    } else if are_known(agent, law) {
        KindEvidence::LengthsKnown
    } else {
        KindEvidence::LengthsInRegressor(names)
    })
}

/// Whether nothing about the tip is uncertain.
fn are_known(agent: &AgentSetup, law: &TaskSpaceLaw) -> bool {
    law.kinematic_adaptation.is_none()
        && law.tip.parameters(&*agent.robot.kind).is_some_and(|theta| theta == law.kinematic_start)
}

/// Lengths that are not adapted have to be the true ones.
fn gains(setup: &Setup, agents: &[usize]) -> KindEvidence {
    let wrong = agents.iter().find(|index| {
        let agent = &setup.agents[**index];
        let law = agent.law.downcast::<TaskSpaceLaw>();
        law.is_some_and(|law| law.kinematic_adaptation.is_none() && !are_known(agent, law))
    });
    wrong.map_or(KindEvidence::PositiveMatricesTrueLengths, |index| KindEvidence::LengthsNotAdapted {
        agent: Named::of(setup, *index),
    })
}

fn within_bounds(setup: &Setup, index: usize, law: &TaskSpaceLaw) -> Option<KindEvidence> {
    let agent = &setup.agents[index];
    let bounds = law.bounds.as_ref()?;
    let theta = law.tip.parameters(&*agent.robot.kind)?;
    let inside = |k: usize| match (bounds.lower.get(k), bounds.upper.get(k)) {
        (Some(low), Some(high)) => *low <= theta[k] && theta[k] <= *high,
        _ => false,
    };
    let outside = (0..theta.len()).find(|k| !inside(*k));
    Some(outside.map_or(KindEvidence::ParametersInside, |k| KindEvidence::ParameterOutside {
        agent: Named::of(setup, index),
        name: law.kinematic_names.get(k).cloned(),
        value: theta[k],
    }))
}

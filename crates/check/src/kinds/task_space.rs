//! Theorem 6: robots whose tip follows a target by uncertain lengths, without its velocity; and the same by a measured velocity.

use std::sync::Arc;

use forwardstep_core::robot::tree::{Follows, Tree};
use forwardstep_core::robot::{Posture, TipKinematics};
use forwardstep_sim::{AgentSetup, Setup, TaskSpaceLaw, TipSetup};
use nalgebra::DMatrix;

use super::bounds::within_bounds;
use super::spacecraft::never_zero;
use super::start_attitude::{desired, scalar_squared};
use super::{Claim, KindCheck};
use crate::finite::finite;
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

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        let laws = || setup.agents.iter().filter_map(|agent| agent.law.downcast::<TaskSpaceLaw>());
        let some = |follows| laws().any(|law| law.tip.follows() == follows);
        let (theorem, promises) = if laws().any(|law| law.by_velocity) {
            let beside =
                if laws().all(|law| law.by_velocity) { "" } else { "; of the others without it, as of Theorem 6" };
            let promises = "x − x_d → 0 and ẋ − ẋ_d → 0 with uncertain lengths and parameters, by a measured ẋ";
            (Theorem::TipVelocity, format!("{promises}{beside}"))
        } else if some(Follows::RedundantPosition) {
            let more = if some(Follows::Pose) { "; of poses Δp → 0 and Δq_v → 0" } else { "" };
            (
                Theorem::Theorem6Redundant,
                format!(
                    "x − x_d → 0 and ẋ − ẋ_d → 0 with uncertain lengths and parameters, without a measured ẋ, and q̇ − zᵣ → 0: \
                     joints beyond the coordinates move as the null-space term says{more}"
                ),
            )
        } else if some(Follows::Pose) {
            let promises = "Δp → 0, Δq_v → 0 (the attitude is reached, with Δq_o → 1 or −1), and their rates, with uncertain lengths \
                            and parameters, without a measured velocity of the end-effector";
            (Theorem::Theorem6Pose, promises.into())
        } else {
            let promises = "x − x_d → 0 and ẋ − ẋ_d → 0 with uncertain lengths and parameters, without a measured ẋ";
            (Theorem::Theorem6, promises.into())
        };
        Some(Claim { theorem, promises })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = uniform_inertia(setup, agents);
        hypotheses.extend(bounded_dynamics(setup, agents));
        hypotheses.push(Hypothesis::new(Id::TaskSpaceGains, gains(setup, agents)));
        hypotheses.extend(within_bounds(setup, agents));
        for index in agents {
            let agent = &setup.agents[*index];
            let Some(law) = agent.law.downcast::<TaskSpaceLaw>() else { continue };
            let about = |id, evidence| Hypothesis::about(id, Subject::Agent(Named::of(setup, *index)), evidence);
            hypotheses.push(about(Id::RegularJacobian, jacobian(agent, law)));
            hypotheses.extend(attitude(agent, law).map(|evidence| about(Id::StartAttitude, evidence)));
            let reach = within_reach(agent, law, setup.time.end_s);
            let of = || Subject::Agent(Named::of(setup, *index));
            hypotheses.extend(reach.map(|evidence| Hypothesis::about(Id::TargetWithinReach, of(), evidence)));
            if law.tip.follows() == Follows::Pose {
                let path = desired(agent, law).and_then(|path| never_zero(&path, setup.time.end_s));
                hypotheses.extend(path.map(|evidence| Hypothesis::about(Id::NonzeroQuaternion, of(), evidence)));
            }
            hypotheses.extend(uncertain(agent, law).map(|evidence| about(Id::CertainRegressor, evidence)));
            hypotheses.extend(
                lengths_within_bounds(setup, *index, law).map(|evidence| about(Id::LengthsWithinBounds, evidence)),
            );
        }
        hypotheses
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }
}

/// Smallest singular values below this part of the largest are taken for zero, as by the law.
const ROUNDING: f64 = 1e-6;

/// Ĵ must stay away from singularity along the run, which is not known before.
fn jacobian(agent: &AgentSetup, law: &TaskSpaceLaw) -> KindEvidence {
    let Some(j) = with_tip(agent, law, |tip| start(tip, agent, law)).flatten() else { return KindEvidence::NoTip };
    let floor = law.determinant_floor;
    let [smallest, largest] =
        finite(j.clone()).map(|j| j.singular_values()).map_or([f64::NAN; 2], |values| [values.min(), values.max()]);
    if !(smallest.is_finite() && smallest > ROUNDING * largest) {
        KindEvidence::RankDeficient { smallest, largest }
    } else if law.tip.follows() == Follows::Position {
        KindEvidence::Determinant { start: j.determinant(), floor }
    } else {
        KindEvidence::SingularValue { start: smallest, floor }
    }
}

/// The u of length one for which |uᵀĴ| is smallest at the start.
pub(crate) fn left_null(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<Vec<f64>> {
    let svd =
        finite(with_tip(agent, law, |tip| start(tip, agent, law)).flatten()?)?.try_svd(true, false, f64::EPSILON, 0)?;
    Some(svd.u?.column(svd.singular_values.imin()).iter().copied().collect())
}

/// Something of the tip of an agent; nothing for a robot that has no such tip.
fn with_tip<V>(agent: &AgentSetup, law: &TaskSpaceLaw, what: impl FnOnce(&dyn TipKinematics) -> V) -> Option<V> {
    match &law.tip {
        TipSetup::Planar(tip) => law.tip.parameters(&*agent.robot.kind).is_some().then(|| what(tip)),
        TipSetup::Point { .. } => Some(what(&law.tip.of_tree(agent.robot.kind.downcast::<Arc<Tree>>()?)?.ok()?)),
    }
}

/// Ĵ at the start.
fn start(tip: &dyn TipKinematics, agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<DMatrix<f64>> {
    let (n, m, still) = (tip.joints(), tip.rows(), vec![0.0; law.kinematic_start.len()]);
    let (mut j, mut dj) = (vec![0.0; m * n], vec![0.0; m * n]);
    let posture = Posture { q: &agent.start.q, dq: &vec![0.0; n], theta: &law.kinematic_start, d_theta: &still };
    tip.jacobian(posture, &mut j, &mut dj).ok()?;
    Some(DMatrix::from_row_slice(m, n, &j))
}

/// |Δq_o| at the start of a pose, of which the law takes the sign.
fn attitude(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<KindEvidence> {
    let within = scalar_squared(agent, law)?;
    Some(match () {
        () if within.low > 0.0 => KindEvidence::AttitudeApart { scalar: within.low.sqrt().next_down() },
        () if within.high <= 0.0 => KindEvidence::HalfTurn,
        () => KindEvidence::AttitudeNotShown { most: within.high.sqrt().next_up().min(1.0) },
    })
}

/// Y(q, q̇, z, ż) has to be known but for ϑ. That of a tree is stated with all its translations, as they are in the file, and the
/// head of `robot/tree/tip.rs` of the core derives which of them it holds. A planar arm's has no length in it: they are in its ϑ.
fn uncertain(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<KindEvidence> {
    let TipSetup::Point { uncertain, .. } = &law.tip else { return None };
    let tree = agent.robot.kind.downcast::<Arc<Tree>>()?;
    let inside = law.tip.of_tree(tree)?.ok()?.in_regressor();
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

fn lengths_within_bounds(setup: &Setup, index: usize, law: &TaskSpaceLaw) -> Option<KindEvidence> {
    let agent = &setup.agents[index];
    let bounds = law.bounds.as_ref()?;
    let theta = law.tip.parameters(&*agent.robot.kind)?;
    let ends = bounds.lower.iter().zip(&bounds.upper).map(|(low, high)| [*low, *high]);
    let mut own = theta.iter().zip(ends).enumerate();
    let outside = own.find(|(_, (value, [low, high]))| !(low <= *value && *value <= high));
    Some(outside.map_or(KindEvidence::ParametersInside, |(k, (value, bounds))| KindEvidence::ParameterOutside {
        agent: Named::of(setup, index),
        name: law.kinematic_names.get(k).cloned(),
        value: *value,
        bounds,
    }))
}

//! Theorems 6 and 7: a tip with uncertain lengths, and an attitude without angular velocity.

use std::sync::Arc;

use forwardstep_core::plant::Spacecraft;
use forwardstep_core::robot::tree::{Tree, TreeTip, Uncertain};
use forwardstep_core::robot::{Posture, TipKinematics};
use forwardstep_sim::{AgentSetup, AttitudeLaw, Setup, SpacecraftModel, TaskSpaceLaw, TipSetup};
use nalgebra::DMatrix;

use crate::laws::with;
use crate::verdict::{Answer, Hypothesis, rounded};

/// Parts of the run at whose ends a target is looked at.
const LOOKS: u32 = 2000;

/// The smallest norm of a quaternion on its path, as a part of the largest, that is not taken for zero.
const LEAST_NORM: f64 = 1e-6;

/// Theorem 6, agent by agent.
pub(crate) fn task_space(setup: &Setup) -> Vec<Hypothesis> {
    let mut hypotheses = Vec::new();
    for (agent, law) in with::<TaskSpaceLaw>(setup) {
        if hypotheses.is_empty() {
            hypotheses.push(task_gains(setup));
        }
        hypotheses.push(regular(agent, law));
        hypotheses.extend(geometry(agent, law));
        hypotheses.extend(within_bounds(agent, law));
    }
    hypotheses
}

/// det Ĵ at the start.
fn start(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<f64> {
    match &law.tip {
        TipSetup::Planar(tip) => determinant(tip, agent, law),
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

/// Ĵ must stay away from singularity along the run, which nobody knows before.
fn regular(agent: &AgentSetup, law: &TaskSpaceLaw) -> Hypothesis {
    let requires = format!("the estimated Jacobian of {} stays away from singularity", agent.name);
    let (answer, because) = match start(agent, law) {
        Some(det) if det != 0.0 && det.is_finite() => (
            Answer::Watched,
            format!(
                "its determinant starts at {det:.3}; a run ends where it falls below {} of that",
                law.determinant_floor
            ),
        ),
        Some(det) => (Answer::Violated, format!("its determinant starts at {det}")),
        None => (Answer::NotCovered, "the law has no tip of this robot".into()),
    };
    Hypothesis { requires, answer, because }
}

/// Y(q, q̇, z, ż) has to be known but for ϑ. That of a tree is stated with all its translations, as they are in the file, and the
/// head of `robot/tree/tip.rs` of the core derives which of them it holds. A planar arm's has no length in it: they are in its ϑ.
fn geometry(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<Hypothesis> {
    let requires = format!("the regressor of {} depends on nothing uncertain", agent.name);
    let TipSetup::Point { point, coordinates, uncertain } = &law.tip else { return None };
    let tree = agent.robot.kind.downcast::<Arc<Tree>>()?;
    let inside = TreeTip::new((**tree).clone(), point, coordinates, *uncertain).ok()?.in_regressor();
    let names: Vec<&str> =
        law.kinematic_names.iter().zip(inside).filter(|(_, inside)| *inside).map(|(name, _)| name.as_str()).collect();
    let (answer, because) = if names.is_empty() {
        let because = match uncertain {
            Uncertain::Tool => "only the tool is uncertain, which the dynamics do not contain",
            Uncertain::Chain => "none of the lengths that are uncertain enters the dynamics",
        };
        (Answer::Holds, because.to_owned())
    } else if are_known(agent, law) {
        (Answer::Holds, "all lengths are known: they are the true ones and are not adapted".to_owned())
    } else {
        let because = format!(
            "the regressor is that of the true {}, which the law is said not to know; their estimates enter the Jacobian alone",
            names.join(", ")
        );
        (Answer::NotCovered, because)
    };
    Some(Hypothesis { requires, answer, because })
}

/// Whether nothing about the tip is uncertain.
fn are_known(agent: &AgentSetup, law: &TaskSpaceLaw) -> bool {
    law.kinematic_adaptation.is_none()
        && law.tip.parameters(&*agent.robot.kind).is_some_and(|theta| theta == law.kinematic_start)
}

/// Lengths that are not adapted have to be the true ones.
fn task_gains(setup: &Setup) -> Hypothesis {
    let wrong = with::<TaskSpaceLaw>(setup)
        .into_iter()
        .find(|(agent, law)| law.kinematic_adaptation.is_none() && !are_known(agent, law));
    let (answer, because) = match wrong {
        None => {
            (Answer::Holds, "checked when they were read; lengths that are not adapted are the true ones".to_owned())
        }
        Some((agent, _)) => {
            (Answer::NotCovered, format!("{} does not adapt its lengths, which are not the true ones", agent.name))
        }
    };
    Hypothesis {
        requires: "K*, K, Γ and Λ are symmetric positive definite, κ and α are positive".into(),
        answer,
        because,
    }
}

fn within_bounds(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<Hypothesis> {
    let bounds = law.bounds.as_ref()?;
    let theta = law.tip.parameters(&*agent.robot.kind)?;
    let inside = |k: usize| {
        let (low, high) = (bounds.lower.get(k)?, bounds.upper.get(k)?);
        (*low <= theta[k] && theta[k] <= *high).then_some(())
    };
    let outside = (0..theta.len()).find(|k| inside(*k).is_none());
    let (answer, because) = match outside {
        None => (Answer::Holds, "they do, so projection only speeds the proof up".to_owned()),
        Some(k) => {
            let name = law.kinematic_names.get(k).map_or("a length", String::as_str);
            (Answer::NotCovered, format!("{name} is {}, which is outside", theta[k]))
        }
    };
    let requires = format!("the true lengths of {} lie within the bounds of their estimates", agent.name);
    Some(Hypothesis { requires, answer, because })
}

/// Theorem 7, agent by agent.
pub(crate) fn attitude(setup: &Setup) -> Vec<Hypothesis> {
    let mut hypotheses = Vec::new();
    for (agent, _) in with::<AttitudeLaw>(setup) {
        if hypotheses.is_empty() {
            hypotheses.push(Hypothesis {
                requires: "K and Λ_f are symmetric positive definite, α₁ and α₂ are positive".into(),
                answer: Answer::Holds,
                because: "checked when they were read".into(),
            });
        }
        hypotheses.push(momentum(agent));
        hypotheses.extend(path(setup, agent));
    }
    hypotheses
}

/// h_I is given to the controller, not measured.
fn momentum(agent: &AgentSetup) -> Hypothesis {
    let requires = format!("the inertia of {} and its angular momentum h_I are known and constant", agent.name);
    let known = agent.robot.kind.downcast().and_then(|SpacecraftModel { inertia_kg_m2, wheels }| {
        let start = [&agent.start.q[..], &agent.start.dq, &agent.start.rest].concat();
        let plant = Spacecraft::new(*inertia_kg_m2, wheels.clone(), false).ok();
        plant.and_then(|plant| plant.momentum_inertial(&start).ok())
    });
    match known {
        Some([x, y, z]) => {
            let because = format!("h_I = [{x:.4}, {y:.4}, {z:.4}] N m s by the start, and nothing acts from outside");
            Hypothesis { requires, answer: Answer::Holds, because }
        }
        None => Hypothesis { requires, answer: Answer::NotCovered, because: "this is no spacecraft".into() },
    }
}

/// The path of the desired attitude, as a quaternion of any norm, must not pass zero. It stays away from it for ever where
/// one of its entries does; else, on the run, where it cannot get there between two looks, however fast it moves.
fn path(setup: &Setup, agent: &AgentSetup) -> Option<Hypothesis> {
    let target = agent.target.as_ref()?;
    let requires = format!("the quaternion that {} is to follow is never zero", agent.name);
    let away = |axis| {
        let hull = target.hull(axis, 0, None);
        hull.low.max(-hull.high)
    };
    let away = (0..target.axes()).map(away).fold(0.0, f64::max);
    if away > 0.0 {
        let because = format!("one of its entries is never below {} in magnitude", rounded(away));
        return Some(Hypothesis { requires, answer: Answer::Holds, because });
    }
    let end_s = setup.time.end_s;
    let (mut least, mut most, mut when) = (f64::INFINITY, 0.0_f64, 0.0);
    let mut jets = [[0.0; 5]; 4];
    for k in 0..=LOOKS {
        let t_s = end_s * f64::from(k) / f64::from(LOOKS);
        target.jets(t_s, &mut jets);
        let norm = jets.iter().map(|jet| jet[0] * jet[0]).sum::<f64>().sqrt();
        most = most.max(norm);
        if norm < least {
            (least, when) = (norm, t_s);
        }
    }
    let fastest = |axis| {
        let speed = target.hull(axis, 1, Some(end_s));
        speed.high.max(-speed.low)
    };
    let speed = (0..target.axes()).map(fastest).map(|speed| speed * speed).sum::<f64>().sqrt();
    let shown = least - speed * 0.5 * end_s / f64::from(LOOKS);
    let (answer, because) = if shown > 0.0 {
        (Answer::HoldsOnHorizon, format!("its norm stays above {} until the end of the run", rounded(shown)))
    } else if least > LEAST_NORM * most {
        let because =
            format!("at {} s its norm is {}, and no bound above zero could be shown", rounded(when), rounded(least));
        (Answer::NotCovered, because)
    } else {
        (Answer::Violated, format!("at {} s its norm is {least}", rounded(when)))
    };
    Some(Hypothesis { requires, answer, because })
}

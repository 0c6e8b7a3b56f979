//! `[leader]` and `reference.leader` → [`Following`].

use std::sync::Arc;

use forwardstep_core::reference::Choice;
use forwardstep_sim::leader::{Following, FollowingDesign, Leader};

use super::at::At;
use super::fault::{Fault, fault, positive};
use super::file::{ReferenceFile, ScenarioFile};
use super::inputs::InputFolder;
use super::leader_file::{LeaderDesignFile, LeaderReferenceFile, SignFile};
use super::system_problem::SystemProblem;
use super::target::{Owner, target};
use super::value_problem::ValueProblem;

const NAME: &str = "leader";
const SIGN_EVERY_S: f64 = 1e-3;

/// The leader and how it is followed, by agents with these axes; nothing where there is no leader. `folder` is where tables are
/// looked for.
pub(super) fn following(
    file: &ScenarioFile,
    axes: &[String],
    end_s: f64,
    folder: &mut InputFolder,
) -> Result<Option<Arc<Following>>, Fault> {
    let (reference, leader) = match (&file.reference.value, &file.leader) {
        (ReferenceFile::Leader(reference), Some(leader)) => (reference, &leader.value),
        (ReferenceFile::Leader(_), None) => return Err(fault(&file.reference, SystemProblem::NoLeader)),
        (other, Some(leader)) => {
            return Err(fault(leader, SystemProblem::LeaderUnused { reference: other.key() }));
        }
        (_, None) => return Ok(None),
    };
    let name = match &leader.name {
        None => NAME.to_owned(),
        Some(name) => super::agents::checked_name(name)?.to_owned(),
    };
    let trajectory = target(&leader.motion, &Owner { name: &name, axes, end_s }, folder)?;
    let design = match reference.design.value {
        LeaderDesignFile::Continuous => FollowingDesign::Continuous,
        LeaderDesignFile::Differentiable => FollowingDesign::Differentiable,
        LeaderDesignFile::WithoutAcceleration => FollowingDesign::WithoutAcceleration,
        LeaderDesignFile::Swarm => match &reference.coupling {
            Some(coupling) => FollowingDesign::Swarm { coupling: coupling.value },
            None => return Err(fault(&reference.design, ValueProblem::MissingKey { key: "coupling" })),
        },
    };
    if let (Some(coupling), false) = (&reference.coupling, matches!(design, FollowingDesign::Swarm { .. })) {
        return Err(fault(coupling, SystemProblem::CouplingUnused));
    }
    let (alpha, beta) = coefficients(reference, design)?;
    let choice = match reference.sign.as_ref().map(|sign| &sign.value) {
        None | Some(SignFile::Implicit) => Choice::Implicit,
        Some(SignFile::Explicit) => Choice::Explicit,
        Some(SignFile::BoundaryLayer(layer)) => Choice::Layer { width: layer.width.value },
    };
    let layer = matches!(choice, Choice::Layer { .. });
    if let (Some(every), true) = (&reference.sign_period_s, layer || file.control.is_some()) {
        return Err(fault(every, SystemProblem::SignPeriodUnused { layer }));
    }
    Ok(Some(Arc::new(Following {
        leader: Leader { name, trajectory },
        design,
        alpha,
        beta,
        gain: reference.gain.value,
        choice,
        period_s: reference.sign_period_s.as_ref().map_or(SIGN_EVERY_S, |every| every.value),
    })))
}

/// α and β.
fn coefficients(file: &LeaderReferenceFile, design: FollowingDesign) -> Result<(f64, f64), Fault> {
    let list: &At<Vec<At<f64>>> = &file.roots_per_s;
    let mut roots = Vec::with_capacity(2);
    for root in list.value.iter().take(3) {
        roots.push(positive("roots_per_s", root)?);
    }
    match (design, roots.as_slice()) {
        (FollowingDesign::Continuous, [root]) => Ok((*root, 1.0)),
        (FollowingDesign::Continuous, _) => {
            Err(fault(list, SystemProblem::LeaderRoots { found: list.value.len(), need: 1 }))
        }
        (_, [first, second]) => Ok((first * second, first + second)),
        _ => Err(fault(list, SystemProblem::LeaderRoots { found: list.value.len(), need: 2 })),
    }
}

//! Spacecraft that follow an attitude by a filter of its error, which Remark 10 compares Theorem 7 with.

use forwardstep_core::expression::Interval;
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AgentSetup, PassivityFilterLaw, Setup, SpacecraftModel};

use super::spacecraft::{momentum, never_zero};
use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named, Subject};
use crate::theorem::Theorem;

pub(crate) struct FilteredSpacecraft;

impl KindCheck for FilteredSpacecraft {
    fn name(&self) -> &'static str {
        "filtered spacecraft"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<PassivityFilterLaw>()
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "a passivity filter beside Theorem 7"
    }

    fn claim(&self, _: &Setup) -> Option<Claim> {
        Some(Claim {
            theorem: Theorem::PassivityFilter,
            promises: "where the target keeps still, the attitude and its rate reach those of the target, Δq_v → 0 and ω − ω_d → 0, \
                       without a measured ω"
                .into(),
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = vec![Hypothesis::new(Id::PassivityFilterGains, KindEvidence::PositiveMatrices)];
        for index in agents {
            let agent = &setup.agents[*index];
            let subject = || Subject::Agent(Named::of(setup, *index));
            let rest = rest(agent);
            // Beside a target that keeps still the law reads neither M nor h_I.
            if rest != KindEvidence::TargetStill {
                hypotheses.push(Hypothesis::about(Id::KnownMomentum, subject(), momentum(agent)));
            }
            hypotheses.push(Hypothesis::about(Id::TargetAtRest, subject(), rest));
            let path = agent.target.as_ref().and_then(|target| never_zero(target, setup.time.end_s));
            hypotheses.extend(path.map(|evidence| Hypothesis::about(Id::NonzeroQuaternion, subject(), evidence)));
        }
        hypotheses
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }
}

/// Whether ΔωᵀM S(Δω) ω_d vanishes for every Δω.
fn rest(agent: &AgentSetup) -> KindEvidence {
    let Some(SpacecraftModel { inertia_kg_m2, .. }) = agent.robot.kind.downcast() else {
        return KindEvidence::NoSpacecraft;
    };
    if agent.target.as_ref().is_some_and(keeps_still) {
        return KindEvidence::TargetStill;
    }
    let moment = inertia_kg_m2[0][0];
    let entries =
        inertia_kg_m2.iter().enumerate().flat_map(|(row, entries)| entries.iter().enumerate().map(move |of| (row, of)));
    let equal = entries.into_iter().all(|(row, (column, entry))| *entry == if row == column { moment } else { 0.0 });
    if equal { KindEvidence::EqualInertia } else { KindEvidence::TurningTarget }
}

/// Whether every entry is shown to be a constant.
fn keeps_still(target: &Trajectory) -> bool {
    (0..target.axes()).all(|axis| target.hull(axis, 1, None) == Interval { low: 0.0, high: 0.0 })
}

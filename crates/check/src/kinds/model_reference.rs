//! Point masses without a measured velocity by a model and a high gain, which Remark 7 compares (a8) with.

use forwardstep_sim::{AgentSetup, ModelReferenceLaw, Setup};

use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named};
use crate::theorem::Theorem;
use crate::theorems::hurwitz;

pub(crate) struct ModelledMass;

impl KindCheck for ModelledMass {
    fn name(&self) -> &'static str {
        "point-mass-by-a-model"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<ModelReferenceLaw>()
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "model reference control beside Remark 7"
    }

    fn claim(&self, _: &Setup) -> Option<Claim> {
        Some(Claim {
            theorem: Theorem::ModelReference,
            promises: "x − x_d → 0 and dx − dx_d → 0 without a measured velocity".into(),
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let wrong = agents.iter().find(|agent| keeps_a_wrong_mass(&setup.agents[**agent]));
        let evidence = wrong.map_or(KindEvidence::PositiveNumbersTrueMass, |agent| KindEvidence::MassNotAdapted {
            agent: Named::of(setup, *agent),
        });
        let gains = Hypothesis::new(Id::ModelReferenceGains, evidence);
        [gains].into_iter().chain(hurwitz(setup, agents)).collect()
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }
}

fn keeps_a_wrong_mass(agent: &AgentSetup) -> bool {
    agent.law.downcast().is_some_and(|law: &ModelReferenceLaw| {
        law.adaptation == 0.0 && agent.robot.theta.first() != Some(&law.estimate_start)
    })
}

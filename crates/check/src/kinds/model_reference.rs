//! Point masses without a measured velocity by a model and a high gain, which Remark 7 compares (a8) with.

use forwardstep_sim::{AgentSetup, ModelReferenceLaw, Setup};

use super::point_mass::mass_is_known_or_adapted;
use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id};
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
            promises: "x − x_d → 0 and ẋ − ẋ_d → 0 without a measured velocity".into(),
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let learnt = |law: &ModelReferenceLaw| [law.adaptation, law.estimate_start];
        let gains = Hypothesis::new(Id::ModelReferenceGains, mass_is_known_or_adapted(setup, agents, learnt));
        [gains].into_iter().chain(hurwitz(setup, agents)).collect()
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }
}

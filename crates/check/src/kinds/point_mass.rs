//! Point masses without a measured velocity: (a7)–(a9), Remark 7.

use forwardstep_sim::{AgentSetup, Law, PositionOnlyLaw, Setup};

use super::bounds::within_bounds;
use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named};
use crate::theorem::Theorem;
use crate::theorems::hurwitz;

pub(crate) struct PositionOnlyMass;

impl KindCheck for PositionOnlyMass {
    fn name(&self) -> &'static str {
        "point-mass-without-velocity"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<PositionOnlyLaw>()
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "Remark 7"
    }

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        Some(if setup.all_track() {
            Claim {
                theorem: Theorem::PositionOnlyTracks,
                promises: "x − x_d → 0 and ẋ − ẋ_d → 0 without a measured velocity".into(),
            }
        } else {
            Claim {
                theorem: Theorem::PositionOnlyAgree { order: setup.agents.first()?.roots_per_s.len() },
                promises: "all agents agree and come to rest without a measured velocity: xᵢ − xⱼ → 0 and ẋᵢ → 0"
                    .into(),
            }
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let learnt = |law: &PositionOnlyLaw| [law.adaptation, law.estimate_start];
        let gains = Hypothesis::new(Id::PositionOnlyGains, mass_is_known_or_adapted(setup, agents, learnt));
        [gains].into_iter().chain(within_bounds(setup, agents)).chain(hurwitz(setup, agents)).collect()
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        3
    }
}

/// Whether every estimate of a mass is adapted or is the mass, by γ* and m̂(0) of its law.
pub(super) fn mass_is_known_or_adapted<L: Law>(
    setup: &Setup,
    agents: &[usize],
    learnt: impl Fn(&L) -> [f64; 2],
) -> KindEvidence {
    let is_wrong = |agent: &AgentSetup| {
        agent
            .law
            .downcast::<L>()
            .map(&learnt)
            .is_some_and(|[adaptation, start]| adaptation == 0.0 && agent.robot.theta.first() != Some(&start))
    };
    let wrong = agents.iter().find(|agent| is_wrong(&setup.agents[**agent]));
    wrong.map_or(KindEvidence::PositiveNumbersTrueMass, |agent| KindEvidence::MassNotAdapted {
        agent: Named::of(setup, *agent),
    })
}

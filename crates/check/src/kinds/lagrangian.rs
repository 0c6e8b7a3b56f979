//! Lagrangian robots under (6)–(7), or with known parameters. Which theorem it is depends on the reference dynamics.

use forwardstep_sim::{Adaptive, AgentSetup, Known, Setup};

use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, LoopEvidence};

pub(crate) struct LagrangianRobot;

impl KindCheck for LagrangianRobot {
    fn name(&self) -> &'static str {
        "lagrangian"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        is_lagrangian(agent)
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "Theorem 3 with (24)"
    }

    fn claim(&self, _: &Setup) -> Option<Claim> {
        None
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let known = agents.iter().filter(|agent| setup.agents[**agent].law.is::<Known>()).count();
        vec![Hypothesis::new(Id::PositiveGains, LoopEvidence::Gains { known, agents: agents.len() })]
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }

    fn wants_common_order(&self) -> bool {
        true
    }
}

/// Whether (6)–(7), or (6) with known parameters, controls the agent.
pub(crate) fn is_lagrangian(agent: &AgentSetup) -> bool {
    agent.law.is::<Adaptive>() || agent.law.is::<Known>()
}

/// Whether an agent adapts and its estimate starts from zero in every entry.
pub(crate) fn starts_from_zero(agent: &AgentSetup) -> bool {
    agent.law.downcast().is_some_and(|law: &Adaptive| law.estimate_start.iter().all(|entry| *entry == 0.0))
}

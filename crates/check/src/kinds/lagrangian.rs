//! Lagrangian robots under (6)–(7), or with known parameters. Which theorem it is depends on the reference dynamics.

use forwardstep_sim::{AgentSetup, Law, Setup};

use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, LoopEvidence};

pub(crate) struct LagrangianRobot;

impl KindCheck for LagrangianRobot {
    fn name(&self) -> &'static str {
        "lagrangian"
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "Theorem 3 with (24)"
    }

    fn claim(&self, _: &Setup) -> Option<Claim> {
        None
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let known = agents.iter().filter(|agent| matches!(setup.agents[**agent].law, Law::Known { .. })).count();
        vec![Hypothesis::new(Id::PositiveGains, LoopEvidence::Gains { known, agents: agents.len() })]
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }

    fn wants_common_order(&self) -> bool {
        true
    }
}

/// Whether an agent adapts and its estimate starts from zero in every entry.
pub(crate) fn starts_from_zero(agent: &AgentSetup) -> bool {
    matches!(&agent.law, Law::Adaptive { estimate_start, .. } if estimate_start.iter().all(|entry| *entry == 0.0))
}

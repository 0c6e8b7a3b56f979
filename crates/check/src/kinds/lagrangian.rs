//! Lagrangian robots under (6)–(7), or with known parameters. Where they agree, which theorem it is depends on the reference
//! dynamics.

use forwardstep_sim::{Adaptive, AgentSetup, Known, Setup};

use super::bounds::within_bounds;
use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, LoopEvidence, Named, Subject};
use crate::inertia::{bounded_dynamics, is_known, uniform_inertia};
use crate::theorem::Theorem;
use crate::theorems::hurwitz;

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

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        setup.all_track().then(|| Claim {
            theorem: Theorem::RobotsTrack,
            promises: "every robot reaches its target: q − q_d → 0 and q̇ − q̇_d → 0".into(),
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let known = agents.iter().filter(|agent| setup.agents[**agent].law.is::<Known>()).count();
        let gains = Hypothesis::new(Id::PositiveGains, LoopEvidence::Gains { known, agents: agents.len() });
        let from_outside = agents.iter().filter(|agent| !is_known(&setup.agents[**agent]));
        // Who follows a target of its own keeps near it, so that q is bounded, and with it C and g.
        let roaming: Vec<usize> = agents.iter().copied().filter(|agent| !setup.tracks(*agent)).collect();
        let declared = from_outside.map(|agent| three_properties(setup, *agent));
        let inertia = uniform_inertia(setup, agents);
        let bounds = within_bounds(setup, agents);
        let own = declared.chain(inertia).chain(bounded_dynamics(setup, &roaming)).chain([gains]).chain(bounds);
        own.chain(hurwitz(setup, agents)).collect()
    }

    /// ż holds the second one even where one root asks for the first only.
    fn target_derivatives(&self, agent: &AgentSetup) -> usize {
        agent.roots_per_s.len().max(2)
    }
}

/// Whether (6)–(7), or (6) with known parameters, controls the agent.
pub(crate) fn is_lagrangian(agent: &AgentSetup) -> bool {
    agent.law.is::<Adaptive>() || agent.law.is::<Known>()
}

/// That the inertia matrix is positive definite, Ṁ − 2C skew-symmetric and Y θ the dynamics: of a robot from outside, only its
/// author says so, and random states can only refute it.
fn three_properties(setup: &Setup, agent: usize) -> Hypothesis {
    let robot = &setup.agents[agent].robot;
    let probe = robot.kind.lagrangian().and_then(|model| model.probe(robot).ok()).unwrap_or_default();
    let requires = "its robot has the three properties of Section II-B".into();
    let evidence = KindEvidence::Probed { requires, probe };
    Hypothesis::about(Id::Declared, Subject::Agent(Named::of(setup, agent)), evidence)
}

/// Whether an agent adapts and its estimate starts from zero in every entry.
pub(crate) fn starts_from_zero(agent: &AgentSetup) -> bool {
    agent.law.downcast().is_some_and(|law: &Adaptive| law.estimate_start.iter().all(|entry| *entry == 0.0))
}

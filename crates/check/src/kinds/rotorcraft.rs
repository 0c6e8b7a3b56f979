//! Rotorcraft: the outer law of vehicles on a rigid body that torques turn, which the paper does not have.

use forwardstep_core::plant::Rotors;
use forwardstep_sim::{AgentSetup, RotorcraftModel, Setup, ThrustLaw};

use super::vehicle::{self, with_laws};
use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named};

pub(crate) struct Rotorcraft;

impl KindCheck for Rotorcraft {
    fn name(&self) -> &'static str {
        "rotorcraft"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<ThrustLaw>() && agent.robot.kind.is::<RotorcraftModel>()
    }

    fn treated(&self, agent: &AgentSetup) -> &'static str {
        vehicle::treated(agent)
    }

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        vehicle::claim(setup)
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = vehicle::outer_law(setup, agents);
        hypotheses.extend(angular_rate(setup, agents));
        hypotheses.extend(rotors(setup, agents));
        hypotheses
    }

    fn target_derivatives(&self, agent: &AgentSetup) -> usize {
        vehicle::target_derivatives(agent)
    }
}

/// The slowest body.
fn angular_rate(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let slowest = with_laws(setup, agents).min_by(|a, b| a.2.bandwidth_per_s.total_cmp(&b.2.bandwidth_per_s));
    slowest.map(|(index, _, law)| {
        let agent = Named::of(setup, index);
        let evidence = KindEvidence::AngularRate { agent, bandwidth_per_s: law.bandwidth_per_s, design: law.design };
        Hypothesis::new(Id::AngularVelocity, evidence)
    })
}

fn rotors(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let limited = agents.iter().find_map(|index| Some((*index, rotors_of(&setup.agents[*index])?)));
    limited.map(|(index, rotors)| {
        let evidence = KindEvidence::Rotors { agent: Named::of(setup, index), thrust_n: rotors.thrust };
        Hypothesis::new(Id::EveryWrench, evidence)
    })
}

/// The rotors that an agent flies with.
pub(crate) fn rotors_of(agent: &AgentSetup) -> Option<&Rotors> {
    agent.robot.kind.downcast::<RotorcraftModel>()?.rotors.as_ref()
}

//! What stands in a scenario for all agents, or beside a robot, and none of them reads: refused at its place.

use forwardstep_sim::{AgentSetup, RotorcraftModel};

use super::at::At;
use super::fault::{Fault, fault};
use super::file::{AgentReferenceFile, LawFile, ScenarioFile};
use super::start::unread;
use super::system_problem::SystemProblem;

/// The agents of every entry of `[[agents]]`, entry by entry, are `agents`, and so many belong to each.
pub(super) fn unused(file: &ScenarioFile, agents: &[AgentSetup], counts: &[usize]) -> Result<(), Fault> {
    common_start(file, agents)?;
    rate_bandwidth(file, agents, counts)
}

/// A key of the start of all has to say something about somebody.
fn common_start(file: &ScenarioFile, agents: &[AgentSetup]) -> Result<(), Fault> {
    let (Some(start), Some((first, others))) = (&file.start, agents.split_first()) else { return Ok(()) };
    let in_vain =
        |key: &str, agent: &AgentSetup| unread(&agent.robot, &start.value).iter().any(|(other, _)| *other == key);
    let mut keys = unread(&first.robot, &start.value).into_iter();
    match keys.find(|(key, _)| others.iter().all(|agent| in_vain(key, agent))) {
        None => Ok(()),
        Some((key, span)) => Err(Fault::new(SystemProblem::StartUnused { key, agent: first.name.clone() }).at(&span)),
    }
}

/// Only the bodies of rotorcraft have to be turned.
fn rate_bandwidth(file: &ScenarioFile, agents: &[AgentSetup], counts: &[usize]) -> Result<(), Fault> {
    let bandwidth = |law: &'_ Option<At<LawFile>>| match law.as_ref().map(|law| &law.value) {
        Some(LawFile::Thrust(thrust)) => thrust.rate_bandwidth_per_s.clone(),
        _ => None,
    };
    let turned = |agent: &AgentSetup| agent.robot.kind.is::<RotorcraftModel>();
    let mut first = 0;
    for (entry, count) in file.agents.value.iter().zip(counts) {
        let own = agents.get(first..first + count).unwrap_or_default();
        first += count;
        if let (Some(place), Some(agent)) = (bandwidth(&entry.value.law), own.iter().find(|agent| !turned(agent))) {
            return Err(fault(&place, SystemProblem::RateBandwidthUnused { agent: agent.name.clone() }));
        }
    }
    match (bandwidth(&file.law), agents.first()) {
        (Some(place), Some(agent)) if !agents.iter().any(turned) => {
            Err(fault(&place, SystemProblem::RateBandwidthUnused { agent: agent.name.clone() }))
        }
        _ => Ok(()),
    }
}

/// Roots that stand for all agents that track are those of the agents whose laws have roots, if there are any.
pub(super) fn spare_roots(file: &ScenarioFile, agents: &mut [AgentSetup], counts: &[usize]) {
    let rootless = |agent: &AgentSetup| agent.interface().is_some_and(|interface| !interface.tracks_by_roots);
    if agents.iter().all(rootless) {
        return;
    }
    let mut rest = agents;
    for (entry, count) in file.agents.value.iter().zip(counts) {
        let (own, others) = rest.split_at_mut((*count).min(rest.len()));
        rest = others;
        let stated = match entry.value.reference.as_ref().map(|own| &own.value) {
            Some(AgentReferenceFile::Tracking(own)) => own.roots_per_s.is_some(),
            _ => false,
        };
        own.iter_mut().filter(|agent| !stated && rootless(agent)).for_each(|agent| agent.roots_per_s.clear());
    }
}

//! Roots that stand in a scenario for all agents, beside laws that read none.

use forwardstep_sim::AgentSetup;

use super::file::{AgentReferenceFile, ScenarioFile};

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

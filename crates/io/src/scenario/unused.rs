//! Roots that stand in a scenario for all agents, beside laws that read none.

use forwardstep_sim::AgentSetup;

/// Roots that stand for all agents that track are those of the agents whose laws have roots, if there are any. `entries` has, for
/// each entry of `[[agents]]`, how many agents it stands for, and whether it states roots of its own.
pub(super) fn spare_roots(agents: &mut [AgentSetup], entries: impl Iterator<Item = (usize, bool)>) {
    let rootless = |agent: &AgentSetup| agent.interface().is_some_and(|interface| !interface.tracks_by_roots);
    if agents.iter().all(rootless) {
        return;
    }
    let mut rest = agents;
    for (count, stated) in entries {
        let (own, others) = rest.split_at_mut(count.min(rest.len()));
        rest = others;
        own.iter_mut().filter(|agent| !stated && rootless(agent)).for_each(|agent| agent.roots_per_s.clear());
    }
}

//! Estimates that are kept within bounds: the parameters have to lie there, whichever law it is.

use forwardstep_sim::Setup;

use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named};

/// That ϑ lies within the bounds that ϑ̂ is kept within, of all agents with such bounds.
pub(super) fn within_bounds(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let bounded = agents.iter().filter_map(|index| {
        let bounds = setup.agents[*index].law.kept_within()?;
        let ends = bounds.lower.iter().zip(&bounds.upper).map(|(low, high)| [*low, *high]);
        let mut theta = setup.agents[*index].robot.theta.iter().zip(ends).enumerate();
        Some((*index, theta.find(|(_, (own, [low, high]))| !(low <= *own && *own <= high))))
    });
    let bounded: Vec<_> = bounded.collect();
    let outside = bounded.iter().find_map(|(index, outside)| Some((*index, (*outside)?)));
    let evidence = outside.map_or(KindEvidence::ParametersInside, |(index, (k, (value, bounds)))| {
        let name = setup.agents[index].robot.theta_names.get(k).cloned();
        KindEvidence::ParameterOutside { agent: Named::of(setup, index), name, value: *value, bounds }
    });
    (!bounded.is_empty()).then(|| Hypothesis::new(Id::ParametersWithinBounds, evidence))
}

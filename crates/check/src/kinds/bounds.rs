//! Estimates that are kept within bounds: the parameters have to lie there, whichever law it is.

use forwardstep_sim::Setup;

use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named};

/// That ϑ lies within the bounds that ϑ̂ is kept within, of all agents with such bounds.
pub(super) fn within_bounds(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let bounded = agents.iter().filter_map(|index| {
        let bounds = setup.agents[*index].law.kept_within()?;
        let ends = bounds.lower.iter().zip(&bounds.upper);
        let theta = setup.agents[*index].robot.theta.iter();
        Some((*index, theta.zip(ends).position(|(own, (low, high))| !(low <= own && own <= high))))
    });
    let bounded: Vec<(usize, Option<usize>)> = bounded.collect();
    let outside = bounded.iter().find_map(|(index, outside)| Some((*index, (*outside)?)));
    let evidence = outside.map_or(KindEvidence::ParametersInside, |(index, k)| KindEvidence::ParameterOutside {
        agent: Named::of(setup, index),
        name: setup.agents[index].robot.theta_names.get(k).cloned(),
        value: setup.agents[index].robot.theta[k],
    });
    (!bounded.is_empty()).then(|| Hypothesis::new(Id::ParametersWithinBounds, evidence))
}

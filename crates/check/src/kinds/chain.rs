//! Chains of Section IV: what (43) with its second steps asks for.

use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::CascadeTerms;
use forwardstep_sim::push::{Course, Function, Push};
use forwardstep_sim::{AgentSetup, ChainLaw, ChainModel, ChainStep, Law, Setup};

use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named};
use crate::surroundings::acts;
use crate::theorem::Theorem;

pub(crate) struct Chain;

impl KindCheck for Chain {
    fn name(&self) -> &'static str {
        "chain"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<ChainLaw>()
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "Section IV"
    }

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        let all: Vec<usize> = (0..setup.agents.len()).collect();
        let mut steps: Vec<&str> = chains(setup, &all).map(|(_, law, _)| law.words().name).collect();
        steps.dedup();
        Some(if setup.all_track() {
            Claim {
                theorem: Theorem::ChainsTrack(steps),
                promises: "x − x_d → 0 with its derivatives below the order of the plant".into(),
            }
        } else {
            Claim {
                theorem: Theorem::ChainsAgree(steps),
                promises: "all agents agree and come to rest, whatever their orders: x_i − x_j → 0 and dx_i → 0".into(),
            }
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = vec![input_factor(setup, agents), gains(setup, agents)];
        hypotheses.extend(regressors(setup, agents));
        hypotheses.extend(disturbances(setup, agents));
        hypotheses
    }

    fn target_derivatives(&self, agent: &AgentSetup) -> usize {
        agent.roots_per_s.len()
    }
}

/// Agents with their laws and models.
fn chains<'a>(setup: &'a Setup, agents: &'a [usize]) -> impl Iterator<Item = (usize, &'a ChainLaw, &'a ChainModel)> {
    agents.iter().filter_map(|index| {
        let agent = &setup.agents[*index];
        Some((*index, agent.law.downcast()?, agent.robot.kind.downcast()?))
    })
}

/// The value of an expression without variables.
fn constant(expression: &Expression) -> Option<f64> {
    (expression.variables() == 0).then(|| expression.value(&[]))
}

fn input_factor(setup: &Setup, agents: &[usize]) -> Hypothesis {
    let fixed = |model: &ChainModel| match model {
        ChainModel::Derivatives(terms) => constant(terms.input()),
        ChainModel::Cascade(terms) => constant(terms.input()).filter(|_| terms.is_strict()),
    };
    // What is constant is known before the run, and may be too small from the start.
    let vanishing = chains(setup, agents).find_map(|(index, law, model)| {
        let value = fixed(model).filter(|value| value.is_nan() || value.abs() < law.floor)?;
        Some(KindEvidence::FactorBelowFloor { agent: Named::of(setup, index), value, floor: law.floor })
    });
    if let Some(evidence) = vanishing {
        return Hypothesis::new(Id::InputFactor, evidence);
    }
    let evidence = match chains(setup, agents).find(|(.., model)| fixed(model).is_none()) {
        None => KindEvidence::ConstantFactor,
        Some((index, law, _)) => KindEvidence::FactorFloor { agent: Named::of(setup, index), floor: law.floor },
    };
    Hypothesis::new(Id::InputFactor, evidence)
}

fn gains(setup: &Setup, agents: &[usize]) -> Hypothesis {
    let estimates = chains(setup, agents).any(|(_, law, _)| law.estimates());
    let id = if estimates { Id::ChainAdaptation } else { Id::ChainGains };
    Hypothesis::new(id, KindEvidence::PositiveNumbers)
}

/// Only of the last equation of a strict-feedback chain is it known what a disturbance does to V.
fn disturbances(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let pushed = |index: usize| setup.agents[index].pushes.iter().filter(|push| acts(push));
    let mut disturbed = chains(setup, agents)
        .filter_map(|(index, _, model)| match model {
            ChainModel::Cascade(terms) => pushed(index).next().map(|_| (index, terms)),
            ChainModel::Derivatives(_) => None,
        })
        .peekable();
    disturbed.peek()?;
    let last_only = |push: &Push, order: usize| match push.course() {
        Course::Each(all) => all.iter().take(order - 1).all(|one| *one == Function::Constant(0.0)),
        Course::Table(table) => {
            let earlier = |row: &[f64]| row.iter().take(order - 1).all(|value| *value == 0.0);
            table.values.chunks(order).all(earlier)
        }
    };
    let unmatched = |(index, terms): &(usize, &Arc<CascadeTerms>)| {
        !terms.is_strict() || !pushed(*index).all(|push| last_only(push, terms.order()))
    };
    let found = disturbed.find(unmatched).map(|(index, _)| Named::of(setup, index));
    let evidence = found.map_or(KindEvidence::Matched, |agent| KindEvidence::Unmatched { agent });
    Some(Hypothesis::new(Id::MatchedDisturbance, evidence))
}

/// Adaptation by the gradient needs φ bounded along the run for s → 0.
fn regressors(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let by_gradient = |law: &ChainLaw| match law.step {
        ChainStep::Adaptive { .. } | ChainStep::Backstepping { .. } => true,
        ChainStep::Linearising { .. } | ChainStep::Immersion { .. } => false,
    };
    let needs = |law: &ChainLaw, model: &ChainModel| by_gradient(law) && model.parameters() > 0;
    let (index, ..) = chains(setup, agents).find(|(_, law, model)| needs(law, model))?;
    Some(Hypothesis::new(Id::BoundedRegressors, KindEvidence::BoundedStates { agent: Named::of(setup, index) }))
}

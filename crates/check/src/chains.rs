//! Chains of Section IV: what (43) with its second steps asks for.

use forwardstep_core::expression::{Expression, Graph, Programme};
use forwardstep_sim::{AgentSetup, ChainLaw, ChainModel, ChainStep, Law, ReferenceKind, Setup};

use crate::verdict::{Answer, Hypothesis};

/// Agents with a law for chains.
fn chains(setup: &Setup) -> impl Iterator<Item = (&AgentSetup, &ChainLaw, &ChainModel)> {
    setup.agents.iter().filter_map(|agent| Some((agent, agent.law.downcast()?, agent.robot.kind.downcast()?)))
}

/// What speaks about agents that are all chains, and what it promises.
pub(crate) fn theorem(setup: &Setup) -> (String, String) {
    let mut steps: Vec<&str> = chains(setup).map(|(_, law, _)| law.words()).collect();
    steps.dedup();
    let steps = steps.join(", ");
    match setup.reference {
        ReferenceKind::Tracking => (
            format!("Section IV, (43) for tracking; second step: {steps}"),
            "x − x_d → 0 with its derivatives below the order of the plant".into(),
        ),
        _ => (
            format!("Section IV, (43) with (24) as in Theorem 3; second step: {steps}"),
            "all agents agree and come to rest, whatever their orders: x_i − x_j → 0 and dx_i → 0".into(),
        ),
    }
}

/// What the laws for chains ask for.
pub(crate) fn of_chains(setup: &Setup) -> Vec<Hypothesis> {
    if chains(setup).next().is_none() {
        return Vec::new();
    }
    let mut hypotheses = vec![divisor(setup), gains(setup)];
    hypotheses.extend(regressors(setup));
    hypotheses
}

/// The value of an expression without variables.
fn constant(expression: &Expression) -> Option<f64> {
    if expression.variables() > 0 {
        return None;
    }
    let mut graph = Graph::new(0);
    let node = graph.import(expression).ok()?;
    let programme = Programme::new(&graph, &[node]).ok()?;
    let mut value = [f64::NAN];
    programme.evaluate(&[], &mut programme.registers(), &mut value).ok()?;
    Some(value[0])
}

fn divisor(setup: &Setup) -> Hypothesis {
    let fixed = |model: &ChainModel| match model {
        ChainModel::Derivatives(terms) => constant(terms.input()),
        ChainModel::Cascade(terms) => constant(terms.input()).filter(|_| terms.is_strict()),
    };
    // What is constant is known before the run, and may be too small from the start.
    let small = |law: &ChainLaw, value: f64| value.is_nan() || value.abs() < law.floor;
    let vanishing = chains(setup).find_map(|(agent, law, model)| {
        fixed(model).filter(|value| small(law, *value)).map(|value| (agent, law, value))
    });
    if let Some((agent, law, value)) = vanishing {
        return Hypothesis {
            requires: "the factor of the input stays away from zero".into(),
            answer: Answer::Violated,
            because: format!(
                "that of {} is {value} for ever, which is less than its floor of {}",
                agent.name, law.floor
            ),
        };
    }
    let (answer, because) = match chains(setup).find(|(.., model)| fixed(model).is_none()) {
        None => (Answer::Holds, "it is constant".to_owned()),
        Some((agent, law, _)) => (
            Answer::Watched,
            format!("the run ends where that of {} comes closer to zero than {}", agent.name, law.floor),
        ),
    };
    Hypothesis { requires: "the factor of the input stays away from zero".into(), answer, because }
}

fn gains(setup: &Setup) -> Hypothesis {
    let estimates = chains(setup).any(|(_, law, _)| law.estimates());
    let requires = if estimates { "the gains of the laws and Γ are positive" } else { "the gains are positive" };
    Hypothesis { requires: requires.into(), answer: Answer::Holds, because: "checked when they were read".into() }
}

/// Adaptation by the gradient needs φ bounded along the run for s → 0.
fn regressors(setup: &Setup) -> Option<Hypothesis> {
    let needs = |law: &ChainLaw, model: &ChainModel| {
        matches!(law.step, ChainStep::Adaptive { .. } | ChainStep::Backstepping { .. }) && model.parameters() > 0
    };
    let (agent, ..) = chains(setup).find(|(_, law, model)| needs(law, model))?;
    Some(Hypothesis {
        requires: "regressors and their derivatives are bounded along the run".into(),
        answer: Answer::Watched,
        because: format!(
            "a run that is completed keeps the states of {} bounded, and with them its regressors",
            agent.name
        ),
    })
}

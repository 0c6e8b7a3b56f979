//! Chains of Section IV: what (43) with its second steps asks for.

use std::sync::Arc;

use forwardstep_core::controller::Singularity;
use forwardstep_core::expression::{Domain, Expression, Graph, Interval, Intervals};
use forwardstep_core::plant::CascadeTerms;
use forwardstep_sim::probe::singular_start;
use forwardstep_sim::push::{Course, Function, Push};
use forwardstep_sim::{AgentSetup, ChainLaw, ChainModel, ChainStep, Law, Setup};

use super::bounds::within_bounds;
use super::matrix_factor;
use super::{Claim, KindCheck};
use crate::hypothesis::{FactorEverywhere, Hypothesis, Id, KindEvidence, Named, Term};
use crate::surroundings::acts;
use crate::theorem::Theorem;
use crate::theorems::hurwitz;

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
                promises: "all agents agree and come to rest, whatever their orders: xᵢ − xⱼ → 0 and ẋᵢ → 0".into(),
            }
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = vec![defined(setup, agents), input_factor(setup, agents), gains(setup, agents)];
        hypotheses.extend(regressors(setup, agents));
        hypotheses.extend(within_bounds(setup, agents));
        hypotheses.extend(disturbances(setup, agents));
        hypotheses.extend(hurwitz(setup, agents));
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

/// The value of an expression without variables, from its exact value: 0.1 + 0.2 − 0.3 is zero.
fn constant(expression: &Expression) -> Option<f64> {
    let value = || expression.constant().map_or(f64::NAN, |number| number.value());
    (expression.variables() == 0).then(value)
}

/// The terms of a chain, each with what it is.
fn terms(model: &ChainModel) -> Vec<(Term, &Expression)> {
    let named = |term: Term| move |expression| (term, expression);
    match model {
        ChainModel::Derivatives(terms) => {
            let regressors = terms.regressor().iter().map(named(Term::Regressor));
            [(Term::Drift, terms.drift()), (Term::Factor, terms.input())].into_iter().chain(regressors).collect()
        }
        ChainModel::Vector(terms) => {
            let drift = terms.drift().iter().map(named(Term::Drift));
            let factor = terms.input().iter().flatten().map(named(Term::Factor));
            drift.chain(factor).chain(terms.regressor().iter().flatten().map(named(Term::Regressor))).collect()
        }
        ChainModel::Cascade(terms) => {
            let regressors = terms.regressors().iter().flatten().map(named(Term::Regressor));
            let known = terms.known().iter().map(named(Term::Drift));
            known.chain([(Term::Factor, terms.input())]).chain(regressors).collect()
        }
    }
}

/// The terms of the chains of these agents, each once, since like agents share their model: whose, what it is, itself.
fn distinct_terms<'a>(setup: &'a Setup, agents: &'a [usize]) -> Vec<(usize, Term, &'a Expression)> {
    let mut seen: Vec<(usize, Term, &Expression)> = Vec::new();
    for (index, _, model) in chains(setup, agents) {
        for (term, expression) in terms(model) {
            if seen.iter().all(|(.., known)| *known != expression) {
                seen.push((index, term, expression));
            }
        }
    }
    seen
}

/// Whether all terms have a value wherever the state may go: the worst of what is found.
fn defined(setup: &Setup, agents: &[usize]) -> Hypothesis {
    let mut evidence = KindEvidence::TermsDefined;
    for (index, term, expression) in distinct_terms(setup, agents) {
        match expression.domain() {
            Domain::Everywhere if expression.bears_derivatives(taken(setup, index)) => {}
            Domain::Everywhere => {
                evidence = KindEvidence::TermNotSmooth {
                    agent: Named::of(setup, index),
                    term,
                    derivatives: taken(setup, index),
                };
            }
            Domain::NotShown => evidence = KindEvidence::TermNotShown { agent: Named::of(setup, index), term },
            Domain::Fails { at, gap } => {
                let evidence = KindEvidence::TermFails { agent: Named::of(setup, index), term, at, gap };
                return Hypothesis::new(Id::DefinedTerms, evidence);
            }
        }
    }
    Hypothesis::new(Id::DefinedTerms, evidence)
}

/// How many derivatives backstepping takes of the terms of an agent, at most: of a strict-feedback chain one fewer than there are equations, of
/// a pure-feedback chain, whose factors are derivatives themselves, as many. None elsewhere.
fn taken(setup: &Setup, index: usize) -> usize {
    match setup.agents[index].robot.kind.downcast() {
        Some(ChainModel::Cascade(terms)) => terms.order() - usize::from(terms.is_strict()),
        Some(ChainModel::Derivatives(_) | ChainModel::Vector(_)) | None => 0,
    }
}

/// A chain of which a term has no value in a state, and the state.
pub(crate) fn undefined_state(setup: &Setup) -> Option<(usize, Vec<f64>)> {
    let agents: Vec<usize> = (0..setup.agents.len()).collect();
    distinct_terms(setup, &agents).into_iter().find_map(|(index, _, expression)| match expression.domain() {
        Domain::Fails { at, .. } if !expression.value(&at).is_finite() => Some((index, at)),
        Domain::Fails { at, .. } => Some((index, undefined_beside(expression, at.len())?)),
        Domain::Everywhere | Domain::NotShown => None,
    })
}

/// A state of simple numbers in which a term has no value: where a divisor passes zero, numbers that are rounded seldom meet it.
fn undefined_beside(expression: &Expression, states: usize) -> Option<Vec<f64>> {
    const SIMPLE: [f64; 7] = [0.0, 1.0, -1.0, 0.5, -0.5, 2.0, -2.0];
    let most = SIMPLE.len().checked_pow(u32::try_from(states).ok()?).filter(|most| *most <= 20_000)?;
    let digit = |number: usize, place: usize| SIMPLE[number / SIMPLE.len().pow(place as u32) % SIMPLE.len()];
    let state = |number: usize| (0..states).map(|place| digit(number, place)).collect::<Vec<f64>>();
    (0..most).map(state).find(|state| !expression.value(state).is_finite())
}

fn input_factor(setup: &Setup, agents: &[usize]) -> Hypothesis {
    let all = || chains(setup, agents).map(|(index, law, model)| (index, law.floor, factor(model)));
    // What is constant is known before the run, and may be too small from the start.
    let vanishing = all().find_map(|(index, floor, factor)| {
        let agent = Named::of(setup, index);
        match factor {
            Factor::Number(input) => {
                let value = constant(input).filter(|value| value.is_nan() || value.abs() < floor)?;
                Some(KindEvidence::FactorBelowFloor { agent, value, floor })
            }
            Factor::Matrix(input) => matrix_factor::null_vector(input).map(|_| KindEvidence::FactorSingular { agent }),
            Factor::More(terms) => unmoved(terms).map(|equation| KindEvidence::Unmoved { agent, equation }),
        }
    });
    let vanishing =
        vanishing.or_else(|| all().find_map(|(index, floor, factor)| at_start(setup, index, floor, factor)));
    if let Some(evidence) = vanishing {
        return Hypothesis::new(Id::InputFactor, evidence);
    }
    let is_constant = |factor: &Factor<'_>| matches!(factor, Factor::Number(input) if constant(input).is_some());
    let (mut smallest, mut any_matrix) = (f64::INFINITY, false);
    for (index, floor, factor) in all().filter(|(.., factor)| !is_constant(factor)) {
        let matrix = matches!(factor, Factor::Matrix(_));
        match everywhere(factor) {
            FactorEverywhere::Away { least } if least >= floor => smallest = smallest.min(least),
            everywhere @ (FactorEverywhere::Away { .. }
            | FactorEverywhere::Fades
            | FactorEverywhere::Zero(_)
            | FactorEverywhere::Slopes
            | FactorEverywhere::Unknown) => {
                let agent = Named::of(setup, index);
                let evidence = KindEvidence::FactorFloor { agent, floor, everywhere, matrix };
                return Hypothesis::new(Id::InputFactor, evidence);
            }
        }
        any_matrix |= matrix;
    }
    let evidence = match smallest.is_finite() {
        true => KindEvidence::FactorAway { least: smallest, matrix: any_matrix },
        false => KindEvidence::ConstantFactor,
    };
    Hypothesis::new(Id::InputFactor, evidence)
}

/// What a law divides by.
enum Factor<'a> {
    Number(&'a Expression),
    /// Whose smallest singular value counts.
    Matrix(&'a [Vec<Expression>]),
    /// Of a chain that is not strict: more than the last equation says.
    More(&'a CascadeTerms),
}

fn factor(model: &ChainModel) -> Factor<'_> {
    match model {
        ChainModel::Derivatives(terms) => Factor::Number(terms.input()),
        ChainModel::Vector(terms) => Factor::Matrix(terms.input()),
        ChainModel::Cascade(terms) if terms.is_strict() => Factor::Number(terms.input()),
        ChainModel::Cascade(terms) => Factor::More(terms),
    }
}

/// An equation of a chain whose slope along the state that is to move it is zero, whatever ϑ is.
pub(crate) fn unmoved(terms: &CascadeTerms) -> Option<usize> {
    let mut equations = terms.known().iter().zip(terms.regressors()).take(terms.order().saturating_sub(1)).enumerate();
    let unmoved = equations.find(|(k, (known, row))| {
        let mut all = std::iter::once(*known).chain(row.iter());
        all.all(|expression| !expression.has(k + 1) || is_level(expression, k + 1))
    });
    unmoved.map(|(k, _)| k)
}

/// Whether the slope along a variable is seen to be zero, as that of 0 x is. Of what has kinks nothing is seen.
fn is_level(expression: &Expression, along: usize) -> bool {
    let mut graph = Graph::new(expression.variables());
    let slope = graph.import(expression).and_then(|value| graph.derivative(value, along));
    slope.is_ok_and(|slope| slope == graph.zero())
}

/// A factor that is below its floor where the run begins.
fn at_start(setup: &Setup, index: usize, floor: f64, factor: Factor<'_>) -> Option<KindEvidence> {
    let agent = || Named::of(setup, index);
    let Factor::Number(input) = factor else {
        // A singular value, or a product of slopes: by the law itself.
        let Singularity::Vanishes { value, floor, .. } = singular_start(setup, index).ok()??;
        return Some(KindEvidence::FactorAtStart { agent: agent(), value, floor });
    };
    let start = &setup.agents[index].start;
    let state: Vec<Interval> =
        start.q.iter().chain(&start.dq).chain(&start.rest).map(|x| Interval::point(*x)).collect();
    let value = input.fold(&mut Intervals(&state));
    let below = value.low <= value.high && value.low > -floor && value.high < floor;
    below.then(|| KindEvidence::FactorAtStart { agent: agent(), value: 0.5 * (value.low + value.high), floor })
}

/// What is known of a factor over all states.
fn everywhere(factor: Factor<'_>) -> FactorEverywhere {
    let input = match factor {
        Factor::Number(input) => input,
        Factor::Matrix(input) => {
            let least = matrix_factor::least_everywhere(input);
            return if least > 0.0 { FactorEverywhere::Away { least } } else { FactorEverywhere::Unknown };
        }
        Factor::More(_) => return FactorEverywhere::Slopes,
    };
    let (within, nonzero) = input.everywhere();
    let least = within.low.max(-within.high);
    match () {
        () if nonzero && least > 0.0 => FactorEverywhere::Away { least },
        () if nonzero => FactorEverywhere::Fades,
        () => input.zero().map_or(FactorEverywhere::Unknown, FactorEverywhere::Zero),
    }
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
            ChainModel::Derivatives(_) | ChainModel::Vector(_) => None,
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

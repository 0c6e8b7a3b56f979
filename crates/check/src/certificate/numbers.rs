//! Hypotheses that a number, or a list of classes, shows.

use forwardstep_core::expression::{Expression, Interval, Intervals, Number};
use forwardstep_sim::graph::strong_components;
use forwardstep_sim::{AgentSetup, ChainLaw, ChainModel, Setup};
use nalgebra::DMatrix;
use num_rational::BigRational;

use super::producers::Claim;
use super::proof::Proof;
use crate::Answer;
use crate::finite::finite;
use crate::kinds::chain::{undefined_state, unmoved};
use crate::kinds::matrix_factor::null_vector;
use crate::surroundings::last_end_s;
use crate::theorems::certainly_slowest_per_s;

/// A number that proves what holds.
fn number(claim: &Claim<'_>, value: Option<BigRational>) -> Option<Proof> {
    value.filter(|_| claim.answer == Answer::Holds).map(Proof::Number)
}

pub(super) fn real_roots(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let slowest = setup.agents.iter().filter_map(|agent| agent.roots_per_s.slowest_per_s());
    number(claim, slowest.reduce(f64::min).map(Number::written))
}

/// A line to the left of which all roots lie. Those of a leader's reference dynamics are kept by coefficients.
pub(super) fn hurwitz(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let tracking = setup.agents.iter().enumerate().filter(|(agent, _)| setup.tracks(*agent));
    let own = tracking.filter_map(|(_, agent)| agent.roots_per_s.slowest_per_s());
    let led = setup.following().map(certainly_slowest_per_s);
    number(claim, own.chain(led).reduce(f64::min).map(Number::written))
}

pub(super) fn common_order(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let order = setup.agents.first()?.roots_per_s.len();
    number(claim, Some(BigRational::from_integer(order.into())))
}

pub(super) fn manipulability(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let gains = setup.agents.iter().map(|agent| agent.manipulability);
    number(claim, gains.reduce(f64::max).map(Number::written))
}

pub(super) fn pushes_end(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let last_s = last_end_s(setup);
    // The end is a sum of two numbers as they are written, rounded once.
    let rounded_s = if last_s.fract() == 0.0 { last_s } else { last_s.next_up() };
    number(claim, last_s.is_finite().then(|| Number::written(rounded_s)))
}

/// The strongly connected components of the union of all graphs, sorted so that no edge leads back.
pub(super) fn common_first_root(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer != Answer::Holds {
        return None;
    }
    let recurring = setup.network.schedule.recurring_graphs();
    let edges: Vec<(usize, usize)> = recurring.iter().flatten().map(|edge| (edge.from, edge.to)).collect();
    let components = strong_components(setup.network.agents, &edges);
    let first_root = |agent: &AgentSetup| agent.roots_per_s.first_real();
    let common = |component: &Vec<usize>| {
        let mut roots = component.iter().map(|agent| setup.agents.get(*agent).and_then(first_root));
        let first = roots.next().flatten();
        roots.all(|root| root == first)
    };
    if !components.iter().all(common) {
        return Some(Proof::Constant);
    }
    let mut home = vec![0; setup.network.agents];
    for (index, component) in components.iter().enumerate() {
        component.iter().for_each(|agent| home[*agent] = index);
    }
    let between = edges.iter().map(|(from, to)| (home[*from], home[*to])).filter(|(from, to)| from != to);
    let order = sorted(components.len(), &between.collect::<Vec<_>>());
    Some(Proof::Classes(order.into_iter().map(|index| components[index].clone()).collect()))
}

/// The vertices of a graph without cycles, each after all that lead to it.
fn sorted(vertices: usize, edges: &[(usize, usize)]) -> Vec<usize> {
    let (mut open, mut next) = (vec![0_usize; vertices], vec![Vec::new(); vertices]);
    for (from, to) in edges {
        open[*to] += 1;
        next[*from].push(*to);
    }
    let mut order: Vec<usize> = (0..vertices).filter(|vertex| open[*vertex] == 0).collect();
    let mut at = 0;
    while let Some(vertex) = order.get(at).copied() {
        at += 1;
        for to in &next[vertex] {
            open[*to] -= 1;
            if open[*to] == 0 {
                order.push(*to);
            }
        }
    }
    order
}

pub(super) fn input_factor(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    match claim.answer {
        Answer::Holds => Some(Proof::FactorAway),
        Answer::Violated => {
            let small = setup.agents.iter().position(|agent| small_factor(agent) == Some(true));
            let null = || {
                let mut agents = setup.agents.iter().enumerate();
                agents.find_map(|(index, agent)| Some(Proof::NullVector(index, null_vector(matrix_of(agent)?)?, None)))
            };
            let unmoved = || {
                let mut agents = setup.agents.iter().enumerate();
                agents.find_map(|(index, agent)| match agent.robot.kind.downcast()? {
                    ChainModel::Cascade(terms) if !terms.is_strict() => Some(Proof::Unmoved(index, unmoved(terms)?)),
                    ChainModel::Cascade(_) | ChainModel::Derivatives(_) | ChainModel::Vector(_) => None,
                })
            };
            let somewhere = || {
                let mut agents = setup.agents.iter().enumerate();
                agents.find_map(|(index, agent)| Some(Proof::SmallFactor(index, Some(small_in(agent)?))))
            };
            let shortened = || {
                let mut agents = setup.agents.iter().enumerate();
                agents.find_map(|(index, agent)| {
                    let (vector, state) = shortened(agent)?;
                    Some(Proof::NullVector(index, written(vector), Some(written(state))))
                })
            };
            let constant = small.map(|agent| Proof::SmallFactor(agent, None)).or_else(null).or_else(unmoved);
            constant.or_else(somewhere).or_else(shortened)
        }
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// That the terms of chains have values everywhere is seen from the text; that one has none, from a state.
pub(super) fn defined_terms(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    match claim.answer {
        Answer::Holds => Some(Proof::Text),
        Answer::Violated => {
            let (agent, state) = undefined_state(setup)?;
            Some(Proof::NoValue(agent, written(state)))
        }
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// The factor of the input of a plant with several axes.
fn matrix_of(agent: &AgentSetup) -> Option<&[Vec<Expression>]> {
    match agent.robot.kind.downcast()? {
        ChainModel::Vector(terms) => Some(terms.input()),
        ChainModel::Derivatives(_) | ChainModel::Cascade(_) => None,
    }
}

fn written(numbers: Vec<f64>) -> Vec<BigRational> {
    numbers.into_iter().map(Number::written).collect()
}

fn start_of(agent: &AgentSetup) -> Vec<f64> {
    [&agent.start.q[..], &agent.start.dq, &agent.start.rest].concat()
}

/// A vector that the factor of the input of a plant with several axes makes shorter, where the plant starts, than its floor times what it was, and
/// the start.
fn shortened(agent: &AgentSetup) -> Option<(Vec<f64>, Vec<f64>)> {
    let (law, rows, start): (&ChainLaw, _, _) = (agent.law.downcast()?, matrix_of(agent)?, start_of(agent));
    let within: Vec<Interval> = start.iter().map(|x| Interval::point(*x)).collect();
    let entries: Vec<Interval> = rows.iter().flatten().map(|entry| entry.fold(&mut Intervals(&within))).collect();
    let middle = |entry: &Interval| 0.5 * (entry.low + entry.high);
    let at_start = DMatrix::from_row_iterator(rows.len(), rows.len(), entries.iter().map(middle));
    let found = finite(at_start)?.try_svd(false, true, f64::EPSILON, 0)?;
    let vector: Vec<f64> = found.v_t?.row(found.singular_values.imin()).iter().copied().collect();
    let square = |x: Interval| Interval::point(x.size()) * Interval::point(x.size());
    let total = |parts: &mut dyn Iterator<Item = Interval>| parts.fold(Interval::point(0.0), |sum, part| sum + part);
    let dot = |row: &[Interval]| total(&mut row.iter().zip(&vector).map(|(entry, x)| *entry * Interval::point(*x)));
    let image = total(&mut entries.chunks_exact(rows.len()).map(|row| square(dot(row))));
    let floor = square(Interval::point(law.floor));
    let allowed = floor * total(&mut vector.iter().map(|x| square(Interval::point(*x))));
    (image.high < allowed.low).then_some((vector, start))
}

/// A state in which the factor of the input of a chain with one axis is below its floor: the start, or where it is zero.
fn small_in(agent: &AgentSetup) -> Option<Vec<BigRational>> {
    let (law, model): (&ChainLaw, &ChainModel) = (agent.law.downcast()?, agent.robot.kind.downcast()?);
    let factor = match model {
        ChainModel::Derivatives(terms) => terms.input(),
        ChainModel::Cascade(terms) if terms.is_strict() => terms.input(),
        ChainModel::Vector(_) | ChainModel::Cascade(_) => return None,
    };
    let small = |state: &Vec<f64>| {
        let within: Vec<Interval> = state.iter().map(|x| Interval::point(*x).with_room(1e-12 * x.abs())).collect();
        state.len() >= factor.variables() && factor.fold(&mut Intervals(&within)).size() < law.floor
    };
    let state = [Some(start_of(agent)), factor.zero()].into_iter().flatten().find(small)?;
    Some(written(state))
}

/// Whether the factor of the input of a chain is a constant below its floor; nothing where it is no constant.
fn small_factor(agent: &AgentSetup) -> Option<bool> {
    let (law, model): (&ChainLaw, &ChainModel) = (agent.law.downcast()?, agent.robot.kind.downcast()?);
    let factor = match model {
        ChainModel::Derivatives(terms) => terms.input(),
        ChainModel::Vector(_) => return None,
        ChainModel::Cascade(terms) => terms.input(),
    };
    (factor.variables() == 0).then(|| factor.value(&[]).abs() < law.floor)
}

/// The sum of some expressions.
pub(super) fn sum(parts: impl Iterator<Item = Expression>) -> Expression {
    parts.reduce(|sum, part| sum + part).unwrap_or_else(|| Expression::number(0.0))
}

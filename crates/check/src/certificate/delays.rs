//! Bounds of delays, weights and couplings.

use std::collections::BTreeSet;

use forwardstep_sim::Setup;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Basis, Delay, PacketLink, Sinusoid};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use num_rational::BigRational;
use num_traits::Zero;

use super::enclosure::enclosed;
use super::exact::{above, written};
use super::producers::Claim;
use super::proof::{Enclosure, GivenAge, Proof};
use crate::Answer;

/// All edges with their phases.
fn edges(setup: &Setup) -> impl Iterator<Item = (usize, &Edge)> {
    let graphs = setup.network.schedule.graphs.iter().enumerate();
    graphs.flat_map(|(phase, graph)| graph.iter().map(move |edge| (phase, edge)))
}

pub(super) fn bounded(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer == Answer::Violated {
        return None;
    }
    let (end_s, reach) = (setup.time.end_s, claim.reach());
    let (mut bound_s, mut formulas, mut given) = (BigRational::zero(), Vec::new(), Vec::new());
    let (mut seen, mut links) = (BTreeSet::new(), BTreeSet::new());
    for (phase, edge) in edges(setup) {
        let delay = setup.network.delays.get(edge.delay)?;
        if delay.known().basis == Basis::Declared {
            return None;
        }
        if let Some(formula) = delay.downcast::<BoundedFormula>() {
            if seen.insert(edge.delay) {
                let mut found = enclosed(formula.formula(), end_s, reach, |within| within.low >= 0.0)?;
                found.edge = Some((edge.from, edge.to, phase));
                bound_s = bound_s.max(found.within[1].clone());
                formulas.push(found);
            }
            continue;
        }
        let largest = largest(delay);
        if is_drawn(delay) && links.insert((edge.from, edge.to)) {
            given.push(GivenAge { from: edge.from, to: edge.to, worst_s: largest.clone() });
        }
        bound_s = bound_s.max(largest);
    }
    Some(Proof::Delays { bound_s, formulas, given })
}

/// Whether a link draws packets whose rule bounds nothing.
fn is_drawn(delay: &Delay) -> bool {
    delay.packets().and_then(|trace| trace.link()).is_some_and(|link| !link.bound_s().is_finite())
}

/// What a delay does not exceed, in exact numbers where its rule adds some.
fn largest(delay: &Delay) -> BigRational {
    let sum = |numbers: &[f64]| numbers.iter().copied().map(written).sum();
    if let Some(Sinusoid { mean_s, amplitude_s, .. }) = delay.downcast() {
        return sum(&[*mean_s, *amplitude_s]);
    }
    match delay.packets().map(|trace| (trace.link(), trace)) {
        Some((Some(link), _)) if link.bound_s().is_finite() => by_rule(link),
        // Ages are differences of sums of what is written: one rounding in each.
        Some((_, trace)) => above(trace.statistics().largest_age_s * (1.0 + 1e-12) + 1e-12),
        None => written(delay.known().bound_s),
    }
}

/// (lost + 1) · period + latency + jitter.
fn by_rule(link: &PacketLink) -> BigRational {
    let rest = written(link.latency_s) + written(link.jitter_s);
    let packets = ((link.bound_s() - link.latency_s - link.jitter_s) / link.every_s).round();
    written(packets) * written(link.every_s) + rest
}

pub(super) fn in_time(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let timeout_s = setup.control.as_ref()?.failures.message_timeout_s?;
    (claim.answer == Answer::Holds).then(|| Proof::Ages(written(timeout_s)))
}

pub(super) fn weights(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer == Answer::Violated {
        return None;
    }
    let mut seen = BTreeSet::new();
    let found = edges(setup).filter_map(|(phase, edge)| match edge.weight {
        Weight::Formula(index) if seen.insert(index) => Some((index, (edge.from, edge.to, phase))),
        Weight::Formula(_) | Weight::Constant(_) => None,
    });
    let enclosure = |(index, edge): (usize, (usize, usize, usize))| {
        let formula = setup.network.weights.get(index)?.formula();
        let found = enclosed(formula, setup.time.end_s, claim.reach(), |within| within.low > 0.0)?;
        Some(Enclosure { edge: Some(edge), ..found })
    };
    found.map(enclosure).collect::<Option<_>>().map(Proof::Weights)
}

pub(super) fn coupling(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer != Answer::Holds {
        return None;
    }
    match setup.network.coupling {
        Coupling::Linear => None,
        Coupling::Saturated { limit } => Some(Proof::Form("saturated", written(limit))),
        Coupling::Tanh { scale } => Some(Proof::Form("tanh", written(scale))),
        Coupling::Rational { scale } => Some(Proof::Form("rational", written(scale))),
    }
}

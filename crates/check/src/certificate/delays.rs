//! Bounds of delays, weights and couplings.

use std::collections::BTreeSet;

use forwardstep_core::expression::{Expression, Interval, Number};
use forwardstep_sim::Setup;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Basis, Delay, PacketLink, Refuted, Sinusoid};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use num_rational::BigRational;
use num_traits::Zero;

use super::enclosure::steady;
use super::exact::above;
use super::limit::{Limit, limit, refutes};
use super::producers::Claim;
use super::proof::{Enclosure, GivenAge, Proof};
use crate::Answer;
use crate::links::never_in_time;

/// Times at which a formula is looked at for a witness, and how many of them there are in a second.
const LOOKS: u32 = 100_000;
const LOOKS_PER_S: f64 = 100.0;

/// All edges with their phases.
fn edges(setup: &Setup) -> impl Iterator<Item = (usize, &Edge)> {
    let graphs = setup.network.schedule.graphs.iter().enumerate();
    graphs.flat_map(|(phase, graph)| graph.iter().map(move |edge| (phase, edge)))
}

pub(super) fn bounded(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer == Answer::Violated {
        return late_for_ever(setup);
    }
    let (mut bound_s, mut formulas, mut given) = (BigRational::zero(), Vec::new(), Vec::new());
    let (mut seen, mut links) = (BTreeSet::new(), BTreeSet::new());
    for (phase, edge) in edges(setup) {
        let delay = setup.network.delays.get(edge.delay)?;
        if delay.known().basis == Basis::Declared {
            return None;
        }
        if let Some(formula) = delay.downcast::<BoundedFormula>() {
            if seen.insert(edge.delay) {
                let gone_s = setup.network.schedule.gone_s(|other| other.delay == edge.delay);
                let mut found = steady(formula.formula(), gone_s, |within| within.low >= 0.0)?;
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

/// A delay that exceeds every bound or becomes negative, or a link that loses every packet.
fn late_for_ever(setup: &Setup) -> Option<Proof> {
    edges(setup).find_map(|(phase, edge)| {
        let (delay, at) = (setup.network.delays.get(edge.delay)?, (edge.from, edge.to, phase));
        let comes_back = || refutes(setup, None, |other| other == edge, |_| false);
        if delay.known().refuted == Some(Refuted::EveryPacketLost) && comes_back() {
            return Some(Proof::LosesAll(at));
        }
        let formula = delay.downcast::<BoundedFormula>()?.formula();
        if !refutes(setup, Some(formula), |other| other.delay == edge.delay, |within| within.high < 0.0) {
            return None;
        }
        match limit(formula) {
            Limit::Up | Limit::Down => Some(Proof::Limit(at)),
            Limit::Near(within) if within.high < 0.0 => Some(Proof::Limit(at)),
            Limit::Near(_) | Limit::Unknown => first(formula, |value| value.high < 0.0)
                .map(|t_s| Proof::Below(t_s, at))
                .or_else(|| swings(formula, at)),
        }
    })
}

/// A weight that comes to zero, becomes negative, or grows without bound.
fn fading(setup: &Setup) -> Option<Proof> {
    edges(setup).find_map(|(phase, edge)| {
        let Weight::Formula(index) = edge.weight else { return None };
        let (formula, at) = (setup.network.weights.get(index)?.formula(), (edge.from, edge.to, phase));
        if !refutes(setup, Some(formula), |other| other.weight == edge.weight, |within| within.high <= 0.0) {
            return None;
        }
        match limit(formula) {
            Limit::Up | Limit::Down => Some(Proof::Limit(at)),
            Limit::Near(within) if within.high <= 0.0 => Some(Proof::Limit(at)),
            Limit::Near(_) | Limit::Unknown => first(formula, |value| value.high <= 0.0)
                .map(|t_s| Proof::Below(t_s, at))
                .or_else(|| swings(formula, at)),
        }
    })
}

/// What exceeds every bound again and again, as t |sin t| does.
fn swings(formula: &Expression, at: (usize, usize, usize)) -> Option<Proof> {
    formula.for_ever().is_unbounded().then_some(Proof::Limit(at))
}

/// The first of some times at which the value of a formula is clearly of a kind.
fn first(formula: &Expression, is: impl Fn(Interval) -> bool) -> Option<BigRational> {
    let values = (0..=LOOKS).map(|look| f64::from(look) / LOOKS_PER_S);
    values
        .map(|t_s| (t_s, formula.enclose(Interval::point(t_s))))
        .find(|(_, value)| is(*value))
        .map(|(t_s, _)| Number::written(t_s))
}

/// Whether a link draws packets whose rule bounds nothing.
fn is_drawn(delay: &Delay) -> bool {
    delay.packets().and_then(|trace| trace.link()).is_some_and(|link| !link.bound_s().is_finite())
}

/// What a delay does not exceed, in exact numbers where its rule adds some.
pub(crate) fn largest(delay: &Delay) -> BigRational {
    let sum = |numbers: &[f64]| numbers.iter().copied().map(Number::written).sum();
    if let Some(Sinusoid { mean_s, amplitude_s, .. }) = delay.downcast() {
        return sum(&[*mean_s, *amplitude_s]);
    }
    match delay.packets().map(|trace| (trace.link(), trace)) {
        Some((Some(link), _)) if link.bound_s().is_finite() => by_rule(link),
        // Ages are differences of sums of what is written: one rounding in each.
        Some((_, trace)) => above(trace.statistics().largest_age_s * (1.0 + 1e-12) + 1e-12),
        None => above_rounded(delay.known().bound_s),
    }
}

/// Numbers with as many digits may be those of constants that are not rational.
const SHORT: usize = 12;
/// More than what rounding does to such a constant, s, or as a part of it: others compute it to other last digits.
const ROOM: f64 = 1e-12;

/// A number as it is written; of so many digits that it is that of a constant which is not rational, one that is not below.
fn above_rounded(value: f64) -> BigRational {
    let digits = format!("{value:e}").bytes().take_while(|byte| *byte != b'e').filter(u8::is_ascii_digit).count();
    if digits < SHORT { Number::written(value) } else { above(value * (1.0 + ROOM) + ROOM) }
}

/// (lost + 1) · period + latency + jitter.
fn by_rule(link: &PacketLink) -> BigRational {
    let rest = Number::written(link.latency_s) + Number::written(link.jitter_s);
    let packets = ((link.bound_s() - link.latency_s - link.jitter_s) / link.every_s).round();
    Number::written(packets) * Number::written(link.every_s) + rest
}

pub(super) fn in_time(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if let Some((phase, edge)) = never_in_time(setup) {
        return Some(Proof::Older((edge.from, edge.to, phase)));
    }
    let timeout_s = setup.control.as_ref()?.failures.message_timeout_s?;
    (claim.answer == Answer::Holds).then(|| Proof::Ages(Number::written(timeout_s)))
}

pub(super) fn weights(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer == Answer::Violated {
        return fading(setup);
    }
    let mut seen = BTreeSet::new();
    let found = edges(setup).filter_map(|(phase, edge)| match edge.weight {
        Weight::Formula(index) if seen.insert(index) => Some((index, (edge.from, edge.to, phase))),
        Weight::Formula(_) | Weight::Constant(_) => None,
    });
    let enclosure = |(index, edge): (usize, (usize, usize, usize))| {
        let formula = setup.network.weights.get(index)?.formula();
        let gone_s = setup.network.schedule.gone_s(|other| other.weight == Weight::Formula(index));
        let found = steady(formula, gone_s, |within| within.low > 0.0)?;
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
        Coupling::Saturated { limit } => Some(Proof::Form("saturated", Number::written(limit))),
        Coupling::Tanh { scale } => Some(Proof::Form("tanh", Number::written(scale))),
        Coupling::Rational { scale } => Some(Proof::Form("rational", Number::written(scale))),
    }
}

//! What the theorems ask of delays, weights and couplings.
//!
//! The delays of Theorems 2 and 3 are "piecewise uniformly continuous and uniformly bounded". Pieces may be as short as
//! jitter makes them, but packets arrive a finite number of times in a bounded time, and how short a piece is plays no part
//! where the theorems use the delay, under integrals. What can fail is the bound.

use forwardstep_core::expression::{Interval, Number};
use forwardstep_sim::Setup;
use forwardstep_sim::delay::{Basis, Delay, Known, Unknown};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};

use crate::certificate::{largest, refutes};
use crate::hypothesis::{Hypothesis, Id, LinkEvidence, TooOld, WeightFault};

/// What rounding adds to a sum, as a part of it.
const ROUNDING: f64 = 1e-12;

/// The delays of links that are used.
fn delays(setup: &Setup) -> impl Iterator<Item = &Delay> {
    setup.network.used_delays().filter_map(|index| setup.network.delays.get(index))
}

/// The same with what is known of them. A formula counts until its links are gone for good.
fn known_each(setup: &Setup) -> impl Iterator<Item = Known> {
    let known = |index: usize| {
        let delay = setup.network.delays.get(index)?;
        let (known, gone_s) = (delay.known(), setup.network.schedule.gone_s(|edge| edge.delay == index));
        let bounded = delay.downcast().zip(gone_s).map(|(formula, gone_s)| until(formula, gone_s));
        let whole = bounded.filter(|within| within.low >= 0.0 && within.high.is_finite());
        Some(whole.map_or(known, |within| Known { bound_s: within.high, unknown: None, ..known }))
    };
    setup.network.used_delays().filter_map(known)
}

/// What a formula keeps within up to a time: there it is uniformly continuous.
fn until(formula: &BoundedFormula, end_s: f64) -> Interval {
    formula.formula().bounds(0.0, end_s)
}

/// The delays that can be refuted by what they do in the end.
fn lasting_delays(setup: &Setup) -> impl Iterator<Item = &Delay> {
    let used = setup.network.used_delays().filter_map(|index| Some((index, setup.network.delays.get(index)?)));
    let lasts = |(index, delay): &(usize, &Delay)| {
        let formula = delay.downcast().map(BoundedFormula::formula);
        refutes(setup, formula, |edge| edge.delay == *index, |within| within.high < 0.0)
    };
    used.filter(lasts).map(|(_, delay)| delay)
}

pub(crate) fn bounded_delays(setup: &Setup) -> Hypothesis {
    Hypothesis::new(Id::BoundedDelays, known_delays(setup))
}

/// What is known of all delays together, or what refutes the author of one.
fn known_delays(setup: &Setup) -> LinkEvidence {
    let end_s = setup.time.end_s;
    let refuted = |delay: &Delay| delay.probe(end_s).err().map(|fault| (delay.words(), fault));
    if let Some((words, fault)) = delays(setup).find_map(refuted) {
        return LinkEvidence::RefutedDelay { words, fault };
    }
    if let Some(refuted) = lasting_delays(setup).find_map(|delay| delay.known().refuted) {
        return LinkEvidence::RefutedBound(refuted);
    }
    let (mut bound_s, mut oldest_s): (f64, f64) = (0.0, 0.0);
    let mut unknown: Vec<Unknown> = Vec::new();
    let (mut basis, mut holds_packets) = (Basis::Rule, false);
    for known in known_each(setup) {
        bound_s = bound_s.max(known.bound_s);
        if known.unknown.is_some() {
            oldest_s = oldest_s.max(known.bound_s);
        }
        holds_packets |= known.holds_packets;
        basis = weaker(basis, known.basis);
        unknown.extend(known.unknown.filter(|reason| !unknown.contains(reason)));
    }
    LinkEvidence::Delays { bound_s, oldest_s, unknown, end_s, basis, holds_packets }
}

/// What two bounds together rest on.
fn weaker(a: Basis, b: Basis) -> Basis {
    match (a, b) {
        (Basis::Declared, _) | (_, Basis::Declared) => Basis::Declared,
        (Basis::Numbers, _) | (_, Basis::Numbers) => Basis::Numbers,
        (Basis::Enclosure, _) | (_, Basis::Enclosure) => Basis::Enclosure,
        (Basis::Rule, Basis::Rule) => Basis::Rule,
    }
}

/// An edge whose messages time out is not there for a while, which the graphs of the schedule do not say.
pub(crate) fn messages_in_time(setup: &Setup) -> Option<Hypothesis> {
    let control = setup.control.as_ref()?;
    let timeout_s = control.failures.message_timeout_s?;
    let too_old = never_in_time(setup).map(|(_, edge)| {
        let [from, to] = [edge.from, edge.to].map(|agent| setup.agents[agent].name.clone());
        TooOld { from, to, least_s: youngest_s(setup, edge) }
    });
    let known: Vec<_> = known_each(setup).collect();
    let bounded = known.iter().all(|known| known.unknown.is_none());
    // Heard at samples, a message is up to a period older than its delay. Sums of decimals are compared as such: 0.1 + 0.05 does not exceed 0.15.
    let bound_s = known.iter().map(|known| known.bound_s).fold(0.0, f64::max) + 1.0 / control.sample_hz;
    let exact_s = delays(setup).map(largest).zip(&known).map(|(by_rule, known)| match known.basis {
        Basis::Rule => by_rule,
        Basis::Enclosure | Basis::Numbers | Basis::Declared => Number::written(known.bound_s),
    });
    let in_time = exact_s
        .max()
        .is_none_or(|late_s| late_s + Number::written(control.sample_hz).recip() <= Number::written(timeout_s));
    let basis = known.iter().map(|known| known.basis).fold(Basis::Rule, weaker);
    let evidence = LinkEvidence::Ages {
        bound_s: bounded.then_some(bound_s),
        in_time: bounded && in_time,
        timeout_s,
        basis,
        too_old,
    };
    Some(Hypothesis::new(Id::MessagesInTime, evidence))
}

/// An edge that is there again and again, with its phase, over which all that is heard is older than the time-out.
pub(crate) fn never_in_time(setup: &Setup) -> Option<(usize, &Edge)> {
    let timeout_s = setup.control.as_ref()?.failures.message_timeout_s?;
    let schedule = &setup.network.schedule;
    let late = |edge: &&Edge| youngest_s(setup, edge) > timeout_s;
    let first = schedule.graphs.len() - schedule.recurring_graphs().len();
    let phases = schedule.recurring_graphs().iter().enumerate();
    phases.filter_map(|(phase, graph)| Some((first + phase, graph.iter().find(late)?))).next()
}

/// What is heard over an edge is never younger, by the rule of its delay, s. Zero where no rule says so.
fn youngest_s(setup: &Setup, edge: &Edge) -> f64 {
    let Some(delay) = setup.network.delays.get(edge.delay) else { return 0.0 };
    match delay.packets() {
        Some(trace) => trace.link().map_or(0.0, |link| link.latency_s),
        None if delay.known().basis == Basis::Rule && delay.known().until_s.is_none() => delay.min_s(),
        None => 0.0,
    }
}

/// Whether some message of the run may become too old to count, so that the network is not the one that is stated.
pub(crate) fn may_time_out(setup: &Setup) -> bool {
    let Some(control) = &setup.control else { return false };
    let oldest_s = setup.network.max_delay_s() + 1.0 / control.sample_hz;
    control.failures.message_timeout_s.is_some_and(|timeout_s| timeout_s < (1.0 - ROUNDING) * oldest_s)
}

/// Whether some link that is used is not known to be without delay from the way it is stated.
pub(crate) fn is_late(setup: &Setup) -> bool {
    delays(setup).any(|delay| delay.max_s() > 0.0 || delay.known().basis != Basis::Rule)
}

pub(crate) fn no_delay(setup: &Setup) -> Hypothesis {
    // What a formula does after the run counts.
    let bound_s = |known: Known| if known.unknown.is_some() { 0.0 } else { known.bound_s };
    let later_s = known_each(setup).map(bound_s).fold(0.0, f64::max);
    let bound_s = delays(setup).map(Delay::max_s).fold(later_s, f64::max);
    let evidence = if bound_s > 0.0 {
        LinkEvidence::Late { bound_s }
    } else if delays(setup).all(Delay::is_constant) {
        LinkEvidence::Prompt
    } else {
        known_delays(setup)
    };
    Hypothesis::new(Id::NoDelay, evidence)
}

/// The formulas that weights of edges follow, each once, without those that are constant; with their numbers.
fn numbered_weights(setup: &Setup) -> impl Iterator<Item = (usize, &BoundedFormula)> {
    let varying = setup.network.weights.iter().enumerate().filter(|(_, formula)| formula.constant().is_none());
    let edges = || setup.network.schedule.graphs.iter().flatten();
    varying.filter(move |(index, _)| edges().any(|edge| edge.weight == Weight::Formula(*index)))
}

/// The same without.
pub(crate) fn varying_weights(setup: &Setup) -> impl Iterator<Item = &BoundedFormula> {
    numbered_weights(setup).map(|(_, formula)| formula)
}

/// Those that can be refuted by what they do in the end.
fn lasting_weights(setup: &Setup) -> impl Iterator<Item = &BoundedFormula> {
    let lasts = |(index, weight): &(usize, &BoundedFormula)| {
        let follows = |edge: &Edge| edge.weight == Weight::Formula(*index);
        refutes(setup, Some(weight.formula()), follows, |within| within.high <= 0.0)
    };
    numbered_weights(setup).filter(lasts).map(|(_, weight)| weight)
}

/// What a nonlinear coupling must be like for the argument of Theorem 3.
pub(crate) fn coupling(setup: &Setup) -> Option<Hypothesis> {
    let size = setup.network.coupling.size()?;
    Some(Hypothesis::new(Id::CouplingSector, LinkEvidence::Coupling { size }))
}

/// What all weights that vary keep within, of one of their bounds.
fn hull(setup: &Setup, of: impl Fn(&BoundedFormula) -> Interval) -> Option<Interval> {
    varying_weights(setup).map(of).reduce(Interval::hull)
}

/// Nothing to say where weights are constant.
pub(crate) fn bounded_weights(setup: &Setup) -> Option<Hypothesis> {
    let on_run = hull(setup, BoundedFormula::within)?;
    if let Some(evidence) = lasting_weights(setup).find_map(refuted_weight) {
        return Some(Hypothesis::new(Id::BoundedWeights, evidence));
    }
    let known = numbered_weights(setup).map(|(index, weight)| {
        let gone_s = setup.network.schedule.gone_s(|edge| edge.weight == Weight::Formula(index));
        let for_ever = || (weight.for_ever().within, weight.for_ever().uniform);
        gone_s.map_or_else(for_ever, |gone_s| (until(weight, gone_s), true))
    });
    let (for_ever, uniform) = known.reduce(|(a, both), (b, uniform)| (a.hull(b), both && uniform))?;
    let bounded_for_ever = for_ever.low > 0.0 && for_ever.high.is_finite();
    let (Interval { low, high }, until_s) =
        if bounded_for_ever && uniform { (for_ever, None) } else { (on_run, Some(setup.time.end_s)) };
    Some(Hypothesis::new(Id::BoundedWeights, LinkEvidence::Weights { low, high, until_s, bounded_for_ever }))
}

/// What shows that a weight is not bounded, or not away from zero.
fn refuted_weight(weight: &BoundedFormula) -> Option<LinkEvidence> {
    let (on_run, reaches) = (weight.within(), weight.for_ever().reaches);
    let above = |low: f64| Interval { low, high: f64::INFINITY };
    let (fault, range) = match () {
        () if reaches.low < 0.0 => (WeightFault::Negative, above(0.0)),
        // Below what it has on the run, so that it cannot be taken for what the run has.
        () if reaches.low <= 0.0 => (WeightFault::Fades, above(0.5 * on_run.low)),
        () if reaches.high == f64::INFINITY => {
            (WeightFault::Grows, Interval { low: f64::NEG_INFINITY, high: 2.0 * on_run.high })
        }
        () => return None,
    };
    Some(LinkEvidence::RefutedWeight { fault, witness: weight.seen_outside(range) })
}

/// (119) and (122) are realised by their integrals, in which weights stand as if they were constant. What is integrated as it stands `lags`
/// over late links, by how much is known of constant weights.
pub(crate) fn constant_weights(setup: &Setup, lags: bool) -> Hypothesis {
    let varying = |Interval { low, high }| LinkEvidence::VaryingWeights { low, high, lags };
    let evidence = hull(setup, BoundedFormula::within).map_or(LinkEvidence::ConstantWeights, varying);
    Hypothesis::new(Id::ConstantWeights, evidence)
}

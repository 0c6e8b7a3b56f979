//! What the theorems ask of delays and weights.
//!
//! The delays of Theorems 2 and 3 are "piecewise uniformly continuous and uniformly bounded". A link that holds packets has
//! T = t − s between arrivals: slope one on every piece, one modulus of continuity for all of them. Pieces may be as
//! short as jitter makes them, but packets arrive a finite number of times in a bounded time, and how short a piece is
//! plays no part where the theorems use the delay, under integrals. What can fail is the bound.

use forwardstep_core::expression::Interval;
use forwardstep_sim::Setup;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;

use crate::hypotheses::seconds;
use crate::verdict::{Answer, Hypothesis};

/// How far a delay is known not to exceed a bound.
enum Known {
    /// For ever, by what it is made of.
    ForEver(f64),
    /// Only on the run, with the reason.
    OnHorizon(f64, &'static str),
}

/// On a bounded time a continuous formula is uniformly continuous; for ever it may swing faster and faster.
const SWINGS: &str = "a formula could not be shown to be uniformly continuous for ever, as it is on the run";

fn known(delay: &Delay) -> Known {
    match delay {
        Delay::Formula(formula) => {
            let Interval { low, high } = formula.for_ever();
            let seen = formula.within().high;
            if !(low >= 0.0 && high.is_finite()) {
                Known::OnHorizon(seen, "a formula could not be shown to be bounded for ever")
            } else if !formula.formula().is_uniformly_continuous() {
                Known::OnHorizon(seen, SWINGS)
            } else {
                Known::ForEver(high)
            }
        }
        Delay::Packets(trace) => match trace.link() {
            Some(link) if link.bound_s().is_finite() => Known::ForEver(link.bound_s()),
            Some(_) => Known::OnHorizon(
                delay.max_s(),
                "any number of packets may be lost one after another, so no delay is the longest \
                 (`most_in_a_row` would bound them)",
            ),
            None => {
                Known::OnHorizon(delay.max_s(), "packets are replayed from a log, which says nothing about later ones")
            }
        },
        delay => Known::ForEver(delay.max_s()),
    }
}

pub(crate) fn bounded_delays(setup: &Setup) -> Hypothesis {
    let mut bound_s: f64 = 0.0;
    let mut seen_s: f64 = 0.0;
    let mut reasons: Vec<&str> = Vec::new();
    let mut packets = false;
    for delay in setup.network.used_delays().map(|index| &setup.network.delays[index]) {
        packets |= matches!(delay, Delay::Packets(_));
        match known(delay) {
            Known::ForEver(bound) => bound_s = bound_s.max(bound),
            Known::OnHorizon(seen, reason) => {
                seen_s = seen_s.max(seen);
                if !reasons.contains(&reason) {
                    reasons.push(reason);
                }
            }
        }
    }
    let pieces = if packets { "; between the arrivals of packets it grows like t" } else { "" };
    let (answer, because) = if reasons.is_empty() {
        (Answer::Holds, format!("no delay exceeds {} s{pieces}", seconds(bound_s)))
    } else {
        let end_s = seconds(setup.time.end_s);
        let largest = seconds(bound_s.max(seen_s));
        let because = format!(
            "no delay exceeds {largest} s until the end of the run at {end_s} s{pieces}; {}",
            reasons.join("; ")
        );
        (Answer::HoldsOnHorizon, because)
    };
    Hypothesis { requires: "delays are piecewise uniformly continuous and uniformly bounded".into(), answer, because }
}

/// The formulas that weights of edges follow, each once.
pub(crate) fn varying_weights(setup: &Setup) -> impl Iterator<Item = &BoundedFormula> {
    let network = &setup.network;
    let mut used = vec![false; network.weights.len()];
    for edge in network.schedule.graphs().into_iter().flatten() {
        if let Weight::Formula(index) = edge.weight
            && let Some(used) = used.get_mut(index)
        {
            *used = true;
        }
    }
    network.weights.iter().zip(used).filter(|(_, used)| *used).map(|(formula, _)| formula)
}

/// What a nonlinear coupling must be like for the argument of Theorem 3.
pub(crate) fn coupling(setup: &Setup) -> Option<Hypothesis> {
    let size = setup.network.coupling.size()?;
    Some(Hypothesis {
        requires: "the coupling is odd and continuous, grows, and keeps within the sector (0, 1]".into(),
        answer: Answer::Holds,
        because: format!("its slope at zero is one and it grows more slowly from there; its size is {size}"),
    })
}

/// Nothing to say where weights are constant.
pub(crate) fn bounded_weights(setup: &Setup) -> Option<Hypothesis> {
    let hull = |of: fn(&BoundedFormula) -> Interval| {
        let bounds = varying_weights(setup).map(of);
        bounds.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), b| (low.min(b.low), high.max(b.high)))
    };
    varying_weights(setup).next()?;
    let (within, for_ever) = (hull(BoundedFormula::within), hull(BoundedFormula::for_ever));
    let stay = |(low, high)| format!("weights that follow a formula stay from {} to {}", seconds(low), seconds(high));
    let bounded = for_ever.0 > 0.0 && for_ever.1.is_finite();
    let uniform = varying_weights(setup).all(|weight| weight.formula().is_uniformly_continuous());
    let (answer, because) = if bounded && uniform {
        (Answer::Holds, stay(for_ever))
    } else {
        let (stay, end_s) = (stay(within), seconds(setup.time.end_s));
        let reason = if bounded { SWINGS } else { "for ever could not be shown" };
        (Answer::HoldsOnHorizon, format!("{stay} until the end of the run at {end_s} s; {reason}"))
    };
    Some(Hypothesis {
        requires:
            "weights are piecewise uniformly continuous, bounded, and bounded away from zero while their edge is there"
                .into(),
        answer,
        because,
    })
}

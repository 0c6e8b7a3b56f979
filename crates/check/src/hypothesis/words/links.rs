//! Delays, weights and couplings.

use forwardstep_sim::delay::{Basis, Refuted, Unknown};
use forwardstep_sim::formula::Witness;

use super::numbers::{Shown, bound, lower_bound, rounded, rounded_down, rounded_up, seconds};
use crate::hypothesis::{LinkEvidence, TooOld, WeightFault};

/// On a bounded time a continuous formula is uniformly continuous; for ever it may swing faster and faster.
const SWINGS: &str = "a formula could not be shown to be uniformly continuous for ever, as it is on the run";

pub(super) fn words(evidence: &LinkEvidence) -> String {
    match evidence {
        LinkEvidence::RefutedDelay { words, fault } => {
            format!("{words} is not what its author declares: {fault}")
        }
        LinkEvidence::Delays { bound_s, oldest_s, unknown, end_s, holds_packets, basis } => {
            let bound = bound(*bound_s);
            let pieces = if *holds_packets { "; between the arrivals of packets it grows like t" } else { "" };
            if unknown.is_empty() {
                let basis = if *basis == Basis::Declared { " (declared, not shown)" } else { "" };
                return format!("no delay exceeds {bound} s{pieces}{basis}");
            }
            let short = (2.0 * oldest_s > *end_s)
                .then_some("the run is not twice as long, so that nothing is seen to arrive again and again");
            let reasons: Vec<&str> = unknown.iter().copied().map(reason).chain(short).collect();
            format!(
                "no delay exceeds {bound} s until the end of the run at {} s{pieces}; {}",
                seconds(*end_s),
                reasons.join("; ")
            )
        }
        LinkEvidence::RefutedBound(refuted) => refuted_bound(*refuted),
        LinkEvidence::Ages { too_old: Some(TooOld { from, to, least_s }), timeout_s, .. } => format!(
            "{to} never hears {from}: what comes is at least {} s old, and what is older than {} s does not count",
            seconds(*least_s),
            seconds(*timeout_s)
        ),
        LinkEvidence::Ages { bound_s, timeout_s, .. } => {
            let age = bound_s.map_or("how old one becomes is not known".into(), |bound_s| {
                format!("one becomes {} s old at most", bound(bound_s))
            });
            format!("{age}, and the sender of one that is older than {} s does not count", seconds(*timeout_s))
        }
        LinkEvidence::Prompt => "no link has a delay".into(),
        LinkEvidence::Late { bound_s } => {
            format!("there are delays of up to {} s; the paper follows a leader without delays only", bound(*bound_s))
        }
        LinkEvidence::Weights { low, high, until_s, bounded_for_ever } => {
            let stay = format!("weights that follow a formula stay from {} to {}", lower_bound(*low), bound(*high));
            let reason = if *bounded_for_ever { SWINGS } else { "that they do so for ever could not be shown" };
            match until_s {
                None => stay,
                Some(end_s) => format!("{stay} until the end of the run at {} s; {reason}", seconds(*end_s)),
            }
        }
        LinkEvidence::RefutedWeight { fault, witness } => refuted_weight(*fault, *witness),
        LinkEvidence::ConstantWeights => "no weight changes with time".into(),
        LinkEvidence::VaryingWeights { low, high, lags: true } => format!(
            "a weight follows a formula, within {} and {}: how far agents stay behind over late links is known of constant weights only",
            lower_bound(*low),
            bound(*high)
        ),
        LinkEvidence::VaryingWeights { low, high, lags: false } => format!(
            "a weight follows a formula, within {} and {}: where it changes, the design, which is realised by its integral, leaves −ẇ(q̇ᵢ − q̇ⱼ) \
             over, so that what is integrated is not the law that the proof speaks of",
            lower_bound(*low),
            bound(*high)
        ),
        LinkEvidence::Coupling { size } => {
            format!("its slope at zero is one and it grows more slowly from there; its size is {size}")
        }
    }
}

fn refuted_bound(refuted: Refuted) -> String {
    let at = |witness: Option<Witness>, value: fn(f64) -> Shown| {
        witness.map_or(String::new(), |Witness { t_s, value: seen }| {
            format!("; at t = {} s it is {} s", rounded(t_s), value(seen))
        })
    };
    match refuted {
        Refuted::Unbounded { witness, .. } => {
            format!("a delay that is a formula exceeds every bound{}", at(witness, rounded_down))
        }
        Refuted::Negative(witness) => {
            format!("a delay that is a formula becomes negative after the run{}", at(witness, rounded_up))
        }
        Refuted::EveryPacketLost => "a link loses every packet: nothing is ever heard over it".into(),
    }
}

fn refuted_weight(fault: WeightFault, witness: Option<Witness>) -> String {
    let (what, value): (_, fn(f64) -> Shown) = match fault {
        WeightFault::Fades => ("comes as close to zero as one likes: its infimum is 0", rounded_up),
        WeightFault::Negative => ("becomes negative after the run", rounded_up),
        WeightFault::Grows => ("exceeds every bound", rounded_down),
    };
    let at = witness.map_or(String::new(), |Witness { t_s, value: seen }| {
        format!("; at t = {} s it is {}", rounded(t_s), value(seen))
    });
    format!("a weight that is a formula {what}{at}")
}

fn reason(unknown: Unknown) -> &'static str {
    match unknown {
        Unknown::FormulaSign => "a formula could not be shown not to become negative after the run",
        Unknown::FormulaBound | Unknown::FormulaSteep => "a formula could not be shown to be bounded for ever",
        Unknown::FormulaContinuity => SWINGS,
        Unknown::PacketsInARow => {
            "any number of packets may be lost one after another, so no delay is the longest (`most_consecutive` would bound them)"
        }
        Unknown::NothingArrived => "on one link no message arrives until then, so nothing is known of its delay",
        Unknown::LaterHolds => "values are replayed from a log, which says nothing about later ones",
        Unknown::LaterPackets => "packets are replayed from a log, which says nothing about later ones",
    }
}

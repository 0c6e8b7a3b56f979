//! Delays, weights and couplings.

use forwardstep_sim::delay::{Basis, Unknown};

use super::numbers::seconds;
use crate::hypothesis::LinkEvidence;

/// On a bounded time a continuous formula is uniformly continuous; for ever it may swing faster and faster.
const SWINGS: &str = "a formula could not be shown to be uniformly continuous for ever, as it is on the run";

pub(super) fn words(evidence: &LinkEvidence) -> String {
    match evidence {
        LinkEvidence::RefutedDelay { words, fault } => {
            format!("{words} is not what its author declares: {fault}")
        }
        LinkEvidence::Delays { bound_s, unknown, end_s, holds_packets, basis } => {
            let bound = seconds(*bound_s);
            let pieces = if *holds_packets { "; between the arrivals of packets it grows like t" } else { "" };
            if unknown.is_empty() {
                let basis = if *basis == Basis::Declared { " (declared, not shown)" } else { "" };
                return format!("no delay exceeds {bound} s{pieces}{basis}");
            }
            let reasons: Vec<&str> = unknown.iter().copied().map(reason).collect();
            format!(
                "no delay exceeds {bound} s until the end of the run at {} s{pieces}; {}",
                seconds(*end_s),
                reasons.join("; ")
            )
        }
        LinkEvidence::Ages { bound_s, timeout_s, .. } => {
            let age = bound_s.map_or("how old one becomes is not known".into(), |bound_s| {
                format!("one becomes {} s old at most", seconds(bound_s))
            });
            format!("{age}, and the sender of one that is older than {} s does not count", seconds(*timeout_s))
        }
        LinkEvidence::Prompt => "no link has a delay".into(),
        LinkEvidence::Late { bound_s } => {
            format!("a delay reaches {} s; the paper follows a leader without delays only", seconds(*bound_s))
        }
        LinkEvidence::Weights { low, high, until_s, bounded_for_ever } => {
            let stay = format!("weights that follow a formula stay from {} to {}", seconds(*low), seconds(*high));
            let reason = if *bounded_for_ever { SWINGS } else { "for ever could not be shown" };
            match until_s {
                None => stay,
                Some(end_s) => format!("{stay} until the end of the run at {} s; {reason}", seconds(*end_s)),
            }
        }
        LinkEvidence::Coupling { size } => {
            format!("its slope at zero is one and it grows more slowly from there; its size is {size}")
        }
    }
}

fn reason(unknown: Unknown) -> &'static str {
    match unknown {
        Unknown::FormulaBound => "a formula could not be shown to be bounded for ever",
        Unknown::FormulaContinuity => SWINGS,
        Unknown::PacketsInARow => {
            "any number of packets may be lost one after another, so no delay is the longest (`most_in_a_row` would bound them)"
        }
        Unknown::LaterPackets => "packets are replayed from a log, which says nothing about later ones",
    }
}

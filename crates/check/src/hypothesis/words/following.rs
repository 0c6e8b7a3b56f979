//! What follows a leader.

use forwardstep_core::reference::Choice;
use forwardstep_sim::formula::Witness;

use super::numbers::{Shown, as_it_is, bound, bound_below, reached_above, rounded, rounded_up, seconds};
use crate::hypothesis::evidence::MOST_LEFT;
use crate::hypothesis::{Answer, FollowingEvidence};

pub(super) fn words(evidence: &FollowingEvidence) -> String {
    match evidence {
        FollowingEvidence::Gain { gamma, seen, on_run, for_ever, reached, unbounded, end_s } => match reached {
            _ if evidence.answer() == Answer::Holds => {
                format!("γ is {}, and it never exceeds {}", as_it_is(*gamma), bound_below(*for_ever, *gamma))
            }
            Some(Witness { t_s, value }) => {
                let (t_s, value) = (rounded(*t_s), reached_above(value.abs(), *gamma));
                let grows = if *unbounded { GROWS } else { "" };
                format!("γ is {}, but at t = {t_s} s it is {value}{grows}", as_it_is(*gamma))
            }
            None if *unbounded => format!("γ is {}{GROWS}", as_it_is(*gamma)),
            None => not_shown([*gamma, *seen, *on_run, *for_ever], *end_s),
        },
        FollowingEvidence::GainOverAgent { gamma } => format!(
            "γ is {}; the leader is an agent, and the run says how large it becomes, and when it exceeds γ for the last time",
            as_it_is(*gamma)
        ),
        FollowingEvidence::GainOverTarget { gamma, leader, reached: Witness { t_s, value }, arrives, .. } => {
            let keeps = if *arrives { "comes to keep to" } else { "is to keep to" };
            format!(
                "γ is {}, and {} {keeps} a target along which it is {} at t = {} s, and again and again",
                as_it_is(*gamma),
                leader.name,
                reached_above(value.abs(), *gamma),
                rounded(*t_s)
            )
        }
        FollowingEvidence::Sign { choice, sampled, lags, period_s, left, scale, end_s, .. } => {
            let every = match sampled {
                false => format!("every {} s", seconds(*period_s)),
                true => "at every sample".to_owned(),
            };
            match choice {
                Choice::Implicit if *lags => format!(
                    "a value of it is solved for {every}, from motions that show what it did only later, as torques come late or velocities are \
                     filtered: it chatters, with all of γ, and how much of qᵢ − q₀ that leaves is not known"
                ),
                Choice::Implicit => format!("a value of it is solved for {every}{}", held(*left, *scale, *period_s >= *end_s)),
                Choice::Explicit => format!("it is set to 1 or −1 {every}, and chatters at that rate"),
                Choice::Layer { width } => {
                    format!("it is replaced by sat(e/ε) with ε = {width}: an error of that size stays")
                }
            }
        }
        FollowingEvidence::Shared { slow: false } => "they belong to the design, not to an agent".into(),
        FollowingEvidence::Shared { slow: true } => {
            "they belong to the design, not to an agent; note that (119) converges very slowly from an estimate of zero, \
             since its sign sees accelerations, which the estimated inertia scales"
                .into()
        }
        FollowingEvidence::NotPrinted => {
            "Remark 11 names it; what it needs was derived for this software and follows".into()
        }
        FollowingEvidence::CouplingExceeds { least } => format!("k λ exceeds {}", rounded_up(*least)),
        FollowingEvidence::CouplingNotShown { least, .. } => {
            format!("k λ could not be shown to exceed {}", rounded_up(*least))
        }
        FollowingEvidence::ComplexRoots => "p² + β p + α has no real roots".into(),
        FollowingEvidence::GraphSwitches => "the graph switches".into(),
        FollowingEvidence::WeightVaries => "a weight varies with time".into(),
    }
}

/// What is left where a sign is held.
fn held(left: f64, scale: f64, once: bool) -> String {
    let left = if left.is_finite() {
        let beside = match left > MOST_LEFT * scale {
            true => format!(", where the leader moves and agents start away from it by {} at most", rounded(scale)),
            false => String::new(),
        };
        format!(
            "; held in between, it leaves an error qᵢ − q₀ of up to about {} in units of the axes{beside}",
            rounded_up(left)
        )
    } else {
        String::new()
    };
    format!("{}{left}", if once { ", so once on this run" } else { "" })
}

/// What drives the leader away.
const GROWS: &str = ", and it exceeds every bound later";

/// Where a bound is not below γ, and no value is certain to reach it.
fn not_shown([gamma, seen, on_run, for_ever]: [f64; 4], end_s: f64) -> String {
    let (end_s, sampled) =
        (seconds(end_s), format!("by sampling, which is no proof, it comes to {}", near(seen, gamma)));
    let run = if on_run < gamma {
        format!("it does not exceed {} until {end_s} s", bound_below(on_run, gamma))
    } else {
        sampled
    };
    let ever = if for_ever.is_finite() {
        format!("only {} could be shown", bound(for_ever))
    } else {
        "no bound could be shown".to_owned()
    };
    format!("γ is {}, and {run}; for all time {ever}", as_it_is(gamma))
}

/// A number with as many digits as tell it from another.
fn near(value: f64, other: f64) -> Shown {
    if value < other { bound_below(value, other) } else { reached_above(value, other) }
}

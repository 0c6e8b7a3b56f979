//! What follows a leader.

use forwardstep_core::reference::Choice;

use super::numbers::{rounded_up, seconds};
use crate::hypothesis::{Answer, FollowingEvidence};

pub(super) fn words(evidence: &FollowingEvidence) -> String {
    match evidence {
        FollowingEvidence::Gain { gamma, seen, on_run, for_ever, end_s } => {
            gain(evidence.answer(), [*gamma, *seen, *on_run, *for_ever], *end_s)
        }
        FollowingEvidence::GainOverAgent { gamma } => format!(
            "γ is {gamma}; the leader is an agent, and the run says how large it becomes, and when it exceeds γ for the last time"
        ),
        FollowingEvidence::Sign { choice, period_s } => {
            let every = match period_s {
                Some(period_s) => format!("every {} s", seconds(*period_s)),
                None => "at every sample".to_owned(),
            };
            match choice {
                Choice::Implicit => format!("a value of it is solved for {every}"),
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
        FollowingEvidence::CouplingNotShown { least } => format!(
            "k λ could not be shown to exceed {}: a larger coupling or larger weights would",
            rounded_up(*least)
        ),
        FollowingEvidence::ComplexRoots => "p² + β p + α has no real roots".into(),
        FollowingEvidence::GraphSwitches => "the graph switches".into(),
        FollowingEvidence::WeightVaries => "a weight varies with time".into(),
    }
}

/// γ beside what it must exceed.
fn gain(answer: Answer, [gamma, seen, on_run, for_ever]: [f64; 4], end_s: f64) -> String {
    match answer {
        Answer::Violated => format!("γ is {gamma}, but it reaches {} on the run", rounded_up(seen)),
        Answer::Holds => format!("γ is {gamma}, and it never exceeds {}", rounded_up(for_ever)),
        Answer::HoldsOnHorizon => {
            let beyond = if for_ever.is_finite() {
                format!("for all time only {} could be shown", rounded_up(for_ever))
            } else {
                "for all time no bound could be shown".to_owned()
            };
            let (bound, end_s) = (rounded_up(on_run), seconds(end_s));
            format!("γ is {gamma}, and it does not exceed {bound} until {end_s} s; {beyond}")
        }
        Answer::NotShown | Answer::NotCovered | Answer::Watched => format!(
            "γ is {gamma}, and by sampling, which is no proof, it reaches {} on the run; no bound below γ could be shown",
            rounded_up(seen)
        ),
    }
}

//! What the laws of Section V ask for, law by law.

use forwardstep_sim::{
    Adaptive, AgentSetup, AttitudeLaw, ChainLaw, Known, Law, PositionOnlyLaw, ReferenceKind, Setup, TaskSpaceLaw,
    ThrustLaw,
};

use crate::chains;
use crate::single;
use crate::vehicles;
use crate::verdict::{Answer, Hypothesis};

/// The theorem or remark that speaks about agents that all have the same law of Section V, and what it promises; nothing for
/// (6)–(7), which Section III treats, and for agents that differ.
pub(crate) fn theorem(setup: &Setup) -> Option<(String, String)> {
    let first = setup.agents.first()?;
    if let Some(words) = mixture(setup) {
        let promises = "all agents agree and come to rest: x_i − x_j → 0 and dx_i → 0".into();
        return Some((format!("no single theorem: {words} side by side"), promises));
    }
    let law = &first.law;
    if let Some(law) = law.downcast::<ThrustLaw>() {
        return Some(vehicles::theorem(setup, law.design));
    }
    if law.is::<ChainLaw>() {
        return Some(chains::theorem(setup));
    }
    let (theorem, promises) = if law.is::<PositionOnlyLaw>() && setup.reference == ReferenceKind::Tracking {
        (
            "Section V-A, (a8) with the reference dynamics (a9)".into(),
            "x − x_d → 0 and dx − dx_d → 0 without a measured velocity",
        )
    } else if law.is::<PositionOnlyLaw>() {
        (
            format!("Remark 7, (a8) with (24) of order {} in z", first.roots_per_s.len()),
            "all agents agree and come to rest without a measured velocity: x_i − x_j → 0 and dx_i → 0",
        )
    } else if law.is::<TaskSpaceLaw>() {
        (
            "Theorem 6, (80) to (82) with the reference dynamics (76)".into(),
            "x − x_d → 0 and dx − dx_d → 0 with uncertain lengths and parameters, without a measured dx",
        )
    } else if law.is::<AttitudeLaw>() {
        (
            "Theorem 7, (99) to (105) with the reference dynamics (97)".into(),
            "the attitude and its rate reach those of the target, Δq_v → 0 and ω − ω_d → 0, without a measured ω",
        )
    } else {
        return None;
    };
    Some((theorem, promises.into()))
}

/// What the laws themselves ask for.
pub(crate) fn of_laws(setup: &Setup) -> Vec<Hypothesis> {
    let mut hypotheses = Vec::new();
    hypotheses.extend(mixed(setup));
    hypotheses.extend(position_only(setup));
    hypotheses.extend(vehicles::of_vehicles(setup));
    hypotheses.extend(single::task_space(setup));
    hypotheses.extend(single::attitude(setup));
    hypotheses.extend(chains::of_chains(setup));
    hypotheses
}

/// The laws of agents that differ in kind, in words; nothing where they do not, and where all are Lagrangian robots.
fn mixture(setup: &Setup) -> Option<String> {
    let kind = |agent: &AgentSetup| {
        let law = &agent.law;
        match law.downcast::<ThrustLaw>() {
            Some(law) => vehicles::source(law.design),
            None if law.is::<PositionOnlyLaw>() => "Remark 7",
            None if law.is::<TaskSpaceLaw>() => "Theorem 6",
            None if law.is::<AttitudeLaw>() => "Theorem 7",
            None if law.is::<ChainLaw>() => "Section IV",
            None => "Theorem 3 with (24)",
        }
    };
    if setup.reference == ReferenceKind::Tracking {
        return None;
    }
    let mut kinds: Vec<&str> = setup.agents.iter().map(kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    (kinds.len() > 1).then(|| kinds.join(", "))
}

fn mixed(setup: &Setup) -> Option<Hypothesis> {
    mixture(setup).map(|words| Hypothesis {
        requires: "all agents are of the kind that one theorem speaks about".into(),
        answer: Answer::NotCovered,
        because: format!(
            "there are agents of {words}; all transmit the same and follow the same reference dynamics, and what the law of \
             each leaves behind vanishes, so the argument of the theorems should carry over, but the paper does not say so"
        ),
    })
}

/// The agents with a law of this kind.
pub(crate) fn with<L: Law>(setup: &Setup) -> Vec<(&AgentSetup, &L)> {
    setup.agents.iter().filter_map(|agent| Some((agent, agent.law.downcast()?))).collect()
}

/// Whether (6)–(7) or (6) with known parameters controls the agent.
pub(crate) fn is_lagrangian(agent: &AgentSetup) -> bool {
    agent.law.is::<Adaptive>() || agent.law.is::<Known>()
}

fn position_only(setup: &Setup) -> Option<Hypothesis> {
    let agents = with::<PositionOnlyLaw>(setup);
    if agents.is_empty() {
        return None;
    }
    let requires = "k, λ_f and γ* are positive".into();
    let wrong = agents
        .iter()
        .find(|(agent, law)| law.adaptation == 0.0 && agent.robot.theta.first() != Some(&law.estimate_start));
    Some(match wrong {
        Some((agent, _)) => Hypothesis {
            requires,
            answer: Answer::NotCovered,
            because: format!("{} does not adapt its estimate, which is not the true mass", agent.name),
        },
        None => Hypothesis {
            requires,
            answer: Answer::Holds,
            because: "checked when they were read; an estimate that is not adapted is the true mass".into(),
        },
    })
}

//! What the laws of Section V ask for, law by law.

use forwardstep_sim::{AgentSetup, Law, ReferenceKind, Setup};

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
    match (&first.law, &setup.reference) {
        (Law::Adaptive { .. } | Law::Known { .. }, _) => None,
        (Law::Thrust(law), _) => Some(vehicles::theorem(setup, law.design)),
        (Law::Chain(_), _) => Some(chains::theorem(setup)),
        (Law::PositionOnly { .. }, ReferenceKind::Tracking) => Some((
            "Section V-A, (a8) with the reference dynamics (a9)".into(),
            "x − x_d → 0 and dx − dx_d → 0 without a measured velocity".into(),
        )),
        (Law::TaskSpace(_), _) => Some((
            "Theorem 6, (80) to (82) with the reference dynamics (76)".into(),
            "x − x_d → 0 and dx − dx_d → 0 with uncertain lengths and parameters, without a measured dx".into(),
        )),
        (Law::Attitude(_), _) => Some((
            "Theorem 7, (99) to (105) with the reference dynamics (97)".into(),
            "the attitude and its rate reach those of the target, Δq_v → 0 and ω − ω_d → 0, without a measured ω"
                .into(),
        )),
        (Law::PositionOnly { .. }, _) => Some((
            format!("Remark 7, (a8) with (24) of order {} in z", first.roots_per_s.len()),
            "all agents agree and come to rest without a measured velocity: x_i − x_j → 0 and dx_i → 0".into(),
        )),
    }
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
    let kind = |agent: &AgentSetup| match &agent.law {
        Law::Adaptive { .. } | Law::Known { .. } => "Theorem 3 with (24)",
        Law::PositionOnly { .. } => "Remark 7",
        Law::Thrust(law) => vehicles::source(law.design),
        Law::TaskSpace(_) => "Theorem 6",
        Law::Attitude(_) => "Theorem 7",
        Law::Chain(_) => "Section IV",
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

/// The agents with a law for which `is` holds.
pub(crate) fn with(setup: &Setup, is: fn(&Law) -> bool) -> Vec<&AgentSetup> {
    setup.agents.iter().filter(|agent| is(&agent.law)).collect()
}

fn position_only(setup: &Setup) -> Option<Hypothesis> {
    let agents = with(setup, |law| matches!(law, Law::PositionOnly { .. }));
    if agents.is_empty() {
        return None;
    }
    let requires = "k, λ_f and γ* are positive".into();
    let wrong = agents.iter().find(|agent| match agent.law {
        Law::PositionOnly { adaptation, estimate_start, .. } => {
            adaptation == 0.0 && agent.robot.theta.first() != Some(&estimate_start)
        }
        _ => false,
    });
    Some(match wrong {
        Some(agent) => Hypothesis {
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

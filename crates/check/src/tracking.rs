//! One agent and a target of its own: Sections V-A and V-C.

use std::ops::RangeInclusive;

use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AgentSetup, Law, ReferenceKind, Setup};

use crate::hypotheses::{gains, unlimited_torque};
use crate::laws;
use crate::sampled::digital;
use crate::verdict::{Answer, Hypothesis, Report};

/// Whether agents follow targets of their own.
pub(crate) fn is_tracking(setup: &Setup) -> bool {
    setup.reference == ReferenceKind::Tracking
}

/// What is promised to agents that follow targets of their own.
pub(crate) fn check(setup: &Setup) -> Report {
    let (theorem, promises) = laws::theorem(setup).unwrap_or_else(|| {
        ("a theorem of Section V for every agent".into(), "every agent reaches its own target".into())
    });
    let mut hypotheses: Vec<Hypothesis> =
        setup.agents.iter().filter_map(|agent| bounded_target(setup, agent)).collect();
    hypotheses.extend(laws::of_laws(setup));
    if setup.agents.iter().any(|agent| agent.law.is_lagrangian()) {
        hypotheses.push(gains(setup));
    }
    hypotheses.push(unlimited_torque(setup));
    hypotheses.extend(digital(setup));
    Report { theorem, promises, hypotheses }
}

/// How many derivatives of its target a law needs to be bounded.
fn derivatives(agent: &AgentSetup) -> usize {
    match &agent.law {
        Law::PositionOnly { .. } => 3,
        Law::Thrust(law) if law.design.order() == 2 => 3,
        Law::Thrust(_) => 4,
        Law::Chain(_) => agent.roots_per_s.len(),
        _ => 2,
    }
}

/// Whether the target, or the offset, of an agent is bounded with as many derivatives as its law needs.
pub(crate) fn bounded_target(setup: &Setup, agent: &AgentSetup) -> Option<Hypothesis> {
    let target = agent.target.as_ref()?;
    let needed = derivatives(agent);
    let ordinal = ["zeroth", "first", "second", "third", "fourth"][needed.min(4)];
    // A formation may travel: of an offset only the derivatives count.
    let (what, lowest) = if is_tracking(setup) { ("target", 0) } else { ("offset", 1) };
    let requires = match lowest {
        0 => format!("the {what} of {} and its derivatives up to the {ordinal} are bounded", agent.name),
        _ => format!("the derivatives of the {what} of {} up to the {ordinal} are bounded", agent.name),
    };
    let bounded = |until_s: Option<f64>| all_bounded(target, lowest..=needed, until_s);
    let (answer, because) = if bounded(None) {
        (Answer::Holds, "interval arithmetic bounds them for all time".to_owned())
    } else if bounded(Some(setup.time.end_s)) {
        (Answer::HoldsOnHorizon, "interval arithmetic bounds them on the run, not for all time".to_owned())
    } else {
        (Answer::NotCovered, "they could not be shown to be bounded, not even on the run".to_owned())
    };
    Some(Hypothesis { requires, answer, because })
}

fn all_bounded(target: &Trajectory, derivatives: RangeInclusive<usize>, until_s: Option<f64>) -> bool {
    (0..target.axes()).all(|axis| derivatives.clone().all(|k| target.hull(axis, k, until_s).is_finite()))
}

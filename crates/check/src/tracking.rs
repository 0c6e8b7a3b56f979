//! One agent and a target of its own: Sections V-A and V-C.

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
fn derivatives(law: &Law) -> usize {
    match law {
        Law::PositionOnly { .. } => 3,
        _ => 2,
    }
}

fn bounded_target(setup: &Setup, agent: &AgentSetup) -> Option<Hypothesis> {
    let target = agent.target.as_ref()?;
    let needed = derivatives(&agent.law);
    let ordinal = if needed == 3 { "third" } else { "second" };
    let requires = format!("the target of {} and its derivatives up to the {ordinal} are bounded", agent.name);
    let bounded = |until_s: Option<f64>| all_bounded(target, needed, until_s);
    let (answer, because) = if bounded(None) {
        (Answer::Holds, "interval arithmetic bounds them for all time".to_owned())
    } else if bounded(Some(setup.time.end_s)) {
        (Answer::HoldsOnHorizon, "interval arithmetic bounds them on the run, not for all time".to_owned())
    } else {
        (Answer::NotCovered, "they could not be shown to be bounded, not even on the run".to_owned())
    };
    Some(Hypothesis { requires, answer, because })
}

fn all_bounded(target: &Trajectory, derivatives: usize, until_s: Option<f64>) -> bool {
    (0..target.axes()).all(|axis| (0..=derivatives).all(|k| target.hull(axis, k, until_s).is_finite()))
}

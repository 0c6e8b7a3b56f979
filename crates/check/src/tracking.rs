//! One agent and a target of its own: Sections V-A and V-C.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AgentSetup, ChainLaw, PositionOnlyLaw, ReferenceKind, Setup, ThrustLaw};

use crate::hypotheses::{gains, names, unlimited_torque};
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
    let mut hypotheses = bounded_targets(setup);
    hypotheses.extend(laws::of_laws(setup));
    if setup.agents.iter().any(|agent| laws::is_lagrangian(agent)) {
        hypotheses.push(gains(setup));
    }
    hypotheses.push(unlimited_torque(setup));
    hypotheses.extend(digital(setup));
    Report { theorem, promises, hypotheses }
}

/// How many derivatives of its target a law needs to be bounded.
fn derivatives(agent: &AgentSetup) -> usize {
    if agent.law.is::<PositionOnlyLaw>() {
        3
    } else if let Some(law) = agent.law.downcast::<ThrustLaw>() {
        law.design.order() + 1
    } else if agent.law.is::<ChainLaw>() {
        agent.roots_per_s.len()
    } else {
        2
    }
}

/// Whether the targets, or the offsets, are bounded with as many derivatives as the laws need. Agents with the same answer
/// share a hypothesis.
pub(crate) fn bounded_targets(setup: &Setup) -> Vec<Hypothesis> {
    let mut groups: BTreeMap<(usize, Answer), Vec<usize>> = BTreeMap::new();
    for (index, agent) in setup.agents.iter().enumerate() {
        if let Some(target) = &agent.target {
            let needed = derivatives(agent).min(4);
            groups.entry((needed, bounded(setup, target, needed))).or_default().push(index);
        }
    }
    // A formation may travel: of an offset only the derivatives count.
    let subject = |agents: &[usize]| match (is_tracking(setup), names(setup, agents)) {
        (true, names) => format!("the target of {names} and its derivatives"),
        (false, names) => format!("the derivatives of the offset of {names}"),
    };
    let hypothesis = |((needed, answer), agents): ((usize, Answer), Vec<usize>)| {
        let ordinal = ["zeroth", "first", "second", "third", "fourth"][needed];
        let because = match answer {
            Answer::Holds => "interval arithmetic bounds them for all time",
            Answer::HoldsOnHorizon => "interval arithmetic bounds them on the run, not for all time",
            _ => "they could not be shown to be bounded, not even on the run",
        };
        let requires = format!("{} up to the {ordinal} are bounded", subject(&agents));
        Hypothesis { requires, answer, because: because.into() }
    };
    groups.into_iter().map(hypothesis).collect()
}

fn bounded(setup: &Setup, target: &Trajectory, needed: usize) -> Answer {
    let lowest = if is_tracking(setup) { 0 } else { 1 };
    if all_bounded(target, lowest..=needed, None) {
        Answer::Holds
    } else if all_bounded(target, lowest..=needed, Some(setup.time.end_s)) {
        Answer::HoldsOnHorizon
    } else {
        Answer::NotCovered
    }
}

fn all_bounded(target: &Trajectory, derivatives: RangeInclusive<usize>, until_s: Option<f64>) -> bool {
    (0..target.axes()).all(|axis| derivatives.clone().all(|k| target.hull(axis, k, until_s).is_finite()))
}

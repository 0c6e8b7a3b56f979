//! Agents that follow targets of their own: Sections V-A and V-C; and offsets in a formation.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use forwardstep_sim::Setup;
use forwardstep_sim::trajectory::Trajectory;

use crate::hypothesis::{Bounded, Hypothesis, Id, MotionEvidence, Named, Subject};
use crate::kinds::Claim;
use crate::laws::{self, kind_of};
use crate::report::Report;
use crate::surroundings::{applied_torque, digital, pushes_end};
use crate::theorem::Theorem;

/// Trajectories have as many derivatives.
const MOST_DERIVATIVES: usize = 4;

/// What is promised to agents that follow targets of their own.
pub(super) fn check(setup: &Setup) -> Report {
    let Claim { theorem, promises } = laws::claim(setup)
        .unwrap_or_else(|| Claim { theorem: Theorem::Targets, promises: "every agent reaches its own target".into() });
    let mut hypotheses = bounded(setup);
    hypotheses.extend(pushes_end(setup));
    hypotheses.extend(laws::hypotheses(setup));
    hypotheses.push(applied_torque(setup));
    hypotheses.extend(digital(setup));
    Report { theorem, promises, hypotheses }
}

/// Whether the targets, or the offsets, are bounded with as many derivatives as the laws need. Agents with the same answer
/// share a hypothesis.
pub(super) fn bounded(setup: &Setup) -> Vec<Hypothesis> {
    let mut groups: BTreeMap<(usize, Bounded, bool), Vec<Named>> = BTreeMap::new();
    for (index, agent) in setup.agents.iter().enumerate() {
        if let Some(target) = &agent.target {
            let needed = kind_of(agent).target_derivatives(agent).min(MOST_DERIVATIVES);
            let tracking = setup.tracks(index);
            // A formation may travel: of an offset only the derivatives count.
            let lowest = if tracking { 0 } else { 1 };
            let bounded = how_far(target, lowest..=needed, setup.time.end_s);
            groups.entry((needed, bounded, tracking)).or_default().push(Named::of(setup, index));
        }
    }
    let hypothesis = |((derivatives, bounded, tracking), agents): ((usize, Bounded, bool), Vec<Named>)| {
        let subject =
            if tracking { Subject::Targets { agents, derivatives } } else { Subject::Offsets { agents, derivatives } };
        Hypothesis::about(Id::BoundedTarget, subject, MotionEvidence::Derivatives(bounded))
    };
    groups.into_iter().map(hypothesis).collect()
}

/// How far interval arithmetic bounds some derivatives of a trajectory.
pub(super) fn how_far(trajectory: &Trajectory, derivatives: RangeInclusive<usize>, end_s: f64) -> Bounded {
    let all = |until_s: Option<f64>| {
        let finite = |axis, k| trajectory.hull(axis, k, until_s).is_finite();
        (0..trajectory.axes()).all(|axis| derivatives.clone().all(|k| finite(axis, k)))
    };
    if all(None) {
        Bounded::ForEver
    } else if all(Some(end_s)) {
        Bounded::OnRun
    } else {
        Bounded::NotShown
    }
}

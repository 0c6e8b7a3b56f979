//! Agents that follow targets of their own: Sections V-A and V-C; and offsets in a formation.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use forwardstep_sim::reference::Desired;
use forwardstep_sim::trajectory::{Path, Trajectory};
use forwardstep_sim::{AgentSetup, AttitudeLaw, Law, PassivityFilterLaw, Setup, TaskSpaceLaw};

use crate::hypothesis::{Bounded, Hypothesis, Id, MotionEvidence, Named, ReferenceEvidence, Subject};
use crate::inertia::bounded_anywhere;
use crate::kinds::{Claim, is_lagrangian};
use crate::laws::{self, kind_of};
use crate::report::Report;
use crate::theorem::Theorem;

/// What is promised to agents that follow targets of their own. All that is asked is asked of their laws and targets.
pub(super) fn check(setup: &Setup) -> Report {
    let Claim { theorem, promises } = laws::claim(setup).unwrap_or_else(|| Claim {
        theorem: Theorem::Targets(Vec::new()),
        promises: "every agent reaches its own target".into(),
    });
    Report { theorem, promises, hypotheses: Vec::new() }
}

/// That the polynomials of those of `agents` that follow targets by roots are Hurwitz: (a9), and (43) when it tracks. What is left without s is
/// one linear system with these roots for each agent, real or not.
pub(crate) fn hurwitz(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let tracking = agents.iter().filter(|agent| setup.tracks(**agent));
    let slowest = tracking.filter_map(|agent| setup.agents[*agent].roots_per_s.slowest_per_s()).reduce(f64::min)?;
    Some(Hypothesis::new(Id::Hurwitz, ReferenceEvidence::Hurwitz { slowest_per_s: slowest }))
}

/// Whether the targets, or the offsets, are bounded with as many derivatives as the laws need. Agents with the same answer
/// share a hypothesis.
pub(super) fn bounded(setup: &Setup) -> Vec<Hypothesis> {
    let mut groups: BTreeMap<Group, Vec<Named>> = BTreeMap::new();
    for (index, agent) in setup.agents.iter().enumerate() {
        if let Some(target) = &agent.target {
            let desired = setup.reference.downcast::<Desired>().map(|desired| desired.polynomial.order());
            let needed = desired.unwrap_or_else(|| kind_of(agent).target_derivatives(agent));
            let tracking = setup.tracks(index);
            let lowest = lowest_asked(setup, index);
            let known = |target: &Trajectory| how_far(target, lowest..=needed, setup.time.end_s);
            let bounded = match (known(target), attitude_from(agent)) {
                // A quaternion of any length: that it grows says nothing of the attitude.
                (Bounded::Unbounded { .. }, Some(first)) => {
                    let position = target.paths().get(..first).and_then(|paths| Trajectory::new(paths.to_vec()).ok());
                    match position.as_ref().map(known) {
                        Some(unbounded @ Bounded::Unbounded { .. }) => unbounded,
                        Some(Bounded::ForEver | Bounded::NotShown | Bounded::Jumps) | None => Bounded::NotShown,
                    }
                }
                (bounded, _) => bounded,
            };
            let group = Group { derivatives: needed, lowest, tracking, bounded };
            groups.entry(group).or_default().push(Named::of(setup, index));
        }
    }
    let hypothesis = |(Group { derivatives, lowest, bounded, tracking }, agents): (Group, Vec<Named>)| {
        let subject = match tracking {
            true => Subject::Targets { agents, derivatives, travels: lowest > 0 },
            false => Subject::Offsets { agents, derivatives },
        };
        Hypothesis::about(Id::BoundedTarget, subject, MotionEvidence::Derivatives(bounded))
    };
    groups.into_iter().map(hypothesis).collect()
}

/// The lowest derivative of a target, or of an offset, that has to be bounded. A formation may travel. So may a robot under (6)–(7) whose M, C
/// and g stay bounded wherever it is, as that of revolute joints: Y(q, q̇, z, ż) is, as soon as q̇_d and q̈_d are, and q − q_d obeys an equation in
/// which q_d does not occur. Where a target stays, that is said.
pub(crate) fn lowest_asked(setup: &Setup, index: usize) -> usize {
    let agent = &setup.agents[index];
    let stays =
        || agent.target.iter().all(|target| (0..target.axes()).all(|axis| target.is_bounded(axis, 0) == Some(true)));
    let desired = setup.reference.downcast::<Desired>();
    let is_linear = desired.is_none_or(|it| it.coupling.is_none() && it.heard.is_empty() && it.protocol.is_none());
    let may_travel = || is_lagrangian(agent) && is_linear && bounded_anywhere(agent) && !stays();
    usize::from(!setup.tracks(index) || may_travel())
}

/// The first entry of the quaternion in what is followed, which of any length stands for an attitude.
fn attitude_from(agent: &AgentSetup) -> Option<usize> {
    if agent.law.is::<AttitudeLaw>() || agent.law.is::<PassivityFilterLaw>() {
        return Some(0);
    }
    agent.law.downcast::<TaskSpaceLaw>()?.interface(&agent.robot)?.coordinates?.quaternion
}

/// Agents that share a hypothesis: those of which the same is asked and found.
#[derive(Clone, Copy, PartialEq)]
struct Group {
    derivatives: usize,
    lowest: usize,
    tracking: bool,
    bounded: Bounded,
}

impl Group {
    /// What tells groups apart, in the order in which they are listed.
    fn key(&self) -> (usize, u8, [u64; 3], bool, usize) {
        let (rank, numbers) = match self.bounded {
            Bounded::ForEver => (0, [0; 3]),
            Bounded::NotShown => (1, [0; 3]),
            Bounded::Jumps => (3, [0; 3]),
            Bounded::Unbounded { derivative, witness } => {
                let [t_s, value] = witness.map_or([0; 2], |found| [found.t_s, found.value].map(f64::to_bits));
                (2, [derivative as u64, t_s, value])
            }
        };
        (self.derivatives, rank, numbers, self.tracking, self.lowest)
    }
}

impl Eq for Group {}

impl PartialOrd for Group {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Group {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

/// What is known of the bounds of some derivatives of a trajectory for all time.
pub(super) fn how_far(trajectory: &Trajectory, derivatives: RangeInclusive<usize>, end_s: f64) -> Bounded {
    let mut found = Bounded::ForEver;
    for (axis, derivative) in (0..trajectory.axes()).flat_map(|axis| derivatives.clone().map(move |k| (axis, k))) {
        match trajectory.is_bounded(axis, derivative) {
            Some(true) => {}
            Some(false) => {
                let witness = trajectory.seen_to_grow(axis, derivative, end_s);
                return Bounded::Unbounded { derivative, witness };
            }
            None if matches!(trajectory.paths().get(axis), Some(Path::Spline(_))) => found = Bounded::Jumps,
            None => found = Bounded::NotShown,
        }
    }
    found
}

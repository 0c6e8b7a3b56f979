//! Whether a tip can get to its target at all.

use std::sync::Arc;

use forwardstep_core::expression::Interval;
use forwardstep_core::robot::tree::Tree;
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AgentSetup, TaskSpaceLaw, TipSetup};

use crate::hypothesis::{MotionExtent, ReachSide, RobotEvidence};

/// Times at which a target is looked at.
const LOOKS: u32 = 4000;
/// Distances that differ by less than this part of them do so by rounding.
const ROUNDING: f64 = 1e-9;

/// Where a tip can be: between two distances from a point, in the coordinates that are controlled.
pub(crate) struct Reach {
    pub(crate) from: Vec<f64>,
    pub(crate) least: f64,
    pub(crate) most: f64,
    /// Whether every such place can be reached, or only no other.
    pub(crate) exact: bool,
}

/// Whether the target is within reach, as far as that is known; nothing for a tip that slides.
pub(crate) fn within_reach(agent: &AgentSetup, law: &TaskSpaceLaw, end_s: f64) -> Option<RobotEvidence> {
    let (target, reach) = (agent.target.as_ref()?, reach(agent, law)?);
    let for_ever = extent(target, &reach, None);
    if reach.holds(for_ever) {
        return Some(reach.within(for_ever, true));
    }
    let seen = looks(target, &reach, end_s);
    if let Some((side, t_s, distance_m)) = seen.out {
        let limit_m = reach.limit(side);
        return Some(RobotEvidence::OutOfReach { side, t_s, distance_m, limit_m });
    }
    // Between two looks it gets no farther than its speed takes it.
    let on_run = extent(target, &reach, Some(end_s));
    let speed = (0..reach.from.len()).map(|axis| target.hull(axis, 1, Some(end_s)).size());
    let room =
        0.5 * end_s / f64::from(LOOKS) * speed.map(|speed| speed * speed).sum::<f64>().sqrt() + ROUNDING * reach.most;
    let room = if room.is_finite() { room } else { f64::INFINITY };
    let most = (seen.farthest + room).min(on_run.most);
    let least = (seen.nearest - room).max(on_run.least);
    let shown = MotionExtent { least, most };
    Some(if reach.holds(shown) {
        reach.within(shown, false)
    } else {
        RobotEvidence::ReachNotShown {
            seen: MotionExtent { least: seen.nearest, most: seen.farthest },
            reach: MotionExtent { least: reach.least, most: reach.most },
        }
    })
}

impl Reach {
    /// Whether a tip that keeps between these distances stays within reach and off its edge, where no Jacobian is regular.
    fn holds(&self, MotionExtent { least, most }: MotionExtent) -> bool {
        most < self.most && (!self.has_inner_edge() || least > self.least)
    }

    /// Whether places that are too near are known.
    fn has_inner_edge(&self) -> bool {
        self.exact || self.least > 0.0
    }

    fn limit(&self, side: ReachSide) -> f64 {
        match side {
            ReachSide::Beyond => self.most,
            ReachSide::Inside => self.least,
        }
    }

    /// On which side of what can be reached a place is at this distance, by more than rounding.
    fn out(&self, distance_m: f64) -> Option<ReachSide> {
        let room = ROUNDING * self.most;
        if distance_m > self.most + room {
            Some(ReachSide::Beyond)
        } else if self.has_inner_edge() && (distance_m < self.least - room || distance_m <= room) {
            Some(ReachSide::Inside)
        } else {
            None
        }
    }

    fn within(&self, target: MotionExtent, for_ever: bool) -> RobotEvidence {
        let reach = MotionExtent { least: self.least, most: self.most };
        RobotEvidence::WithinReach { target, reach, exact: self.exact, for_ever }
    }
}

/// What the tip of an agent can reach; nothing for a tip that slides.
pub(crate) fn reach(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<Reach> {
    match &law.tip {
        TipSetup::Planar(tip) => law.tip.parameters(&*agent.robot.kind).is_some().then(|| {
            let [first, second] = tip.length_m;
            Reach { from: vec![0.0; 2], least: (first - second).abs(), most: first + second, exact: true }
        }),
        TipSetup::Point { coordinates, .. } => {
            let tip = law.tip.of_tree(agent.robot.kind.downcast::<Arc<Tree>>()?)?.ok()?;
            let (first, [least, most]) = tip.reach()?;
            let from = coordinates.iter().filter_map(|coordinate| first.get(*coordinate).copied()).collect();
            Some(Reach { from, least, most, exact: false })
        }
    }
}

/// How far a target is from where a tip's reach is counted, by bounds of its coordinates.
fn extent(target: &Trajectory, reach: &Reach, end_s: Option<f64>) -> MotionExtent {
    let each = reach.from.iter().enumerate().map(|(axis, from)| target.hull(axis, 0, end_s) - Interval::point(*from));
    let (mut least, mut most) = (Interval::point(0.0), Interval::point(0.0));
    for distance in each {
        let nearest = Interval::point(distance.low.max(-distance.high).max(0.0));
        let farthest = Interval::point(distance.size());
        (least, most) = (least + nearest * nearest, most + farthest * farthest);
    }
    let [least, most] = [least.low.max(0.0).sqrt().next_down(), most.high.sqrt().next_up()];
    // Not-a-number is no bound.
    let most = if most.is_nan() { f64::INFINITY } else { most };
    MotionExtent { least: if least.is_nan() { 0.0 } else { least }, most }
}

/// Where a target was seen, by its distance.
struct Seen {
    nearest: f64,
    farthest: f64,
    /// Where it was first seen out of reach: on which side, when, how far.
    out: Option<(ReachSide, f64, f64)>,
}

fn looks(target: &Trajectory, reach: &Reach, end_s: f64) -> Seen {
    let mut seen = Seen { nearest: f64::INFINITY, farthest: 0.0, out: None };
    let mut jets = vec![[0.0; 5]; target.axes()];
    for look in 0..=LOOKS {
        let t_s = end_s * f64::from(look) / f64::from(LOOKS);
        target.jets(t_s, &mut jets);
        let squares = jets.iter().zip(&reach.from).map(|(jet, from)| (jet[0] - from) * (jet[0] - from));
        let distance = squares.sum::<f64>().sqrt();
        seen.farthest = seen.farthest.max(distance);
        seen.nearest = seen.nearest.min(distance);
        seen.out = seen.out.or_else(|| reach.out(distance).map(|side| (side, t_s, distance)));
    }
    seen
}

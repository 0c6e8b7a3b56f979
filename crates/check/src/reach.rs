//! Whether a tip can get to its target at all.

use std::sync::Arc;

use forwardstep_core::expression::Interval;
use forwardstep_core::robot::tree::Tree;
use forwardstep_sim::trajectory::{Path, Trajectory};
use forwardstep_sim::{AgentSetup, TaskSpaceLaw, TipSetup};

use crate::hypothesis::numbers::seconds;
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

/// Whether the target is within reach for all time: the run tells as much of a motion that is given as a formula as any other stretch.
/// Nothing for a tip that slides.
pub(crate) fn within_reach(agent: &AgentSetup, law: &TaskSpaceLaw, end_s: f64) -> Option<RobotEvidence> {
    let (target, reach) = (agent.target.as_ref()?, reach(agent, law)?);
    let by_box = extent(target, &reach);
    if reach.holds(by_box) {
        return Some(reach.within(by_box));
    }
    let until_s = target.paths().iter().filter_map(Path::rests_s).fold(end_s, f64::max);
    let seen = looks(target, &reach, until_s);
    if let Some(out) = seen.out {
        return Some(reach.out_of(out));
    }
    let shown = match target.squared_distance(&reach.from) {
        Some(square) => Some(roots(square.for_ever().within)),
        None => by_speed(target, &reach, &seen, until_s),
    };
    if let Some(shown) = shown.filter(|shown| reach.holds(*shown)) {
        return Some(reach.within(shown));
    }
    Some(match out_later(target, &reach, until_s) {
        Some(out) => reach.out_of(out),
        None => RobotEvidence::ReachNotShown {
            seen: MotionExtent { least: seen.nearest, most: seen.farthest },
            reach: MotionExtent { least: reach.least, most: reach.most },
        },
    })
}

/// When a target is first seen out of reach, also after the end of the run, s.
pub(crate) fn leaves_s(target: &Trajectory, reach: &Reach, end_s: f64) -> Option<f64> {
    let until_s = target.paths().iter().filter_map(Path::rests_s).fold(end_s, f64::max);
    looks(target, reach, until_s).out.or_else(|| out_later(target, reach, until_s)).map(|out| out.t_s)
}

/// Curves through points, and what does not move, are at rest from the last look on: for them it speaks of all time. Between two looks a
/// target gets no farther than its speed takes it.
fn by_speed(target: &Trajectory, reach: &Reach, seen: &Seen, until_s: f64) -> Option<MotionExtent> {
    let axes = 0..reach.from.len();
    if axes.clone().any(|axis| target.paths()[axis].rests_s().is_none()) {
        return None;
    }
    let squares = axes.map(|axis| target.hull(axis, 1, Some(until_s)).size()).map(|speed| speed * speed);
    let room = 0.5 * until_s / f64::from(LOOKS) * squares.sum::<f64>().sqrt() + ROUNDING * reach.most;
    let room = if room.is_finite() { room } else { f64::INFINITY };
    Some(MotionExtent { least: seen.nearest - room, most: seen.farthest + room })
}

/// What a distance keeps within whose square keeps within this.
fn roots(square: Interval) -> MotionExtent {
    let [least, most] = [square.low.max(0.0).sqrt().next_down(), square.high.sqrt().next_up()];
    // Not-a-number is no bound.
    let most = if most.is_nan() { f64::INFINITY } else { most };
    MotionExtent { least: if least.is_nan() { 0.0 } else { least }, most }
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

    fn within(&self, target: MotionExtent) -> RobotEvidence {
        let reach = MotionExtent { least: self.least, most: self.most };
        RobotEvidence::WithinReach { target, reach, exact: self.exact }
    }

    fn out_of(&self, Out { side, t_s, distance_m }: Out) -> RobotEvidence {
        RobotEvidence::OutOfReach { side, t_s, distance_m, limit_m: self.limit(side) }
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

/// How far a target is from where a tip's reach is counted for all time, by bounds of its coordinates.
fn extent(target: &Trajectory, reach: &Reach) -> MotionExtent {
    let each = reach.from.iter().enumerate().map(|(axis, from)| target.hull(axis, 0, None) - Interval::point(*from));
    let (mut least, mut most) = (Interval::point(0.0), Interval::point(0.0));
    for distance in each {
        let nearest = Interval::point(distance.low.max(-distance.high).max(0.0));
        let farthest = Interval::point(distance.size());
        (least, most) = (least + nearest * nearest, most + farthest * farthest);
    }
    roots(Interval { low: least.low, high: most.high })
}

/// Where a target was seen, by its distance.
struct Seen {
    nearest: f64,
    farthest: f64,
    /// Where it was first seen out of reach.
    out: Option<Out>,
}

/// A target out of reach.
struct Out {
    side: ReachSide,
    t_s: f64,
    distance_m: f64,
}

fn looks(target: &Trajectory, reach: &Reach, end_s: f64) -> Seen {
    let mut seen = Seen { nearest: f64::INFINITY, farthest: 0.0, out: None };
    let mut jets = vec![[0.0; 5]; target.axes()];
    for look in 0..=LOOKS {
        // With six decimals it can be told as it is.
        let t_s = seconds(end_s * f64::from(look) / f64::from(LOOKS));
        target.jets(t_s, &mut jets);
        let squares = jets.iter().zip(&reach.from).map(|(jet, from)| (jet[0] - from) * (jet[0] - from));
        let distance_m = squares.sum::<f64>().sqrt();
        seen.farthest = seen.farthest.max(distance_m);
        seen.nearest = seen.nearest.min(distance_m);
        seen.out = seen.out.or_else(|| reach.out(distance_m).map(|side| Out { side, t_s, distance_m }));
    }
    seen
}

/// Where a target that is a formula is certainly out of reach after the end of the run.
fn out_later(target: &Trajectory, reach: &Reach, end_s: f64) -> Option<Out> {
    let room = ROUNDING * reach.most;
    // Below zero, where no place is too near, it is below every square.
    let [low, high] = [reach.least - room, reach.most + room];
    let range = Interval { low: low * low.abs(), high: high * high };
    let found = target.leaves_later(&reach.from, range, end_s)?;
    let side = if found.value > range.high { ReachSide::Beyond } else { ReachSide::Inside };
    Some(Out { side, t_s: found.t_s, distance_m: found.value.max(0.0).sqrt() })
}

#[cfg(test)]
mod tests {
    use forwardstep_core::expression::Expression;
    use forwardstep_sim::trajectory::{Sinusoid, Spline};

    use super::*;

    fn reach(from: [f64; 2], [least, most]: [f64; 2], exact: bool) -> Reach {
        Reach { from: from.to_vec(), least, most, exact }
    }

    fn wave(offset: f64, amplitude: f64) -> Path {
        Path::Sinusoids { offset, waves: vec![Sinusoid { amplitude, rad_per_s: 1.0, phase_rad: 0.0 }] }
    }

    fn is_near([found, expected]: [f64; 2]) -> bool {
        (found - expected).abs() < 1e-9
    }

    #[test]
    fn a_place_is_out_of_reach_by_more_than_rounding_and_in_the_middle_only_where_there_is_an_edge() {
        let out = |extent, exact, distance_m: f64| reach([0.0; 2], extent, exact).out(distance_m);
        let (beyond, inside) = (Some(ReachSide::Beyond), Some(ReachSide::Inside));
        let (extent, room) = ([0.25, 2.0], 2e-9);
        for exact in [true, false] {
            assert_eq!([2.0 + 0.5 * room, 2.0 + 2.0 * room].map(|x| out(extent, exact, x)), [None, beyond]);
            assert_eq!([0.25 - 0.5 * room, 0.25 - 2.0 * room].map(|x| out(extent, exact, x)), [None, inside]);
        }
        // An arm with links alike has its edge where it folds up; of a tree without a least distance none is known.
        assert_eq!([0.5 * room, room, 2.0 * room].map(|x| out([0.0, 2.0], true, x)), [inside, inside, None]);
        assert_eq!([0.0, 1.0].map(|x| out([0.0, 2.0], false, x)), [None; 2]);
    }

    #[test]
    fn prop_bounds_of_coordinates_bound_the_distance_from_both_sides() {
        let extent = |from, paths: [Path; 2]| {
            let target = Trajectory::new(paths.to_vec()).ok()?;
            let found = super::extent(&target, &reach(from, [0.0, 9.0], true));
            Some([found.least, found.most])
        };
        let is = |found: Option<[f64; 2]>, [least, most]: [f64; 2]| {
            found.is_some_and(|found| {
                found[0] <= least && found[1] >= most && is_near([found[0], least]) && is_near([found[1], most])
            })
        };
        // At rest, from a place beside zero.
        assert!(is(extent([4.0, -2.0], [wave(1.0, 0.0), wave(2.0, 0.0)]), [5.0, 5.0]));
        // On either side of where it is counted from: 3 to 4 to the right, and 12 to 13 below; and across it.
        let beside = [153.0_f64.sqrt(), 185.0_f64.sqrt()];
        assert!(is(extent([1.0, 1.0], [wave(4.5, 0.5), wave(-11.5, 0.5)]), beside));
        assert!(is(extent([1.0, 1.0], [wave(1.5, 1.0), wave(-11.5, 0.5)]), [12.0, (2.25_f64 + 169.0).sqrt()]));
    }

    #[test]
    fn between_two_looks_a_target_gets_no_farther_than_its_speed_takes_it() {
        // 3 and 4 units in a hundred seconds: half a look at 0.05 1/s, until 400 s.
        let line = |by: f64| Spline::new(vec![0.0, 100.0], vec![0.0, by]).map(Path::Spline);
        let seen = Seen { nearest: 1.0, farthest: 6.0, out: None };
        let reach = reach([0.0; 2], [0.0, 8.0], true);
        let bound = |paths: Vec<Path>| by_speed(&Trajectory::new(paths).ok()?, &reach, &seen, 400.0);
        let speed = |path: &Path| path.bounds(&[0.0, 1.0], Some(400.0)).size();
        let paths: Vec<Path> = [line(3.0), line(4.0)].into_iter().flatten().collect();
        let room = 0.05 * speed(&paths[0]).hypot(speed(&paths[1])) + 8e-9;
        let found = bound(paths).map(|found| [found.least, found.most]);
        assert!(found.is_some_and(|[least, most]| {
            (1.0 - least - room).abs() < 1e-12 && (most - 6.0 - room).abs() < 1e-12 && room > 2e-3
        }));
        // What does not move is where it was seen, up to rounding; of what goes on after the last look nothing is known.
        let at_rest = bound(vec![wave(1.0, 0.0), Path::Formula(Expression::number(2.0))]);
        assert!(at_rest.is_some_and(|found| (found.most - 6.0 - 8e-9).abs() < 1e-12));
        assert_eq!(bound(vec![wave(1.0, 0.0), wave(1.0, 0.5)]), None);
    }

    #[test]
    fn a_formula_leaves_its_reach_later_by_more_than_rounding() {
        let out = |extent, distance: f64| {
            let target =
                Trajectory::new([distance, 0.0].map(|at| Path::Formula(Expression::number(at))).to_vec()).ok()?;
            out_later(&target, &reach([0.0; 2], extent, true), 20.0).map(|out| out.side)
        };
        let (extent, room) = ([0.25, 2.0], 2e-9);
        let (beyond, inside) = (Some(ReachSide::Beyond), Some(ReachSide::Inside));
        assert_eq!([2.0 + 0.5 * room, 2.0 + 2.0 * room].map(|x| out(extent, x)), [None, beyond]);
        assert_eq!([0.25 - 0.5 * room, 0.25 - 2.0 * room].map(|x| out(extent, x)), [None, inside]);
        // No square is below zero.
        assert_eq!(out([0.0, 2.0], 0.0), None);
    }
}

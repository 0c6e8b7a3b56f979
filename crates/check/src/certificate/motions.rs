//! Bounds of targets, offsets and leaders.

use forwardstep_core::expression::{Expression, Interval, Number};
use forwardstep_sim::Setup;
use forwardstep_sim::leader::Following;
use forwardstep_sim::reference::Desired;
use forwardstep_sim::trajectory::{Path, Trajectory};
use num_traits::{Signed, ToPrimitive};

use super::courses::Course;
use super::enclosure::{enclosed, found, late_or_whole};
use super::late::late;
use super::numbers::sum;
use super::producers::Claim;
use super::proof::{Enclosure, Proof, Range};
use super::ratio::Ratio;
use super::resolved::resolved;
use super::slopes::{self, on_piece};
use super::zeros::vanishing;
use crate::kinds::start_attitude::scalar_squared;
use crate::laws::kind_of;
use crate::reach::{leaves_s, reach};
use crate::theorems::lowest_asked;
use crate::{Answer, Id};

/// Times of the run at which a leader is looked at for a witness, and doublings of the run after it.
const LOOKS: u32 = 20_000;
const LATER: u32 = 30;
/// Room, as a part, for sums that are rounded here and exact elsewhere.
const ROOM: f64 = 1e-9;

/// How far the derivatives of targets, or of a leader, are bounded, or one that is not.
pub(super) fn bounded(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let mut order = 3;
    let mut motions: Vec<(&Trajectory, usize)> = Vec::new();
    if claim.id == Id::BoundedLeader {
        motions.push((&setup.following()?.motion()?.trajectory, 1));
    } else {
        order = 0;
        let desired = setup.reference.downcast::<Desired>().map(|desired| desired.polynomial.order());
        for index in claim.agents {
            let agent = setup.agents.get(*index)?;
            order = order.max(desired.unwrap_or_else(|| kind_of(agent).target_derivatives(agent)));
            motions.push((agent.target.as_ref()?, lowest_asked(setup, *index)));
        }
    }
    if claim.answer == Answer::Violated {
        return motions.iter().enumerate().find_map(|(motion, (trajectory, lowest))| {
            let (axis, order) = diverging(trajectory, *lowest, order)?;
            Some(Proof::Diverges { motion, axis, order })
        });
    }
    let mut range = Range::ForEver;
    for (trajectory, lowest) in motions {
        // What goes through points is bounded whatever the points are.
        for course in trajectory.paths().iter().map(Course::of).filter(|course| course.formula().is_some()) {
            let trees = slopes::derivatives(&resolved(course.formula()?), order);
            if trees.len() <= order {
                return None;
            }
            let size = |t: Interval| {
                let each = trees.iter().skip(lowest).map(|tree| late_or_whole(tree, t));
                each.reduce(Interval::hull).unwrap_or(Interval::point(0.0))
            };
            range = wider(range, found(&course.stretches(), size, |_| true)?.range);
        }
    }
    Some(Proof::Derivatives(order, range))
}

/// An axis and a derivative that goes beyond every bound: of what is a quotient of polynomials, else by how it swings.
fn diverging(trajectory: &Trajectory, lowest: usize, highest: usize) -> Option<(usize, usize)> {
    let axes = 0..trajectory.axes();
    let mut each = axes.flat_map(|axis| (lowest..=highest).map(move |order| (axis, order)));
    let grows = |(axis, order): &(usize, usize)| trajectory.is_bounded(*axis, *order) == Some(false);
    by_limit(trajectory, lowest, highest).or_else(|| each.find(grows))
}

/// The same where it has an infinite limit.
fn by_limit(trajectory: &Trajectory, lowest: usize, highest: usize) -> Option<(usize, usize)> {
    trajectory.paths().iter().enumerate().find_map(|(axis, path)| {
        let quotient = late(Course::of(path).formula()?, 1.0).ratio;
        let derivatives = std::iter::successors(quotient, Ratio::derivative).take(highest + 1);
        let diverges = |ratio: &Ratio| ratio.limit().is_some_and(|limit| limit.is_err());
        derivatives.enumerate().skip(lowest).find(|(_, ratio)| diverges(ratio)).map(|(order, _)| (axis, order))
    })
}

/// The stretch that needs more pieces, or tells less.
fn wider(a: Range, b: Range) -> Range {
    let rank = |range: Range| match range {
        Range::ForEver => (0, 0, 0),
        Range::Period { cells } => (1, 0, cells),
        Range::Tail { cells, until_s } => (2, until_s, cells),
        Range::Run { cells } => (3, 0, cells),
    };
    if rank(a) < rank(b) { b } else { a }
}

pub(super) fn sign_gain(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let following = setup.following()?;
    let (trajectory, drive) = (&following.motion()?.trajectory, following.drive());
    if claim.answer == Answer::Violated {
        return instant(trajectory, &drive, following.gain, setup.time.end_s);
    }
    let paths = trajectory.paths().iter();
    let below = |path| drive_below(path, &drive, following.gain);
    paths.map(below).collect::<Option<_>>().map(Proof::Drive)
}

/// That Σ `drive[k]` · (k-th derivative) of a path is smaller than `most` in size, as a checker would find it.
fn drive_below(path: &Path, drive: &[f64], most: f64) -> Option<Enclosure> {
    let course = Course::of(path);
    let stays = |within: Interval| within.size() < most;
    if let Some(formula) = course.formula() {
        let sum = weighted(&resolved(formula), drive)?;
        let slope = slopes::slope(&sum);
        // What is multiplied here is rounded, and exact for a checker.
        let enclose = |t: Interval| {
            let within = if t.high.is_finite() { on_piece(&sum, slope.as_ref(), t) } else { late_or_whole(&sum, t) };
            within.with_room(ROOM * within.size())
        };
        return found(&course.stretches(), enclose, stays);
    }
    // As a checker adds them: each derivative by itself.
    let weighted = |t: Interval| {
        let parts = course.enclose_derivatives(drive.len() - 1, t).into_iter().zip(drive);
        let scaled =
            parts.filter(|(_, weight)| **weight != 0.0).map(|(part, weight)| (part.low * weight, part.high * weight));
        let (low, high) = scaled.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        Interval { low, high }.with_room(1e-9 * low.abs().max(high.abs()))
    };
    found(&course.stretches(), weighted, stays)
}

/// By how much a bound may exceed what is reached, as a part: tried in this order; and of formulas with so many steps alone, since the derivatives
/// of long ones are longer by far.
const AIMS: [f64; 3] = [1.001, 1.01, 1.1];
const MOST_STEPS: usize = 40;

/// A bound of what drives the leader away, for ever, also by the rules that a checker has; infinite where nothing could be shown. They take sines and
/// cosines of one angle together, so that what swings and settles, as tanh t sin t, is bounded more closely than by [`Following::drive_bound`].
pub(crate) fn closer_drive_bound(following: &Following) -> f64 {
    let Some(leader) = following.motion() else { return f64::INFINITY };
    let drive = following.drive();
    let closer = |path: &Path, known: f64| {
        let Path::Formula(formula) = path else { return None };
        let reached = formula.combination_for_ever(&drive).reaches.size();
        let mut aims = AIMS.into_iter().map(|aim| aim * reached).filter(|most| *most < known);
        let is_short = formula.steps().len() <= MOST_STEPS;
        let [low, high] = is_short.then(|| aims.find_map(|most| drive_below(path, &drive, most)))??.within;
        Some(low.abs().max(high).to_f64()?.next_up())
    };
    let bound = |path: &Path| {
        let known = path.bounds(&drive, None).size();
        closer(path, known).unwrap_or(known)
    };
    leader.trajectory.paths().iter().map(bound).fold(0.0, f64::max)
}

/// Σ `weights[k]` · (k-th derivative) as a formula.
fn weighted(formula: &Expression, weights: &[f64]) -> Option<Expression> {
    let order = weights.iter().rposition(|weight| *weight != 0.0)?;
    let trees = slopes::derivatives(formula, order);
    let parts = trees.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
    let scaled = |tree: &Expression, weight: f64| match weight {
        1.0 => tree.clone(),
        _ => Expression::number(weight) * tree.clone(),
    };
    (trees.len() > order).then(|| sum(parts.map(|(tree, weight)| scaled(tree, *weight))))
}

/// A time at which γ is reached clearly.
fn instant(trajectory: &Trajectory, drive: &[f64], gain: f64, end_s: f64) -> Option<Proof> {
    let mut best = (gain, None);
    let on_run = (0..=LOOKS).map(|look| end_s * f64::from(look) / f64::from(LOOKS));
    let later = (1..=LATER).map(|look| (end_s * (1_u64 << look) as f64).round());
    // Closely for some time after the run, where something may pass, and ever further apart.
    let soon = (1..=LOOKS).map(|look| end_s * (1.0 + 9.0 * f64::from(look) / f64::from(LOOKS)));
    // At its points the third derivative of a curve jumps, and has no value for a checker.
    let is_point = |t_s: &f64| {
        trajectory.paths().iter().any(|path| matches!(path, Path::Spline(spline) if spline.times_s().contains(t_s)))
    };
    for t_s in on_run.chain(soon).chain(later).filter(|t_s| !is_point(t_s)) {
        for (axis, path) in trajectory.paths().iter().enumerate() {
            let value: f64 = path.jet(t_s).iter().zip(drive).map(|(value, weight)| value * weight).sum();
            // Of equal ones the first: far away exponentials have rounded to nothing, which no checker sees.
            if value.abs() > best.0 || best.1.is_none() && value.abs() >= best.0 {
                best = (value.abs(), Some((t_s, axis)));
            }
        }
    }
    best.1.map(|(t_s, axis)| Proof::Reached(Number::written(t_s), axis))
}

/// What the axes of a trajectory are at t = 0.
pub(crate) fn at_start(trajectory: &Trajectory) -> Vec<Interval> {
    trajectory.paths().iter().map(|path| Course::of(path).enclose(Interval::point(0.0))).collect()
}

/// Room, as a part, for what is rounded outwards here and exact elsewhere.
const NARROWER: f64 = 1e-6;

/// That a tip does not start half a turn from its target, by the least size of the scalar part; or that it does.
pub(super) fn start_attitude(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let agent = setup.agents.get(*claim.agents.first()?)?;
    let within = scalar_squared(agent, agent.law.downcast()?)?;
    match claim.answer {
        Answer::Holds => {
            let least = within.low.sqrt() * (1.0 - NARROWER);
            (least > 0.0).then(|| Proof::Apart(Number::written(least)))
        }
        Answer::Violated => Some(Proof::HalfTurn),
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// One entry that keeps away from zero, else the norm.
pub(super) fn nonzero_quaternion(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let target = setup.agents.get(*claim.agents.first()?)?.target.as_ref()?;
    // Of a pose, after the position.
    let first = target.axes().saturating_sub(4);
    let entries: Vec<Course<'_>> = target.paths()[first..].iter().map(Course::of).collect();
    let away = |within: Interval| within.low > 0.0 || within.high < 0.0;
    let for_ever = |(entry, course): (usize, &Course<'_>)| {
        let enclose = |t: Interval| course.enclose(t);
        let shown = found(&course.stretches(), enclose, away)?;
        Some(Proof::EntryAway(entry, shown))
    };
    let norm = || squares(&entries, away).map(Proof::Norm);
    match claim.answer {
        Answer::Holds => entries.iter().enumerate().find_map(for_ever).or_else(norm),
        Answer::Violated => vanishing(target, setup.time.end_s),
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// The first stretch on which the sum of squares keeps within something that is `good`.
fn squares(courses: &[Course<'_>], good: impl Fn(Interval) -> bool) -> Option<Enclosure> {
    // A formula may repeat, and has a limit, as a whole.
    let formulas: Option<Vec<Expression>> = courses.iter().map(|course| course.formula().cloned()).collect();
    if let Some(formulas) = formulas {
        return enclosed(&sum(formulas.into_iter().map(|entry| entry.power(2.0))), good);
    }
    // Of several curves the last to end tells when all stay.
    let ends_s = |course: &&Course<'_>| match course {
        Course::Formula(_) => f64::NEG_INFINITY,
        Course::Curve(spline, _) => spline.ends_s()[1],
    };
    let last = courses.iter().max_by(|one, other| ends_s(one).total_cmp(&ends_s(other)))?;
    found(&last.stretches(), |t| square(courses, t), good)
}

/// What the sum of squares keeps within on a stretch of time.
fn square(courses: &[Course<'_>], t_s: Interval) -> Interval {
    let each = courses.iter().map(|course| {
        let within = course.enclose(t_s);
        let least = within.low.max(-within.high).max(0.0);
        Interval { low: least * least, high: within.size() * within.size() }
    });
    let sum = each.fold(Interval::point(0.0), |sum, square| sum + square);
    sum.with_room(ROOM * sum.high)
}

/// The square of how far a target is from where the reach of a tip is counted, against what can be reached; a time at which it is out
/// of reach.
pub(super) fn within_reach(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let agent = setup.agents.get(*claim.agents.first()?)?;
    let known = reach(agent, agent.law.downcast()?)?;
    let paths = agent.target.as_ref()?.paths().iter();
    let entries: Vec<Course<'_>> = paths.zip(&known.from).map(|(path, from)| Course::of(path).from(*from)).collect();
    // Of a tree it may be that no place is known to be too near.
    let least = if known.exact || known.least > 0.0 { known.least * known.least } else { -1.0 };
    let most = known.most * known.most;
    match claim.answer {
        Answer::Holds => {
            let inside = |within: Interval| within.low > least && within.high < most;
            squares(&entries, inside).map(Proof::Distance)
        }
        Answer::Violated => {
            let t_s = leaves_s(agent.target.as_ref()?, &known, setup.time.end_s)?;
            let found = square(&entries, Interval::point(t_s));
            (found.low > most || found.high < least).then(|| Proof::OutOfReach(Number::written(t_s)))
        }
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

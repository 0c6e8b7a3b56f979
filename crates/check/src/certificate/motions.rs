//! Bounds of targets, offsets and leaders.

use forwardstep_core::expression::{Expression, Interval};
use forwardstep_sim::Setup;
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};

use super::enclosure::{Reach, enclosed, found};
use super::exact::written;
use super::numbers::sum;
use super::producers::Claim;
use super::proof::{Enclosure, Proof, Range};
use crate::laws::kind_of;
use crate::{Answer, Id};

/// Times at which a leader is looked at for a witness.
const LOOKS: u32 = 20_000;

/// The motion of one axis as a formula; nothing for a curve through points.
fn formula(path: &Path) -> Option<Expression> {
    match path {
        Path::Formula(formula) => Some(formula.clone()),
        Path::Sinusoids { offset, waves } => {
            let wave = |wave: &Sinusoid| {
                let angle =
                    Expression::number(wave.rad_per_s) * Expression::variable(0) + Expression::number(wave.phase_rad);
                Expression::number(wave.amplitude) * angle.sin_of()
            };
            Some(Expression::number(*offset) + sum(waves.iter().map(wave)))
        }
        Path::Spline(_) => None,
    }
}

/// How far the derivatives of targets, or of a leader, are bounded: for ever, else in as many pieces of the run as it takes.
pub(super) fn bounded(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer == Answer::Violated {
        return None;
    }
    let reach = claim.reach();
    let mut order = 3;
    let mut motions: Vec<(&Trajectory, usize)> = Vec::new();
    if claim.id == Id::BoundedLeader {
        motions.push((&setup.following()?.motion()?.trajectory, 1));
    } else {
        order = 0;
        for index in claim.agents {
            let agent = setup.agents.get(*index)?;
            order = order.max(kind_of(agent).target_derivatives(agent).min(4));
            motions.push((agent.target.as_ref()?, usize::from(!setup.tracks(*index))));
        }
    }
    let mut range = Range::ForEver;
    for (trajectory, lowest) in motions {
        for formula in trajectory.paths().iter().filter_map(formula) {
            let size = |t: Interval| {
                let jet = formula.enclose_jet(t);
                jet.into_iter().take(order + 1).skip(lowest).reduce(Interval::hull).unwrap_or(Interval::point(0.0))
            };
            range = wider(range, found(&formula, size, setup.time.end_s, reach, |_| true)?.range);
        }
    }
    Some(Proof::Derivatives(order, range))
}

/// The stretch that needs more pieces.
fn wider(a: Range, b: Range) -> Range {
    match (a, b) {
        (Range::ForEver, range) | (range, Range::ForEver) => range,
        (Range::Period { cells: a }, Range::Period { cells: b }) => Range::Period { cells: a.max(b) },
        (Range::Run { cells: a }, Range::Run { cells: b } | Range::Period { cells: b })
        | (Range::Period { cells: b }, Range::Run { cells: a }) => Range::Run { cells: a.max(b) },
    }
}

pub(super) fn sign_gain(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let following = setup.following()?;
    let (trajectory, drive) = (&following.motion()?.trajectory, following.drive());
    if claim.answer == Answer::Violated {
        return instant(trajectory, &drive, following.gain, setup.time.end_s);
    }
    let enclosure = |path: &Path| -> Option<Enclosure> {
        let formula = formula(path)?;
        // As a checker adds them: each derivative by itself.
        let weighted = |t: Interval| {
            let parts = formula.enclose_jet(t).into_iter().zip(drive).filter(|(_, weight)| *weight != 0.0);
            let scaled = parts.map(|(part, weight)| (part.low * weight, part.high * weight));
            let (low, high) = scaled.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
            Interval { low, high }.with_room(1e-9 * low.abs().max(high.abs()))
        };
        found(&formula, weighted, setup.time.end_s, claim.reach(), |within| within.size() < following.gain)
    };
    trajectory.paths().iter().map(enclosure).collect::<Option<_>>().map(Proof::Drive)
}

/// A time at which γ is reached clearly.
fn instant(trajectory: &Trajectory, drive: &[f64; 5], gain: f64, end_s: f64) -> Option<Proof> {
    let mut best = (gain, None);
    for look in 0..=LOOKS {
        let t_s = end_s * f64::from(look) / f64::from(LOOKS);
        for (axis, path) in trajectory.paths().iter().enumerate() {
            let value: f64 = path.jet(t_s).iter().zip(drive).map(|(value, weight)| value * weight).sum();
            if value.abs() >= best.0 {
                best = (value.abs(), Some((t_s, axis)));
            }
        }
    }
    best.1.map(|(t_s, axis)| Proof::Reached(written(t_s), axis))
}

/// One entry that keeps away from zero for ever, else the norm on the run.
pub(super) fn nonzero_quaternion(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let target = setup.agents.get(*claim.agents.first()?)?.target.as_ref()?;
    let entries: Vec<Expression> = target.paths().iter().map(formula).collect::<Option<_>>()?;
    let away = |within: Interval| within.low > 0.0 || within.high < 0.0;
    let for_ever = |(entry, formula): (usize, &Expression)| {
        enclosed(formula, setup.time.end_s, Reach::ForEver, away).map(|found| Proof::EntryAway(entry, found))
    };
    match claim.answer {
        Answer::Holds => entries.iter().enumerate().find_map(for_ever),
        Answer::HoldsOnHorizon => {
            let square = sum(entries.iter().map(|entry| entry.clone().power(2.0)));
            enclosed(&square, setup.time.end_s, Reach::Run, away).map(Proof::Norm)
        }
        Answer::Violated | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

//! What an axis follows, as a checker reads it: a formula, or a curve through points.

use forwardstep_core::expression::{Expression, Interval};
use forwardstep_sim::trajectory::{Path, Sinusoid, Spline};

use super::enclosure::{Stretches, late_or_whole};
use super::numbers::sum;
use super::slopes;

/// Room, as a part, for coefficients of curves, which are rounded here and exact elsewhere.
const ROOM: f64 = 1e-9;

/// What an axis follows.
pub(super) enum Course<'a> {
    Formula(Expression),
    /// A curve, and what is added to it.
    Curve(&'a Spline, f64),
}

impl<'a> Course<'a> {
    pub(super) fn of(path: &'a Path) -> Self {
        match path {
            Path::Formula(formula) => Course::Formula(formula.clone()),
            Path::Sinusoids { offset, waves } => {
                let wave = |wave: &Sinusoid| {
                    let angle = Expression::number(wave.rad_per_s) * Expression::variable(0)
                        + Expression::number(wave.phase_rad);
                    Expression::number(wave.amplitude) * angle.sin_of()
                };
                Course::Formula(Expression::number(*offset) + sum(waves.iter().map(wave)))
            }
            Path::Spline(spline) => Course::Curve(spline, 0.0),
        }
    }

    /// The same as seen from `from`.
    pub(super) fn from(self, from: f64) -> Self {
        match self {
            Course::Formula(formula) if from == 0.0 => Course::Formula(formula),
            Course::Formula(formula) => Course::Formula(formula - Expression::number(from)),
            Course::Curve(spline, added) => Course::Curve(spline, added - from),
        }
    }

    /// The formula, where it is one.
    pub(super) fn formula(&self) -> Option<&Expression> {
        match self {
            Course::Formula(formula) => Some(formula),
            Course::Curve(..) => None,
        }
    }

    /// What it keeps within on a stretch of time, which may have no end.
    pub(super) fn enclose(&self, t_s: Interval) -> Interval {
        match self {
            Course::Formula(formula) => late_or_whole(formula, t_s),
            Course::Curve(..) => self.enclose_derivatives(0, t_s)[0],
        }
    }

    /// The same of value and derivatives up to `order`; of a curve nothing is known beyond the fourth.
    pub(super) fn enclose_derivatives(&self, order: usize, t_s: Interval) -> Vec<Interval> {
        let mut derivatives = vec![Interval::WHOLE; order + 1];
        match self {
            Course::Formula(formula) => {
                let trees = slopes::derivatives(formula, order);
                derivatives.iter_mut().zip(&trees).for_each(|(out, tree)| *out = late_or_whole(tree, t_s));
            }
            Course::Curve(spline, added) => {
                let mut jet = spline.enclose_jet(t_s).map(|within| within.with_room(ROOM * within.size()));
                jet[0] = jet[0] + Interval::point(*added);
                derivatives.iter_mut().zip(jet).for_each(|(out, within)| *out = within);
            }
        }
        derivatives
    }

    /// The stretches to try: a curve stays where it is after its last point.
    pub(super) fn stretches(&self) -> Stretches {
        match self {
            Course::Formula(formula) => Stretches::of(formula),
            Course::Curve(spline, _) => Stretches::until(spline.ends_s()[1]),
        }
    }
}

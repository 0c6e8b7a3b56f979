//! Sums of scales with coefficients.

use super::super::interval::Interval;
use super::coefficient::{Coefficient, over, plus, times};
use super::scale::Scale;

/// Terms that are kept.
const TERMS: usize = 6;

/// One scale with its coefficient.
pub(super) type Term = (Scale, Coefficient);

/// What an expression is from some time on: Σ coefficient · scale, with scales that fall, and an infinite bound at most in the
/// first coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Series {
    terms: [Term; TERMS],
    count: usize,
    /// From here on, s; not-a-number where nothing is known.
    from: f64,
}

impl Series {
    pub(super) fn unknown() -> Self {
        Series { from: f64::NAN, ..Series::zero(0.0) }
    }

    pub(super) fn zero(from: f64) -> Self {
        let nothing = (Scale::ONE, Coefficient::constant(Interval::point(0.0)));
        Series { terms: [nothing; TERMS], count: 0, from }
    }

    pub(super) fn term(from: f64, scale: Scale, coefficient: Coefficient) -> Self {
        let mut series = Series::zero(from);
        series.add(scale, coefficient);
        series
    }

    pub(in super::super) fn is_known(&self) -> bool {
        !self.from.is_nan()
    }

    pub(super) fn terms(&self) -> &[Term] {
        &self.terms[..self.count]
    }

    /// The largest term; `None` for zero.
    pub(super) fn leading(&self) -> Option<Term> {
        self.terms().first().copied()
    }

    /// Adds a term.
    pub(super) fn add(&mut self, scale: Scale, coefficient: Coefficient) {
        if !self.is_known() || coefficient.within == Interval::point(0.0) {
            return;
        }
        if !coefficient.exists() {
            *self = Series::unknown();
            return;
        }
        let place = self.terms().iter().position(|(other, _)| *other <= scale).unwrap_or(self.count);
        match self.terms().get(place) {
            Some((other, own)) if *other == scale => {
                let sum = own.plus(coefficient);
                self.remove(place);
                if !sum.exists() {
                    *self = Series::unknown();
                } else if sum.within != Interval::point(0.0) {
                    self.insert(place, (scale, sum));
                }
            }
            _ => {
                if self.count == TERMS {
                    self.merge_last();
                    // The place may have been that of a term which is gone.
                    return self.add(scale, coefficient);
                }
                self.insert(place, (scale, coefficient));
            }
        }
        if self.terms().iter().skip(1).any(|(_, coefficient)| !coefficient.within.is_finite()) {
            self.gather();
        }
    }

    fn insert(&mut self, place: usize, term: Term) {
        self.terms[place..=self.count].rotate_right(1);
        self.terms[place] = term;
        self.count += 1;
    }

    fn remove(&mut self, place: usize) {
        self.terms[place..self.count].rotate_left(1);
        self.count -= 1;
    }

    /// Makes one term of the last two: a smaller scale is a larger one times something that fades.
    fn merge_last(&mut self) {
        let [.., (upper, kept), (lower, lost)] = *self.terms() else { return };
        self.count -= 1;
        let ratio = lower.over(upper).map_or(Interval::UNDEFINED, |ratio| ratio.range(self.from));
        let within = plus(kept.within, times(lost.within, ratio));
        self.terms[self.count - 1] = (upper, Coefficient { within, still: false, ..kept });
    }

    /// Makes one term of all, of which the bounds alone are known.
    fn gather(&mut self) {
        match self.as_one() {
            Some((scale, one)) => {
                let coefficient = Coefficient::bounded(one.within);
                (self.terms[0], self.count) = ((scale, coefficient), 1);
            }
            None => *self = Series::unknown(),
        }
    }

    /// All terms as one, with the scale of the largest; `None` for zero, or where nothing is known.
    pub(super) fn as_one(&self) -> Option<Term> {
        let (scale, first) = self.leading()?;
        let mut within = first.within;
        for (other, coefficient) in self.terms().iter().skip(1) {
            within = plus(within, times(coefficient.within, other.over(scale)?.range(self.from)));
        }
        let still = first.still && self.count == 1;
        let one = Coefficient { within, still, ..first };
        (self.is_known() && one.exists()).then_some((scale, one))
    }

    /// What it keeps within from `from` on.
    pub(in super::super) fn range(&self) -> Interval {
        if !self.is_known() {
            return Interval::WHOLE;
        }
        let apart = |term: &Term| times(term.1.within, term.0.range(self.from));
        let sum = self.terms().iter().map(apart).fold(Interval::point(0.0), plus).or_whole();
        match self.as_one() {
            Some(one) => sum.and(apart(&one).or_whole()),
            None => sum,
        }
    }

    pub(super) fn from(&self) -> f64 {
        self.from
    }

    /// Every coefficient changed, and every scale multiplied.
    pub(super) fn scaled(&self, scale: Scale, by: impl Fn(Coefficient) -> Coefficient) -> Self {
        let mut scaled = Series { count: 0, ..*self };
        for (own, coefficient) in self.terms() {
            match own.times(scale) {
                Some(scale) => scaled.add(scale, by(*coefficient)),
                None => return Series::unknown(),
            }
        }
        scaled
    }

    pub(super) fn neg(&self) -> Self {
        self.scaled(Scale::ONE, Coefficient::neg)
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        if !other.is_known() {
            return Series::unknown();
        }
        other.terms().iter().for_each(|(scale, coefficient)| sum.add(*scale, *coefficient));
        sum
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        if !self.is_known() || !other.is_known() {
            return Series::unknown();
        }
        let mut product = Series::zero(self.from);
        for (scale, coefficient) in other.terms() {
            product = product.plus(&self.scaled(*scale, |own| own.times(*coefficient)));
        }
        product
    }

    /// All terms but the first, in units of its scale: they fade.
    pub(super) fn rest(&self, scale: Scale) -> Option<Series> {
        let mut rest = Series::zero(self.from);
        for (own, coefficient) in self.terms().iter().skip(1) {
            rest.add(own.over(scale)?, *coefficient);
        }
        rest.is_known().then_some(rest)
    }

    /// 1 / (L (c + δ)) = (1/c − δ / (c (c + δ))) / L; unknown where c + δ may be zero.
    pub(super) fn inverse(&self) -> Self {
        let inverse = || {
            let ((scale, first), (_, one)) = (self.leading()?, self.as_one()?);
            if one.within.holds(0.0) || first.within.holds(0.0) {
                return None;
            }
            let rest = self.rest(scale)?;
            let slope = over(Interval::point(-1.0), times(first.within, one.within));
            let sum = rest.composed(first.inverse(), slope);
            Some(sum.scaled(Scale::ONE.over(scale)?, |same| same))
        };
        inverse().unwrap_or_else(Series::unknown)
    }

    /// value + slope · this, for a slope between bounds: the mean value theorem.
    pub(super) fn composed(&self, value: Coefficient, slope: Interval) -> Self {
        let slope = Coefficient::bounded(slope);
        let mut sum = self.scaled(Scale::ONE, |own| own.times(slope));
        sum.add(Scale::ONE, value);
        sum
    }
}

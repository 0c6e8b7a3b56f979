//! What a factor of a scale does for ever: what it keeps within, and what it comes back to.

use super::super::interval::{Interval, Intervals};
use super::super::{Algebra, Binary, Unary};

/// A bounded function of t ≥ T; its upper or lower bound may be infinite, where only the other is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coefficient {
    /// It never leaves this.
    pub(super) within: Interval,
    /// Its limit superior is this at least.
    pub(super) above: f64,
    /// Its limit inferior is this at most.
    pub(super) below: f64,
    /// Whether it is a constant.
    pub(super) still: bool,
}

pub(super) fn combine(function: Binary, a: Interval, b: Interval) -> Interval {
    Intervals(&[]).binary(function, a, b)
}

pub(super) fn plus(a: Interval, b: Interval) -> Interval {
    combine(Binary::Add, a, b)
}

pub(super) fn times(a: Interval, b: Interval) -> Interval {
    combine(Binary::Multiply, a, b)
}

pub(super) fn over(a: Interval, b: Interval) -> Interval {
    combine(Binary::Divide, a, b)
}

impl Coefficient {
    /// One of which nothing but its bounds is known.
    pub(super) fn bounded(within: Interval) -> Self {
        Coefficient { within, above: within.low, below: within.high, still: false }
    }

    /// A constant.
    pub(super) fn constant(within: Interval) -> Self {
        Coefficient { still: true, ..Coefficient::bounded(within) }
    }

    /// One that comes arbitrarily close to both of its bounds again and again.
    pub(super) fn swinging(within: Interval) -> Self {
        Coefficient { within, above: within.high, below: within.low, still: false }
    }

    /// Whether it has a value.
    pub(super) fn exists(&self) -> bool {
        self.within.low <= self.within.high
    }

    /// The claims that are better than those that follow from the bounds.
    fn claiming(within: Interval, above: f64, below: f64, still: bool) -> Self {
        // Not-a-number loses.
        Coefficient { within, above: within.low.max(above), below: within.high.min(below), still }
    }

    pub(super) fn neg(self) -> Self {
        let Interval { low, high } = self.within;
        Coefficient { within: Interval { low: -high, high: -low }, above: -self.below, below: -self.above, ..self }
    }

    /// lim sup (a + b) ≥ lim sup a + lim inf b.
    pub(super) fn plus(self, other: Self) -> Self {
        let point = Interval::point;
        let above = |a: Self, b: Self| plus(point(a.above), point(b.within.low)).low;
        let below = |a: Self, b: Self| plus(point(a.below), point(b.within.high)).high;
        Coefficient::claiming(
            plus(self.within, other.within),
            above(self, other).max(above(other, self)),
            below(self, other).min(below(other, self)),
            self.still && other.still,
        )
    }

    pub(super) fn times(self, other: Self) -> Self {
        let (a, b) = (self.claims_times(other.within), other.claims_times(self.within));
        let still = self.still && other.still;
        Coefficient::claiming(times(self.within, other.within), a[1].max(b[1]), a[0].min(b[0]), still)
    }

    /// Limits inferior and superior of the product with something within `factor`: not-a-number where nothing is known.
    fn claims_times(self, factor: Interval) -> [f64; 2] {
        if factor.high <= 0.0 {
            return self.neg().claims_times(Interval { low: -factor.high, high: -factor.low });
        }
        if factor.low < 0.0 || !factor.is_finite() {
            return [f64::NAN; 2];
        }
        let end = |claim: f64, factor: f64| times(Interval::point(claim), Interval::point(factor));
        let below = end(self.below, if self.below <= 0.0 { factor.low } else { factor.high }).high;
        [below, end(self.above, if self.above >= 0.0 { factor.low } else { factor.high }).low]
    }

    /// Of one that keeps away from zero.
    pub(super) fn inverse(self) -> Self {
        if self.within.high < 0.0 {
            return self.neg().inverse().neg();
        }
        let one = Interval::point(1.0);
        let of = |claim: f64| over(one, Interval::point(claim));
        Coefficient::claiming(over(one, self.within), of(self.below).low, of(self.above).high, self.still)
    }

    /// Of a function that rises, and is continuous.
    pub(super) fn rising(self, apply: impl Fn(Interval) -> Interval) -> Self {
        let end = |claim: f64| {
            let claim = claim.clamp(self.within.low, self.within.high);
            if claim.is_finite() { apply(Interval::point(claim)) } else { Interval::UNDEFINED }
        };
        Coefficient::claiming(apply(self.within), end(self.above).low, end(self.below).high, self.still)
    }

    /// Its function; claims are kept where the function rises.
    pub(super) fn unary(self, function: Unary) -> Self {
        let apply = |a: Interval| Intervals(&[]).unary(function, a);
        match function {
            Unary::Negate => self.neg(),
            Unary::Exp | Unary::Log | Unary::Sqrt | Unary::Tanh | Unary::Atan => self.rising(apply),
            Unary::Abs if self.within.low >= 0.0 => self,
            Unary::Abs if self.within.high <= 0.0 => self.neg(),
            Unary::Abs => Coefficient {
                above: self.above.max(-self.below).max(0.0),
                still: self.still,
                ..Coefficient::bounded(apply(self.within))
            },
            Unary::Sin | Unary::Cos => Coefficient { still: self.still, ..Coefficient::bounded(apply(self.within)) },
        }
    }
}

//! The scales tᵖ (ln t)ᵠ by which terms are compared as t grows.

use num_rational::{BigRational, Ratio};
use num_traits::{CheckedAdd, CheckedMul, CheckedSub, Signed, Zero};

use super::super::interval::{Interval, Intervals};
use super::super::{Algebra, Binary, Number, Unary};

/// p or q: exact, since tᵖ with a p that is zero but for rounding would be taken for something that grows.
pub(super) type Exponent = Ratio<i32>;

/// Numerators and denominators of exponents that are accepted.
const MOST: i32 = 10_000;

/// tᵖ (ln t)ᵠ. A larger one grows faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Scale {
    t: Exponent,
    log: Exponent,
}

/// A number as an exponent, if it is known to be a rational one that is small enough.
pub(super) fn exponent(number: &Number) -> Option<Exponent> {
    let exact = number.exact()?;
    let small = |part: &_| i32::try_from(part).ok().filter(|part: &i32| part.abs() <= MOST);
    Some(Ratio::new(small(exact.numer())?, small(exact.denom())?))
}

/// An exponent as a number.
pub(super) fn number(exponent: Exponent) -> Number {
    Number::rational(BigRational::new((*exponent.numer()).into(), (*exponent.denom()).into()))
}

impl Scale {
    /// 1.
    pub(super) const ONE: Scale = Scale { t: Ratio::new_raw(0, 1), log: Ratio::new_raw(0, 1) };
    /// t.
    pub(super) const T: Scale = Scale { t: Ratio::new_raw(1, 1), log: Ratio::new_raw(0, 1) };
    /// ln t.
    pub(super) const LOG: Scale = Scale { t: Ratio::new_raw(0, 1), log: Ratio::new_raw(1, 1) };

    /// tᵖ.
    pub(super) fn power_of_t(p: i32) -> Scale {
        Scale { t: p.into(), log: Ratio::zero() }
    }

    /// p where it is a power of t alone.
    pub(super) fn pure(self) -> Option<Exponent> {
        self.log.is_zero().then_some(self.t)
    }

    /// p.
    pub(super) fn exponent_of_t(self) -> Exponent {
        self.t
    }

    pub(super) fn times(self, other: Scale) -> Option<Scale> {
        Some(Scale { t: self.t.checked_add(&other.t)?, log: self.log.checked_add(&other.log)? })
    }

    pub(super) fn over(self, other: Scale) -> Option<Scale> {
        Some(Scale { t: self.t.checked_sub(&other.t)?, log: self.log.checked_sub(&other.log)? })
    }

    pub(super) fn raised(self, exponent: Exponent) -> Option<Scale> {
        Some(Scale { t: self.t.checked_mul(&exponent)?, log: self.log.checked_mul(&exponent)? })
    }

    /// What it keeps within from `from` on, which is at least 16.
    pub(super) fn range(self, from: f64) -> Interval {
        if self == Scale::ONE {
            return Interval::point(1.0);
        }
        if self < Scale::ONE {
            return Interval::new(0.0, self.highest(from));
        }
        // The inverse comes down to zero.
        let inverse = Scale::ONE.over(self).map_or(f64::INFINITY, |inverse| inverse.highest(from));
        Interval::new((1.0 / inverse).next_down().max(0.0), f64::INFINITY)
    }

    /// An upper bound from `from` on, of a scale that fades: it falls from e^(−q/p) on.
    fn highest(self, from: f64) -> f64 {
        let mut intervals = Intervals(&[]);
        let (p, q) = (number(self.t), number(self.log));
        let mut at = |t: Interval, log: Interval| {
            let (t, log) = (intervals.power(t, &p), intervals.power(log, &q));
            intervals.binary(Binary::Multiply, t, log).high
        };
        let start = Interval::point(from);
        let log_start = Intervals(&[]).unary(Unary::Log, start);
        if !self.log.is_positive() || !self.t.is_negative() {
            return at(start, log_start);
        }
        let (below, above) = (number(-self.t).within(), number(self.log).within());
        let turn = Intervals(&[]).binary(Binary::Divide, above, below);
        if turn.high <= log_start.low { at(start, log_start) } else { at(Intervals(&[]).unary(Unary::Exp, turn), turn) }
    }
}

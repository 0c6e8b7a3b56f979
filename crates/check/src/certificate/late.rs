//! What a formula and its slope keep within from some time on, in one pass and by the rules that a checker has.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Step, Unary};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive};

use super::ratio::Ratio;

/// A part of a formula from a time on.
#[derive(Clone, Debug)]
pub(super) struct Late {
    /// What it keeps within.
    pub(super) within: Interval,
    /// What its slope keeps within; where it has kinks, the slopes on both sides of them.
    pub(super) slope: Interval,
    /// Itself, where it is a quotient of polynomials.
    pub(super) ratio: Option<Ratio>,
}

/// What `formula` does from `from_s` on.
pub(super) fn late(formula: &Expression, from_s: f64) -> Late {
    formula.fold(&mut Lates { from_s })
}

/// The algebra of what formulas do from a time on.
struct Lates {
    from_s: f64,
}

impl Lates {
    /// With what the quotient of polynomials tells, where the part is one.
    fn part(&self, within: Interval, slope: Interval, ratio: Option<Ratio>) -> Late {
        let known = |ratio: Option<Ratio>| ratio.filter(|_| self.from_s > 0.0)?.from(self.from_s);
        let within = both(within, known(ratio.clone()));
        let slope = both(slope, known(ratio.as_ref().and_then(Ratio::derivative)));
        Late { within, slope, ratio }
    }
}

/// What lies in both, of which the first may be undefined.
fn both(a: Interval, b: Option<Interval>) -> Interval {
    b.map_or(a, |b| Interval { low: b.low.max(a.low), high: b.high.min(a.high) })
}

/// What a function makes of an interval.
pub(super) fn of(step: Step, a: Interval) -> Interval {
    Expression::new(vec![Step::Variable(0), step]).map_or(Interval::WHOLE, |function| function.enclose(a))
}

fn smaller(a: Interval, b: Interval) -> Interval {
    Interval { low: a.low.min(b.low), high: a.high.min(b.high) }
}

impl Algebra for Lates {
    type Value = Late;

    fn number(&mut self, number: &Number) -> Late {
        self.part(number.within(), Interval::point(0.0), number.exact().map(Ratio::number))
    }

    fn variable(&mut self, _: usize) -> Late {
        let within = Interval { low: self.from_s, high: f64::INFINITY };
        Late { within, slope: Interval::point(1.0), ratio: Some(Ratio::time()) }
    }

    fn unary(&mut self, function: Unary, a: Late) -> Late {
        let (v, one) = (a.within, Interval::point(1.0));
        let within = of(Step::Unary(function), v);
        let outer = match function {
            Unary::Negate => -one,
            Unary::Sin => of(Step::Unary(Unary::Cos), v),
            Unary::Cos => -of(Step::Unary(Unary::Sin), v),
            Unary::Exp => within,
            Unary::Log => one / v,
            Unary::Sqrt => Interval::point(0.5) / within,
            Unary::Abs => Interval { low: -1.0, high: 1.0 },
            Unary::Tanh => one - within * within,
            Unary::Atan => one / (one + v * v),
        };
        let ratio = if function == Unary::Negate { a.ratio.as_ref().map(Ratio::negated) } else { None };
        self.part(within, a.slope * outer, ratio)
    }

    fn binary(&mut self, function: Binary, a: Late, b: Late) -> Late {
        let (x, y) = (a.within, b.within);
        let ratios = a.ratio.as_ref().zip(b.ratio.as_ref());
        match function {
            Binary::Add => self.part(x + y, a.slope + b.slope, ratios.and_then(|(a, b)| a.plus(b))),
            Binary::Subtract => self.part(x - y, a.slope - b.slope, ratios.and_then(|(a, b)| a.plus(&b.negated()))),
            Binary::Multiply => self.part(x * y, a.slope * y + x * b.slope, ratios.and_then(|(a, b)| a.times(b))),
            Binary::Divide => {
                let slope = (a.slope * y - x * b.slope) / (y * y);
                self.part(x / y, slope, ratios.and_then(|(a, b)| a.times(&b.inverse()?)))
            }
            Binary::Min => self.part(smaller(x, y), a.slope.hull(b.slope), None),
            Binary::Max => self.part(-smaller(-x, -y), a.slope.hull(b.slope), None),
        }
    }

    fn power(&mut self, a: Late, exponent: &Number) -> Late {
        let within = of(Step::Power(exponent.clone()), a.within);
        let less = exponent.exact().map(|exponent| Step::Power(Number::rational(exponent - BigRational::one())));
        let outer = less.map_or(Interval::WHOLE, |less| exponent.within() * of(less, a.within));
        self.part(within, a.slope * outer, a.ratio.as_ref().and_then(|ratio| ratio.power(whole(exponent)?)))
    }
}

/// An exponent that is a whole number.
pub(super) fn whole(exponent: &Number) -> Option<i64> {
    exponent.exact().filter(BigRational::is_integer)?.to_i64()
}

//! What fades at least like 1/t, so that its square has a finite integral.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Unary};

use super::enclosure::late_or_whole;
use super::limit::{Limit, limit};
use super::resolved::resolved;

/// Whether f(t) is bounded for t ≥ 0, and t f(t) in the end; `false` where that is not shown.
pub(crate) fn fades(formula: &Expression) -> bool {
    is_bounded(formula) && formula.fold(&mut Fading { left: MOST_LIMITS }).1
}

/// So many limits are looked for: each takes as long as its part is.
const MOST_LIMITS: usize = 64;

/// Every part beside whether it fades.
struct Fading {
    left: usize,
}

impl Fading {
    /// By the limit of t f(t), where nothing simpler tells.
    fn part(&mut self, part: Expression, by_parts: bool) -> (Expression, bool) {
        if by_parts || self.left == 0 {
            return (part, by_parts);
        }
        self.left -= 1;
        let larger = resolved(&(Expression::variable(0) * part.clone()));
        (part, matches!(limit(&larger), Limit::Near(_)))
    }
}

fn is_bounded(part: &Expression) -> bool {
    late_or_whole(part, Interval { low: 0.0, high: f64::INFINITY }).is_finite()
}

impl Algebra for Fading {
    type Value = (Expression, bool);

    fn number(&mut self, number: &Number) -> (Expression, bool) {
        (Expression::number(number.clone()), number.value() == 0.0)
    }

    fn variable(&mut self, index: usize) -> (Expression, bool) {
        (Expression::variable(index), false)
    }

    fn unary(&mut self, function: Unary, (a, fades): (Expression, bool)) -> (Expression, bool) {
        self.part(a.under(function), function == Unary::Negate && fades)
    }

    fn binary(&mut self, function: Binary, a: (Expression, bool), b: (Expression, bool)) -> (Expression, bool) {
        let by_parts = match function {
            Binary::Add | Binary::Subtract => a.1 && b.1,
            Binary::Multiply => a.1 && is_bounded(&b.0) || b.1 && is_bounded(&a.0),
            Binary::Divide => is_bounded(&a.0) && self.part(b.0.clone().power(-1.0), false).1,
            Binary::Min | Binary::Max => false,
        };
        self.part(a.0.with(b.0, function), by_parts)
    }

    fn power(&mut self, (a, _): (Expression, bool), exponent: &Number) -> (Expression, bool) {
        self.part(a.power(exponent.clone()), false)
    }
}

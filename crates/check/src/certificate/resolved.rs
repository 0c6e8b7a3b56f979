//! Formulas without the kinks that are none: of |a|, min and max the branch that is taken at all times, by the rules that a checker has.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Unary};

use super::enclosure::late_or_whole;

/// `formula` for t ≥ 0, with the branch of |a|, min and max that the sign of a, or of a difference, takes for ever in their place.
pub(super) fn resolved(formula: &Expression) -> Expression {
    formula.fold(&mut Resolved)
}

struct Resolved;

/// Whether a part is nowhere negative, or nowhere positive.
fn sign(part: &Expression) -> Option<bool> {
    let within = late_or_whole(part, Interval { low: 0.0, high: f64::INFINITY });
    (within.low >= 0.0).then_some(true).or((within.high <= 0.0).then_some(false))
}

impl Algebra for Resolved {
    type Value = Expression;

    fn number(&mut self, number: &Number) -> Expression {
        Expression::number(number.clone())
    }

    fn variable(&mut self, index: usize) -> Expression {
        Expression::variable(index)
    }

    fn unary(&mut self, function: Unary, a: Expression) -> Expression {
        match (function == Unary::Abs).then(|| sign(&a)).flatten() {
            Some(true) => a,
            Some(false) => -a,
            None => a.under(function),
        }
    }

    fn binary(&mut self, function: Binary, a: Expression, b: Expression) -> Expression {
        let is_first_larger = match function {
            Binary::Min | Binary::Max => sign(&(a.clone() - b.clone())),
            Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => None,
        };
        match is_first_larger {
            Some(larger) if larger == (function == Binary::Max) => a,
            Some(_) => b,
            None => a.with(b, function),
        }
    }

    fn power(&mut self, a: Expression, exponent: &Number) -> Expression {
        a.power(exponent.clone())
    }
}

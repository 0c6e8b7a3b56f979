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
        match function {
            Unary::Negate => -a,
            Unary::Sin => a.sin_of(),
            Unary::Cos => a.cos_of(),
            Unary::Exp => a.exp_of(),
            Unary::Log => a.log_of(),
            Unary::Sqrt => a.sqrt_of(),
            Unary::Tanh => a.tanh_of(),
            Unary::Atan => a.atan_of(),
            Unary::Abs => match sign(&a) {
                Some(true) => a,
                Some(false) => -a,
                None => a.abs_of(),
            },
        }
    }

    fn binary(&mut self, function: Binary, a: Expression, b: Expression) -> Expression {
        match function {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide => a / b,
            Binary::Min | Binary::Max => match sign(&(a.clone() - b.clone())) {
                Some(above) if above == (function == Binary::Max) => a,
                Some(_) => b,
                None if function == Binary::Min => a.smaller(b),
                None => a.larger(b),
            },
        }
    }

    fn power(&mut self, a: Expression, exponent: &Number) -> Expression {
        a.power(exponent.clone())
    }
}

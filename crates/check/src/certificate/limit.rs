//! Where a formula goes as t → ∞, by the rules that a checker has: what refutes a bound for ever.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Step, Unary};

use super::late::{of, whole};
use super::ratio::Ratio;

/// Where a formula goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Limit {
    /// All its limit points lie in this bounded interval.
    Near(Interval),
    /// Above every bound.
    Up,
    /// Below every bound.
    Down,
    /// Not known.
    Unknown,
}

/// Where `formula` goes.
pub(super) fn limit(formula: &Expression) -> Limit {
    formula.fold(&mut Limits).limit
}

/// A part of a formula.
#[derive(Clone, Debug)]
struct Part {
    limit: Limit,
    ratio: Option<Ratio>,
    /// Whether it falls as the exponential of a polynomial does, faster than any power grows.
    fast: bool,
}

impl Part {
    /// With what the quotient of polynomials tells, where the part is one.
    fn new(limit: Limit, ratio: Option<Ratio>) -> Part {
        let known = match ratio.as_ref().and_then(Ratio::limit) {
            Some(Ok(within)) => Limit::near(within),
            Some(Err(true)) => Limit::Up,
            Some(Err(false)) => Limit::Down,
            None => limit,
        };
        Part { limit: known, ratio, fast: false }
    }

    /// What falls so fast times what is a quotient of polynomials, or has a limit, falls as fast.
    fn damped(&self, other: &Part) -> bool {
        self.fast && (other.fast || other.ratio.is_some() || matches!(other.limit, Limit::Near(_)))
    }
}

impl Limit {
    fn near(within: Interval) -> Limit {
        if within.is_finite() { Limit::Near(within) } else { Limit::Unknown }
    }

    fn negated(self) -> Limit {
        match self {
            Limit::Near(within) => Limit::Near(-within),
            Limit::Up => Limit::Down,
            Limit::Down => Limit::Up,
            Limit::Unknown => Limit::Unknown,
        }
    }

    /// Nothing is known where one goes up and the other down.
    fn plus(self, other: Limit) -> Limit {
        match (self, other) {
            (Limit::Near(a), Limit::Near(b)) => Limit::near(a + b),
            (Limit::Unknown, _) | (_, Limit::Unknown) | (Limit::Up, Limit::Down) | (Limit::Down, Limit::Up) => {
                Limit::Unknown
            }
            (Limit::Near(_), infinite) | (infinite, _) => infinite,
        }
    }

    /// Nothing is known where one is unbounded and the other may come to zero.
    fn times(self, other: Limit) -> Limit {
        match (self, other) {
            (Limit::Near(a), Limit::Near(b)) => Limit::near(a * b),
            (Limit::Unknown, _) | (_, Limit::Unknown) => Limit::Unknown,
            (a, b) => match (a.sign(), b.sign()) {
                (Some(one), Some(other)) if one == other => Limit::Up,
                (Some(_), Some(_)) => Limit::Down,
                (None, _) | (_, None) => Limit::Unknown,
            },
        }
    }

    /// Whether it is positive, where it is clearly not zero.
    fn sign(self) -> Option<bool> {
        match self {
            Limit::Near(within) => (within.low > 0.0).then_some(true).or((within.high < 0.0).then_some(false)),
            Limit::Up => Some(true),
            Limit::Down => Some(false),
            Limit::Unknown => None,
        }
    }

    fn inverse(self) -> Limit {
        match self {
            Limit::Near(within) => Limit::near(Interval::point(1.0) / within),
            Limit::Up | Limit::Down => Limit::Near(Interval::point(0.0)),
            Limit::Unknown => Limit::Unknown,
        }
    }

    fn smaller(self, other: Limit) -> Limit {
        match (self, other) {
            (Limit::Near(a), Limit::Near(b)) => {
                Limit::near(Interval { low: a.low.min(b.low), high: a.high.min(b.high) })
            }
            (Limit::Unknown, _) | (_, Limit::Unknown) => Limit::Unknown,
            (Limit::Down, _) | (_, Limit::Down) => Limit::Down,
            (Limit::Up, other) | (other, Limit::Up) => other,
        }
    }
}

/// The algebra of limits.
struct Limits;

impl Algebra for Limits {
    type Value = Part;

    fn number(&mut self, number: &Number) -> Part {
        Part::new(Limit::near(number.within()), number.exact().map(Ratio::number))
    }

    fn variable(&mut self, _: usize) -> Part {
        Part::new(Limit::Up, Some(Ratio::time()))
    }

    fn unary(&mut self, function: Unary, a: Part) -> Part {
        let one = Interval::point(1.0);
        let at_infinity = |rises: bool| match function {
            Unary::Negate => a.limit.negated(),
            Unary::Sin | Unary::Cos => Limit::Near(Interval { low: -1.0, high: 1.0 }),
            Unary::Exp if !rises => Limit::Near(Interval::point(0.0)),
            Unary::Exp | Unary::Abs => Limit::Up,
            Unary::Log | Unary::Sqrt => {
                if rises {
                    Limit::Up
                } else {
                    Limit::Unknown
                }
            }
            Unary::Tanh => Limit::Near(if rises { one } else { -one }),
            Unary::Atan => {
                let right = Number::PI.within() * Interval::point(0.5);
                Limit::Near(if rises { right } else { -right })
            }
        };
        let limit = match a.limit {
            Limit::Near(within) => Limit::near(of(Step::Unary(function), within)),
            Limit::Up => at_infinity(true),
            Limit::Down => at_infinity(false),
            Limit::Unknown => Limit::Unknown,
        };
        let negated = || a.ratio.as_ref().map(Ratio::negated);
        let ratio = match (function, a.limit.sign()) {
            (Unary::Negate, _) | (Unary::Abs, Some(false)) => negated(),
            (Unary::Abs, Some(true)) => a.ratio.clone(),
            _ => None,
        };
        let falls = function == Unary::Exp && a.ratio.is_some() && a.limit == Limit::Down;
        Part { fast: falls || (function == Unary::Negate && a.fast), ..Part::new(limit, ratio) }
    }

    fn binary(&mut self, function: Binary, a: Part, b: Part) -> Part {
        let (x, y) = (a.limit, b.limit);
        let ratios = a.ratio.as_ref().zip(b.ratio.as_ref());
        let fast = match function {
            Binary::Multiply => a.damped(&b) || b.damped(&a),
            Binary::Divide => a.fast && b.ratio.is_some(),
            Binary::Add | Binary::Subtract | Binary::Min | Binary::Max => false,
        };
        if fast {
            return Part { limit: Limit::Near(Interval::point(0.0)), ratio: None, fast };
        }
        match function {
            Binary::Add => Part::new(x.plus(y), ratios.and_then(|(a, b)| a.plus(b))),
            Binary::Subtract => Part::new(x.plus(y.negated()), ratios.and_then(|(a, b)| a.plus(&b.negated()))),
            Binary::Multiply => Part::new(x.times(y), ratios.and_then(|(a, b)| a.times(b))),
            Binary::Divide => Part::new(x.times(y.inverse()), ratios.and_then(|(a, b)| a.times(&b.inverse()?))),
            Binary::Min => Part::new(x.smaller(y), None),
            Binary::Max => Part::new(x.negated().smaller(y.negated()).negated(), None),
        }
    }

    fn power(&mut self, a: Part, exponent: &Number) -> Part {
        let limit = match a.limit {
            Limit::Near(within) => Limit::near(of(Step::Power(exponent.clone()), within)),
            Limit::Up if exponent.within().low > 0.0 => Limit::Up,
            Limit::Up if exponent.within().high < 0.0 => Limit::Near(Interval::point(0.0)),
            Limit::Up | Limit::Down | Limit::Unknown => Limit::Unknown,
        };
        Part::new(limit, a.ratio.as_ref().and_then(|ratio| ratio.power(whole(exponent)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn t() -> Expression {
        Expression::variable(0)
    }

    fn is_zero(formula: Expression) -> bool {
        limit(&formula) == Limit::Near(Interval::point(0.0))
    }

    #[test]
    fn nothing_is_known_of_what_grows_beside_what_may_come_to_zero() {
        // 1 ± sin t touches zero for ever, 1.5 ± sin t does not.
        let beside = |mean: f64| limit(&(t().log_of() * (t().sin_of() + mean)));
        assert_eq!([-1.5, -1.0, 0.0, 1.0, 1.5].map(beside), {
            let unknown = Limit::Unknown;
            [Limit::Down, unknown, unknown, unknown, Limit::Up]
        });
    }

    #[test]
    fn exponentials_that_fall_overcome_powers_from_either_side_and_nothing_else_does() {
        let falls = || (-t()).exp_of();
        let products = [falls() * t(), t() * falls(), -falls() * t(), t() * -falls(), falls() / t(), falls() * falls()];
        assert_eq!(products.map(is_zero), [true; 6]);
        // One that rises, one of what is no quotient of polynomials, here 1/√t, and what only has one inside.
        assert_eq!(limit(&(t().exp_of() * t())), Limit::Up);
        assert_eq!(limit(&((-(t().log_of() / 2.0)).exp_of() * t())), Limit::Unknown);
        assert_eq!(limit(&(falls().cos_of() * t())), Limit::Up);
        // Neither does what is no exponential, or what is divided by one.
        assert_eq!([limit(&((-t()).abs_of() * t())), limit(&((-t()).tanh_of() * t()))], [Limit::Up, Limit::Down]);
        assert_eq!(limit(&(-t() * t())), Limit::Down);
        assert_eq!([t() / falls(), falls() * t().log_of()].map(is_zero), [false; 2]);
    }
}

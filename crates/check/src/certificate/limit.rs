//! Where a formula goes as t → ∞, by the rules that a checker has: what refutes a bound for ever.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Unary};
use forwardstep_sim::Setup;
use forwardstep_sim::graph::Edge;

use super::late::{of, to_power, twice, whole};
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

/// Whether what a formula does in the end refutes it, where such edges follow it: one is there at all late times; or one comes back again and
/// again, and the formula falls below every bound or has a limit that is `bad`. What it does while no edge follows it says nothing.
pub(crate) fn refutes(
    setup: &Setup,
    formula: Option<&Expression>,
    is_it: impl Fn(&Edge) -> bool,
    bad: impl Fn(Interval) -> bool,
) -> bool {
    let graphs = setup.network.schedule.recurring_graphs();
    let is_there = |graph: &Vec<Edge>| graph.iter().any(&is_it);
    let settles = |formula: &Expression| match limit(formula) {
        Limit::Down => true,
        Limit::Near(within) => bad(within),
        Limit::Up | Limit::Unknown => false,
    };
    graphs.iter().all(is_there) || graphs.iter().any(is_there) && formula.is_none_or(settles)
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
    /// Its square where that is a quotient of polynomials, as of a root of one, and whether it is positive in the end.
    square: Option<(Ratio, bool)>,
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
        let square = ratio.as_ref().and_then(|ratio| Some((ratio.power(2)?, ratio.is_positive_late()?)));
        Part { limit: known, ratio, square, fast: false }
    }

    /// The same of what has this square: where ∞/∞ stands for a root, its square may tell.
    fn rooted(self, square: Option<(Ratio, bool)>) -> Part {
        let Some((square, positive)) = square.filter(|_| self.ratio.is_none()) else { return self };
        let size = match square.limit() {
            Some(Ok(within)) => Limit::near(of(Unary::Sqrt, Interval { low: within.low.max(0.0), ..within })),
            Some(Err(_)) => Limit::Up,
            None => return self,
        };
        Part { limit: if positive { size } else { size.negated() }, square: Some((square, positive)), ..self }
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
            Limit::Near(within) => Limit::near(of(function, within)),
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
        let square = match function {
            // Not below zero, or it has no value: then its own limit is not known.
            Unary::Sqrt if limit != Limit::Unknown => a.ratio.clone().map(|ratio| (ratio, true)),
            Unary::Negate => a.square.clone().map(|(square, positive)| (square, !positive)),
            _ => None,
        };
        Part { fast: falls || (function == Unary::Negate && a.fast), ..Part::new(limit, ratio).rooted(square) }
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
            return Part { limit: Limit::Near(Interval::point(0.0)), ratio: None, square: None, fast };
        }
        let squares = a.square.as_ref().zip(b.square.as_ref());
        match function {
            Binary::Add => Part::new(x.plus(y), ratios.and_then(|(a, b)| a.plus(b))),
            Binary::Subtract => Part::new(x.plus(y.negated()), ratios.and_then(|(a, b)| a.plus(&b.negated()))),
            Binary::Multiply => Part::new(x.times(y), ratios.and_then(|(a, b)| a.times(b)))
                .rooted(squares.and_then(|((a, up), (b, rises))| Some((a.times(b)?, up == rises)))),
            Binary::Divide => Part::new(x.times(y.inverse()), ratios.and_then(|(a, b)| a.times(&b.inverse()?)))
                .rooted(squares.and_then(|((a, up), (b, rises))| Some((a.times(&b.inverse()?)?, up == rises)))),
            Binary::Min => Part::new(x.smaller(y), None),
            Binary::Max => Part::new(x.negated().smaller(y.negated()).negated(), None),
        }
    }

    fn power(&mut self, a: Part, exponent: &Number) -> Part {
        let limit = match a.limit {
            Limit::Near(within) => Limit::near(to_power(within, exponent)),
            Limit::Up if exponent.within().low > 0.0 => Limit::Up,
            Limit::Up if exponent.within().high < 0.0 => Limit::Near(Interval::point(0.0)),
            Limit::Up | Limit::Down | Limit::Unknown => Limit::Unknown,
        };
        let square = match &a.ratio {
            Some(ratio) if limit != Limit::Unknown => {
                twice(exponent).and_then(|exponent| Some((ratio.power(exponent)?, true)))
            }
            _ => None,
        };
        Part::new(limit, a.ratio.as_ref().and_then(|ratio| ratio.power(whole(exponent)?))).rooted(square)
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

    /// √(t² + 1)/t → 1 and √t/t → 0, where each part by itself grows.
    #[test]
    fn roots_are_compared_with_what_they_are_divided_by_by_their_squares() {
        let near = |formula: Expression, expected: f64| match limit(&formula) {
            Limit::Near(within) => (within.low - expected).abs() < 1e-9 && (within.high - expected).abs() < 1e-9,
            Limit::Up | Limit::Down | Limit::Unknown => false,
        };
        let root = || (t().power(2.0) + 1.0).sqrt_of();
        assert!(near(root() / t(), 1.0) && near(-root() / t(), -1.0) && near(root() / -t(), -1.0));
        assert!(near(-t() / root(), -1.0) && near(root() * (t() * -2.0).power(-1.0), -0.5));
        assert!(near(t().power(0.5) / t(), 0.0) && near(t().power(-0.5) * t().sqrt_of(), 1.0));
        assert_eq!([limit(&(t() / t().sqrt_of())), limit(&(-t() / t().sqrt_of()))], [Limit::Up, Limit::Down]);
        // A root of what becomes negative has no value, whatever it is divided by.
        assert_eq!(limit(&((-t()).sqrt_of() / t())), Limit::Unknown);
        assert_eq!(limit(&((-t()).power(0.5) / t())), Limit::Unknown);
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

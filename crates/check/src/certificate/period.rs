//! The common period of sines and cosines in a formula, where it is plain.

use forwardstep_core::expression::{Algebra, Binary, Expression, Number, Unary};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// q πⁿ.
#[derive(Clone, Debug, PartialEq)]
struct Rate {
    q: BigRational,
    pis: i32,
}

/// How a part of a formula depends on t.
#[derive(Clone, Debug)]
enum Shape {
    /// Not at all; its value where that is q πⁿ.
    Constant(Option<Rate>),
    /// As a t + b, by a.
    Linear(Rate),
    /// By sines and cosines of a t + b alone, by all a.
    Periodic(Vec<Rate>),
    /// In some other way.
    Other,
}

struct Shapes;

impl Shape {
    fn negated(self) -> Shape {
        let minus = |Rate { q, pis }| Rate { q: -q, pis };
        match self {
            Shape::Constant(rate) => Shape::Constant(rate.map(minus)),
            Shape::Linear(rate) => Shape::Linear(minus(rate)),
            Shape::Periodic(_) | Shape::Other => self,
        }
    }

    /// Any function of two parts that is not linear in both.
    fn mixed(self, other: Shape) -> Shape {
        match (self, other) {
            (Shape::Constant(_), Shape::Constant(_)) => Shape::Constant(None),
            (Shape::Periodic(a), Shape::Periodic(b)) => Shape::Periodic([a, b].concat()),
            (Shape::Periodic(rates), Shape::Constant(_)) | (Shape::Constant(_), Shape::Periodic(rates)) => {
                Shape::Periodic(rates)
            }
            (Shape::Linear(_) | Shape::Other, _) | (_, Shape::Linear(_) | Shape::Other) => Shape::Other,
        }
    }

    fn plus(self, other: Shape) -> Shape {
        let sum = |a: &Rate, b: &Rate| (a.pis == b.pis).then(|| Rate { q: &a.q + &b.q, pis: a.pis });
        match (self, other) {
            (Shape::Linear(a), Shape::Linear(b)) => sum(&a, &b).map_or(Shape::Other, Shape::Linear),
            (Shape::Linear(rate), Shape::Constant(_)) | (Shape::Constant(_), Shape::Linear(rate)) => {
                Shape::Linear(rate)
            }
            (Shape::Constant(Some(a)), Shape::Constant(Some(b))) => Shape::Constant(sum(&a, &b)),
            (a, b) => a.mixed(b),
        }
    }

    fn times(self, other: Shape) -> Shape {
        let product = |a: Rate, b: Rate| Rate { q: a.q * b.q, pis: a.pis + b.pis };
        match (self, other) {
            (Shape::Linear(a), Shape::Constant(Some(b))) | (Shape::Constant(Some(a)), Shape::Linear(b)) => {
                Shape::Linear(product(a, b))
            }
            (Shape::Constant(Some(a)), Shape::Constant(Some(b))) => Shape::Constant(Some(product(a, b))),
            (a, b) => a.mixed(b),
        }
    }

    fn inverted(self) -> Shape {
        match self {
            Shape::Constant(Some(Rate { q, pis })) if !q.is_zero() => {
                Shape::Constant(Some(Rate { q: q.recip(), pis: -pis }))
            }
            Shape::Constant(_) => Shape::Constant(None),
            Shape::Linear(_) => Shape::Other,
            Shape::Periodic(_) | Shape::Other => self,
        }
    }
}

impl Algebra for Shapes {
    type Value = Shape;

    fn number(&mut self, number: &Number) -> Shape {
        let pi = (*number == Number::PI).then(|| Rate { q: BigRational::one(), pis: 1 });
        Shape::Constant(number.exact().map(|q| Rate { q, pis: 0 }).or(pi))
    }

    fn variable(&mut self, _: usize) -> Shape {
        Shape::Linear(Rate { q: BigRational::one(), pis: 0 })
    }

    fn unary(&mut self, function: Unary, a: Shape) -> Shape {
        match (function, a) {
            (Unary::Negate, a) => a.negated(),
            (Unary::Sin | Unary::Cos, Shape::Linear(rate)) => Shape::Periodic(vec![rate]),
            (_, Shape::Constant(_)) => Shape::Constant(None),
            (_, Shape::Periodic(rates)) => Shape::Periodic(rates),
            (_, Shape::Linear(_) | Shape::Other) => Shape::Other,
        }
    }

    fn binary(&mut self, function: Binary, a: Shape, b: Shape) -> Shape {
        match function {
            Binary::Add => a.plus(b),
            Binary::Subtract => a.plus(b.negated()),
            Binary::Multiply => a.times(b),
            Binary::Divide => a.times(b.inverted()),
            Binary::Min | Binary::Max => a.mixed(b),
        }
    }

    fn power(&mut self, a: Shape, _: &Number) -> Shape {
        a.mixed(Shape::Constant(None))
    }
}

/// How long it takes until a formula in sines and cosines repeats, s: 2/g where all angles are multiples of g π t, 2π/g where
/// they are of g t; nothing where there is another part, or no common period is plain.
pub(super) fn period_s(formula: &Expression) -> Option<f64> {
    let Shape::Periodic(rates) = formula.fold(&mut Shapes) else { return None };
    let pis = rates.first()?.pis;
    if !(0..=1).contains(&pis) || rates.iter().any(|rate| rate.pis != pis || rate.q.is_zero()) {
        return None;
    }
    let common = rates.iter().map(|rate| rate.q.abs()).reduce(gcd)?;
    let turn = if pis == 1 { 2.0 } else { 2.0 * std::f64::consts::PI };
    common.to_f64().map(|common| turn / common).filter(|period| period.is_finite())
}

/// The largest number of which both are whole multiples.
fn gcd(a: BigRational, b: BigRational) -> BigRational {
    let (mut a, mut b) = (a, b);
    while !b.is_zero() {
        (a, b) = (b.clone(), a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    fn t() -> Expression {
        Expression::variable(0)
    }

    #[test]
    fn periods_are_those_of_all_angles_together() {
        let pi = || Expression::number(Number::PI);
        let seven = (pi() * 2.0 * t() / 7.0).sin_of() * 0.4 + 1.0;
        assert_eq!(period_s(&seven), Some(7.0));
        let both = (t() * 1.5).sin_of() * ((t() / 3.0) + 1.0).cos_of().power(2.0);
        let expected = 12.0 * std::f64::consts::PI;
        assert!(period_s(&both).is_some_and(|period| (period - expected).abs() < 1e-9));
        assert_eq!(period_s(&(t().sin_of() + (pi() * t()).sin_of())), None, "π is irrational");
        assert_eq!(period_s(&(t().sin_of() * t())), None);
        assert_eq!(period_s(&(t() * t()).sin_of()), None);
    }
}
